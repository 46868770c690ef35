"""Views of a model per second, from one process, beside pyrender with OSMesa.

python views.py MODEL [--size 256] [--views 100] [--samples 4] [--pyrender PYTHON]

Each view is a picture with depth, normals, ids of shapes and camera matrices (lookfrom), or a picture with depth (pyrender).
PYTHON is an interpreter that has pyrender, and OSMesa; both run one after the other, three times, and the best counts.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from typing import Any

import numpy as np

PYRENDER = """
import json, os, sys, time
os.environ["PYOPENGL_PLATFORM"] = "osmesa"
import numpy as np, trimesh, pyrender
path, size, poses = sys.argv[1], int(sys.argv[2]), json.load(sys.stdin)
scene = pyrender.Scene.from_trimesh_scene(trimesh.load(path, force="scene"))
camera = scene.add(pyrender.PerspectiveCamera(yfov=np.radians(poses["fov"])))
scene.add(pyrender.DirectionalLight(intensity=3.0), pose=np.array(poses["views"][0]))
renderer = pyrender.OffscreenRenderer(size, size)
def view(pose):
    scene.set_pose(camera, np.array(pose))
    return renderer.render(scene)
view(poses["views"][0])
best = 0.0
for _ in range(3):
    started = time.perf_counter()
    for pose in poses["views"]:
        color, depth = view(pose)
    best = max(best, len(poses["views"]) / (time.perf_counter() - started))
print(json.dumps({"rate": best, "hit": float((depth > 0).mean())}))
"""


def rate_of_lookfrom(session: Any, eyes: list[np.ndarray[Any, Any]], with_labels: bool) -> float:
    def view(eye: np.ndarray[Any, Any]) -> None:
        session.set(lookfrom=eye)
        picture = session.render()
        assert picture.srgb.size
        if with_labels:
            assert session.labels().hit.any()

    view(eyes[0])
    best = 0.0
    for _ in range(3):
        started = time.perf_counter()
        for eye in eyes:
            view(eye)
        best = max(best, len(eyes) / (time.perf_counter() - started))
    return best


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("model")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--views", type=int, default=100)
    parser.add_argument("--samples", type=int, nargs="*", default=[1, 4, 16])
    parser.add_argument("--pyrender", metavar="PYTHON")
    arguments = parser.parse_args()

    import lookfrom

    session = lookfrom.Session(arguments.model, size=arguments.size, denoise=False)
    bounds = session.bounds
    assert bounds is not None
    low, high = map(np.array, bounds)
    middle, radius = (low + high) / 2, np.linalg.norm(high - low)
    angles = np.linspace(0, 2 * np.pi, arguments.views, endpoint=False)
    eyes = [middle + radius * np.array([np.sin(a), 0.4, np.cos(a)]) for a in angles]
    session.set(lookat=middle, fov=50, lookfrom=eyes[0])
    if arguments.pyrender:
        views = []
        for eye in eyes:
            session.set(lookfrom=eye)
            views.append(session.camera.world_from_camera("opengl").tolist())
        told = subprocess.run(
            [arguments.pyrender, "-c", PYRENDER, arguments.model, str(arguments.size)],
            input=json.dumps({"fov": 50, "views": views}),
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
        print(f"pyrender, OSMesa: {json.loads(told.stdout)['rate']:.1f} views/s", flush=True)
    for samples in arguments.samples:
        session.set(samples=samples)
        for with_labels in (False, True):
            rate = rate_of_lookfrom(session, eyes, with_labels)
            print(
                f"lookfrom, {samples} samples{', labels' if with_labels else ''}: {rate:.1f} views/s",
                flush=True,
            )
    session.set(integrator="raycast", samples=1)
    print(f"lookfrom, ray casting, 1 sample, labels: {rate_of_lookfrom(session, eyes, True):.1f} views/s")


if __name__ == "__main__":
    sys.exit(main())
