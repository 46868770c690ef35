"""Rays of lookfrom beside embreex's, directly and through trimesh, in one run on the same rays.

    pip install embreex trimesh && python crates/lookfrom-py/benchmarks/rays.py [rays]

Each row is the best of several runs that take turns, copies and numpy included. embreex has one thread.
"""

import os
import platform
import sys
import time
from collections.abc import Callable
from importlib.metadata import version

import numpy as np
import trimesh
import trimesh.ray.ray_pyembree
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

import lookfrom
import lookfrom.trimesh

REPEATS = 7


def bumpy(subdivisions: int) -> trimesh.Trimesh:
    """A closed mesh with folds at several scales, as of a scan."""
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions)
    points = mesh.vertices.view(np.ndarray)
    bumps = sum(
        np.sin(k * points @ np.array(axis)) / k
        for k, axis in ((5, (1, 2, 0)), (17, (0, 1, 3)), (41, (2, 0, 1)))
    )
    return trimesh.Trimesh(points * (1.0 + 0.3 * bumps[:, None]), mesh.faces, process=False)


def best(functions: dict[str, Callable[[], object]]) -> dict[str, float]:
    """The best time of each function in seconds, where they take turns."""
    times = dict.fromkeys(functions, float("inf"))
    for _ in range(REPEATS):
        for name, function in functions.items():
            start = time.perf_counter()
            function()
            times[name] = min(times[name], time.perf_counter() - start)
    return times


def report(title: str, rays: int, functions: dict[str, Callable[[], object]]) -> None:
    """A table of rates, relative to the first function."""
    times = best(functions)
    reference = next(iter(times.values()))
    print(f"\n{title}\n\n| | million/s | ratio |\n| --- | ---: | ---: |")
    for name, seconds in times.items():
        print(f"| {name} | {rays / seconds / 1e6:.2f} | {reference / seconds:.2f} |")


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    rng = np.random.default_rng(1)
    mesh = bumpy(7)
    bvh = lookfrom.Bvh(mesh.vertices, mesh.faces)
    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, mesh.vertices.astype(np.float32), mesh.faces.astype(np.int32))
    embree = trimesh.ray.ray_pyembree.RayMeshIntersector(mesh)
    ours = lookfrom.trimesh.RayMeshIntersector(mesh, threads=1)

    print(
        f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}, numpy {np.__version__},"
    )
    print(
        f"embreex {version('embreex')}, trimesh {trimesh.__version__}; {len(mesh.faces)} triangles, {count} rays"
    )

    low, high = mesh.bounds
    incoherent = rng.uniform(low, high, (count, 3)), rng.normal(size=(count, 3))
    side = int(count**0.5)
    eye = lookfrom.look_at((2.5, 1.5, 1.0), (0, 0, 0))
    origin, directions = lookfrom.pinhole_rays(side, side, fov=45, world_from_camera=eye)
    coherent = np.broadcast_to(origin, directions.shape).copy(), directions

    for title, (o, d) in (("incoherent", incoherent), ("coherent", coherent)):
        # Rays of a picture have its shape for us, and are rows for embreex.
        picture = o.astype(np.float32), d.astype(np.float32)
        o, d = o.reshape(-1, 3), d.reshape(-1, 3)
        o32, d32 = (array.reshape(-1, 3) for array in picture)
        report(
            f"First hits, {title}, float32: which triangle",
            len(o),
            {
                "embreex": lambda o=o32, d=d32: scene.run(o, d),
                "lookfrom, 1 thread": lambda rays=picture: bvh.closest_primitives(*rays, threads=1),
                "lookfrom, 2 threads": lambda rays=picture: bvh.closest_primitives(*rays, threads=2),
            },
        )
        report(
            f"First hits, {title}, float32: t, u, v, ids",
            len(o),
            {
                "embreex, output=1": lambda o=o32, d=d32: scene.run(o, d, output=1),
                "lookfrom, 1 thread": lambda rays=picture: bvh.closest_hits(*rays, threads=1),
                "lookfrom, 2 threads": lambda rays=picture: bvh.closest_hits(*rays, threads=2),
            },
        )
        report(
            f"First hits, {title}, float64: intersects_first of trimesh",
            len(o),
            {
                "embreex": lambda o=o, d=d: embree.intersects_first(o, d),
                "lookfrom, 1 thread": lambda o=o, d=d: ours.intersects_first(o, d),
            },
        )
        report(
            f"First hits, {title}, float64: intersects_location(multiple_hits=False) of trimesh",
            len(o),
            {
                "embreex": lambda o=o, d=d: embree.intersects_location(o, d, multiple_hits=False),
                "lookfrom, 1 thread": lambda o=o, d=d: ours.intersects_location(o, d, multiple_hits=False),
            },
        )
        report(
            f"Occlusion, {title}, float32",
            len(o),
            {
                "embreex": lambda o=o32, d=d32: scene.run(o, d, query="OCCLUDED"),
                "lookfrom, 1 thread": lambda rays=picture: bvh.occluded(*rays, threads=1),
                "lookfrom, 2 threads": lambda rays=picture: bvh.occluded(*rays, threads=2),
            },
        )
    few = max(count // 10, 1)
    o, d = incoherent[0][:few], incoherent[1][:few]
    report(
        "All hits, incoherent, float64: intersects_location of trimesh",
        few,
        {
            "embreex": lambda: embree.intersects_location(o, d),
            "lookfrom, 1 thread": lambda: ours.intersects_location(o, d),
            "lookfrom directly, 1 thread": lambda: bvh.all_hits(o, d, threads=1),
            "lookfrom directly, 2 threads": lambda: bvh.all_hits(o, d, threads=2),
        },
    )
    report(
        "Points inside: contains_points of trimesh",
        few,
        {
            "embreex": lambda: embree.contains_points(o),
            "lookfrom, 1 thread": lambda: ours.contains_points(o),
            "lookfrom directly, 2 threads": lambda: bvh.contains(o, threads=2),
        },
    )

    ball = trimesh.creation.icosphere(subdivisions=7)
    middles = ball.vertices[ball.edges_unique].mean(axis=1)
    targets = np.vstack([ball.vertices.view(np.ndarray), middles])
    print("\nRays from the middle of an icosphere that miss it\n")
    print("| through | rays | embreex | lookfrom |\n| --- | ---: | ---: | ---: |")
    for name, rays in (
        ("vertices", targets[: len(ball.vertices)]),
        ("vertices and middles of edges", targets),
    ):
        from_middle = np.zeros_like(rays)
        theirs = trimesh.ray.ray_pyembree.RayMeshIntersector(ball).intersects_first(from_middle, rays)
        mine = lookfrom.trimesh.RayMeshIntersector(ball).intersects_first(from_middle, rays)
        print(f"| {name} | {len(rays)} | {np.count_nonzero(theirs < 0)} | {np.count_nonzero(mine < 0)} |")


if __name__ == "__main__":
    main()
