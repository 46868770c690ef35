#!/usr/bin/env python3
"""Path tracing by lookfrom and by Mitsuba 3, side by side: the same pictures, how fast, how much noise.

Needs: pip packages mitsuba (3.x), numpy, OpenEXR; Debian's libllvm19 (or another that Mitsuba finds); a release build of lookfrom; and for
the mesh scenes a mesh in the format of our kernel benchmark (u32 triangles, u32 vertices, f32 positions, u32 indices).

    against_mitsuba.py --lookfrom target/release/lookfrom --mesh dragon100k.bin                  all scenes, two threads, then one
    against_mitsuba.py --lookfrom target/release/lookfrom --scene cornell --threads 1 --turns 5  one scene, one thread

The scenes are written here, for both programs, from one description. Before anything is timed, many samples of both are compared: the
means of the pictures, and each pixel by its standard error. Then the programs take turns, each turn with another seed. Rendering alone is timed: of
lookfrom what `--json` calls seconds.render; of Mitsuba a call of `render` until its result is there, when its kernels are compiled
already. CPU time is that of the whole process, for lookfrom less that of a picture with one sample. Equal-error time is time × mean squared error.
"""

import argparse
import json
import os
import struct
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

# The depth is counted in bounces; Mitsuba counts the segments of a path, which is one more.
DEPTH = 7


class Scene:
    """Meshes, spheres, lights and a camera, which either program can be given."""

    def __init__(self, eye, target, fov, size):
        self.eye, self.target, self.fov, self.size = eye, target, fov, size
        self.meshes = []
        self.spheres = []
        self.sky = None
        # Of a thin lens: its radius, and the distance of what is sharp.
        self.lens = None

    def mesh(self, points, triangles, material, radiance=None):
        self.meshes.append((np.asarray(points, np.float32), np.asarray(triangles, np.int32), material, radiance))

    def parallelogram(self, corner, a, b, material, radiance=None):
        """Its front is where a × b points."""
        corner, a, b = (np.asarray(v, np.float64) for v in (corner, a, b))
        self.mesh([corner, corner + a, corner + a + b, corner + b], [[0, 1, 2], [0, 2, 3]], material, radiance)

    def block(self, centre, half, degrees, material):
        """A box that is turned about its vertical axis."""
        c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
        corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
        corners = corners @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]) + centre
        sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        self.mesh(corners, [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))], material)


def diffuse(*reflectance):
    return {"kind": "diffuse", "reflectance": reflectance}


def cornell_box(size):
    """A room from -1 to 1 with two blocks, 36 triangles."""
    white, red, green = diffuse(0.73, 0.73, 0.73), diffuse(0.63, 0.06, 0.05), diffuse(0.15, 0.48, 0.09)
    scene = Scene([0, 0, 3.9], [0, 0, 0], 39.3, size)
    scene.parallelogram([-0.24, 0.995, -0.2], [0.48, 0, 0], [0, 0, 0.4], white, radiance=(18.4, 14.0, 6.8))
    scene.parallelogram([-1, -1, 1], [2, 0, 0], [0, 0, -2], white)
    scene.parallelogram([-1, 1, -1], [2, 0, 0], [0, 0, 2], white)
    scene.parallelogram([-1, -1, -1], [2, 0, 0], [0, 2, 0], white)
    scene.parallelogram([-1, -1, 1], [0, 0, -2], [0, 2, 0], red)
    scene.parallelogram([1, -1, -1], [0, 0, 2], [0, 2, 0], green)
    scene.block([0.335, -0.7, 0.38], [0.3, 0.3, 0.3], -17, white)
    scene.block([-0.33, -0.4, -0.28], [0.3, 0.6, 0.3], 18, white)
    return scene


def mesh_on_floor(size, mesh, material):
    """A mesh on a large floor, one square light above it, to the left."""
    data = Path(mesh).read_bytes()
    triangles, vertices = struct.unpack_from("<II", data)
    points = np.frombuffer(data, "<f4", 3 * vertices, 8).reshape(-1, 3)
    indices = np.frombuffer(data, "<u4", 3 * triangles, 8 + 12 * vertices).reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    centre, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    scene = Scene((centre + np.array([0.9, 0.7, 1.7]) * radius).tolist(), centre.tolist(), 45, size)
    scene.mesh(points, indices, material)
    floor = [centre[0] - 6 * radius, low[1], centre[2] + 6 * radius]
    scene.parallelogram(floor, [12 * radius, 0, 0], [0, 0, -12 * radius], diffuse(0.5, 0.45, 0.4))
    light = [centre[0] - 1.4 * radius, low[1] + 2.5 * radius, centre[2] - 0.2 * radius]
    scene.parallelogram(light, [0.8 * radius, 0, 0], [0, 0, 0.8 * radius], diffuse(0, 0, 0), radiance=(17, 15, 12))
    return scene, centre, low, radius


def dragon(size, mesh):
    return mesh_on_floor(size, mesh, diffuse(0.6, 0.5, 0.25))[0]


def through_lens(scene, radius):
    """The scene by a thin lens that is focused on the camera's target."""
    distance = float(np.linalg.norm(np.subtract(scene.target, scene.eye)))
    scene.lens = radius * distance, distance
    return scene


def balls(size):
    """Balls in four rows on a floor, matte, metal and glass, under a square light and a sky."""
    kinds = [
        diffuse(0.7, 0.2, 0.1),
        {"kind": "conductor", "reflectance": (0.9, 0.7, 0.35), "alpha": 0.1},
        diffuse(0.2, 0.5, 0.3),
        {"kind": "dielectric", "eta": 1.5, "alpha": 0.0},
    ]
    scene = Scene([-3.4, 1.9, 6.2], [0.3, 0.45, 0], 30, size)
    scene.parallelogram([-20, 0, 20], [40, 0, 0], [0, 0, -40], diffuse(0.5, 0.45, 0.4))
    scene.parallelogram([-3, 5, 1], [2, 0, 0], [0, 0, 2], diffuse(0, 0, 0), radiance=(17, 15, 12))
    for row in range(4):
        for column in range(4):
            centre = [1.3 * column - 1.9, 0.5, 3 - 2.2 * row]
            scene.spheres.append((centre, 0.5, kinds[(row + column) % 4]))
    scene.sky = (0.25, 0.35, 0.5)
    return scene


def materials(size, mesh):
    """The mesh of rough metal, two spheres of glass and rough glass, a sky of one colour besides the light."""
    metal = {"kind": "conductor", "reflectance": (0.9, 0.7, 0.35), "alpha": 0.2}
    scene, centre, low, radius = mesh_on_floor(size, mesh, metal)
    for x, z, alpha in ((0.55, 0.75, 0.0), (-0.35, 0.85, 0.3)):
        at = [centre[0] + x * radius, low[1] + 0.2 * radius, centre[2] + z * radius]
        scene.spheres.append((at, 0.2 * radius, {"kind": "dielectric", "eta": 1.5, "alpha": alpha}))
    scene.sky = (0.25, 0.35, 0.5)
    return scene


# --- lookfrom -----------------------------------------------------------------------------------------------------------------------------------


def write_ply(path, points, triangles):
    faces = np.empty(len(triangles), dtype=[("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, triangles
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + points.astype("<f4").tobytes() + faces.tobytes())


def numbers(values):
    return " ".join(repr(float(v)) for v in np.ravel(values))


def pbrt_material(material):
    if material["kind"] == "diffuse":
        return f'Material "diffuse" "rgb reflectance" [{numbers(material["reflectance"])}]'
    roughness = f'"float roughness" {material["alpha"]} "bool remaproughness" false'
    if material["kind"] == "conductor":
        return f'Material "conductor" "rgb reflectance" [{numbers(material["reflectance"])}] {roughness}'
    return f'Material "dielectric" "float eta" {material["eta"]} {roughness}'


def write_pbrt(scene, folder, name):
    """In pbrt's language, where the camera is left-handed."""
    lens = f' "float lensradius" {scene.lens[0]} "float focaldistance" {scene.lens[1]}' if scene.lens else ""
    lines = [
        "Scale -1 1 1",
        f"LookAt {numbers(scene.eye)}  {numbers(scene.target)}  0 1 0",
        f'Camera "perspective" "float fov" {scene.fov}{lens}',
        f'Film "rgb" "integer xresolution" {scene.size} "integer yresolution" {scene.size}',
        'PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5',
        f'Integrator "path" "integer maxdepth" {DEPTH}',
        "WorldBegin",
    ]
    if scene.sky:
        lines.append(f'LightSource "infinite" "rgb L" [{numbers(scene.sky)}]')
    for index, (points, triangles, material, radiance) in enumerate(scene.meshes):
        lines += ["AttributeBegin", pbrt_material(material)]
        if radiance:
            lines.append(f'AreaLightSource "diffuse" "rgb L" [{numbers(radiance)}]')
        ply = folder / f"{name}{index}.ply"
        write_ply(ply, points, triangles)
        lines += [f'Shape "plymesh" "string filename" "{ply.name}"', "AttributeEnd"]
    for centre, radius, material in scene.spheres:
        lines += ["AttributeBegin", pbrt_material(material), f"Translate {numbers(centre)}"]
        lines += [f'Shape "sphere" "float radius" {radius}', "AttributeEnd"]
    path = folder / f"{name}.pbrt"
    path.write_text("\n".join(lines) + "\n")
    return path


def read_exr(path):
    import OpenEXR

    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        if "RGB" in channels:
            return np.asarray(channels["RGB"].pixels, np.float64)
        return np.stack([channels[c].pixels for c in "RGB"], axis=-1).astype(np.float64)


class Lookfrom:
    """The command, once for each picture."""

    def __init__(self, binary, scenes, folder, threads, sampler, allocation="uniform"):
        self.name = f"lookfrom {sampler}" + (f", {allocation}" if allocation != "uniform" else "")
        self.allocation = allocation
        self.binary, self.threads, self.sampler, self.folder = binary, threads, sampler, folder
        self.files = {name: write_pbrt(scene, folder, name) for name, scene in scenes.items()}
        self.start = {}

    def run(self, scene, samples, seed):
        out = self.folder / "ours.exr"
        command = [self.binary, "render", self.files[scene], "-o", out, "--color", "rgb", "--json", "--quiet"]
        command += ["--threads", self.threads, "--samples", samples, "--seed", seed, "--sampler", self.sampler]
        if self.allocation != "uniform" and samples > 1:
            command += ["--allocation", self.allocation]
        child = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE)
        summary = json.loads(child.stdout.read())
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = status
        if status != 0:
            sys.exit(f"{self.binary} failed on {self.files[scene]}")
        return summary["seconds"]["render"], used.ru_utime + used.ru_stime, read_exr(out)

    def render(self, scene, samples, seed):
        if scene not in self.start:
            self.start[scene] = min(self.run(scene, 1, turn)[1] for turn in range(3))
        wall, cpu, image = self.run(scene, samples, seed)
        return wall, (cpu - self.start[scene]) * samples / (samples - 1), image


# --- Mitsuba ------------------------------------------------------------------------------------------------------------------------------------


def mitsuba_material(material):
    def rgb(value):
        return {"type": "rgb", "value": [float(v) for v in value]}

    if material["kind"] == "diffuse":
        return {"type": "diffuse", "reflectance": rgb(material["reflectance"])}
    rough = {"distribution": "ggx", "alpha": material["alpha"]} if material["alpha"] else {}
    prefix = "rough" if rough else ""
    if material["kind"] == "conductor":
        # The metal that reflects so much straight on, with an index of 1, as pbrt defines it.
        r = np.array(material["reflectance"])
        k = 2 * np.sqrt(r) / np.sqrt(1 - r)
        return {"type": prefix + "conductor", "eta": rgb([1, 1, 1]), "k": {"type": "rgb", "value": k.tolist()}, **rough}
    return {"type": prefix + "dielectric", "int_ior": material["eta"], "ext_ior": 1.0, **rough}


def mitsuba_scene(mi, scene, folder, name, sampler, rectangles):
    def rgb(value):
        return {"type": "rgb", "value": list(value)}

    description = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": DEPTH + 1},
        "sensor": {
            "type": "perspective",
            "fov": scene.fov,
            "near_clip": 1e-3,
            "far_clip": 1e4,
            "to_world": mi.ScalarTransform4f().look_at(origin=scene.eye, target=scene.target, up=[0, 1, 0]),
            "film": {
                "type": "hdrfilm",
                "width": scene.size,
                "height": scene.size,
                "rfilter": {"type": "box"},
                "pixel_format": "rgb",
                "component_format": "float32",
            },
            "sampler": {"type": sampler, "sample_count": 16},
        },
    }
    if scene.lens:
        radius, distance = scene.lens
        description["sensor"].update(type="thinlens", aperture_radius=radius, focus_distance=distance)
    if scene.sky:
        description["sky"] = {"type": "constant", "radiance": rgb(scene.sky)}
    for index, (points, triangles, material, radiance) in enumerate(scene.meshes):
        if rectangles and len(points) == 4:
            # Mitsuba's rectangle is from -1 to 1 and looks along z.
            p = points.astype(np.float64)
            a, b = (p[1] - p[0]) / 2, (p[3] - p[0]) / 2
            n = np.cross(a, b)
            frame = np.eye(4)
            frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3] = a, b, n / np.linalg.norm(n), p[0] + a + b
            shape = {"type": "rectangle", "to_world": mi.ScalarTransform4f(frame)}
        else:
            shape = {"type": "ply", "filename": str(folder / f"{name}{index}.ply"), "face_normals": True}
        shape["bsdf"] = mitsuba_material(material)
        if radiance:
            shape["emitter"] = {"type": "area", "radiance": rgb(radiance)}
        description[f"mesh{index}"] = shape
    for index, (centre, radius, material) in enumerate(scene.spheres):
        shape = {"type": "sphere", "center": centre, "radius": radius, "bsdf": mitsuba_material(material)}
        description[f"sphere{index}"] = shape
    return mi.load_dict(description)


def mitsuba_worker(args):
    """Render what is asked for on standard input: lines of scene, sampler, samples, seed."""
    import resource

    import drjit as dr
    import mitsuba as mi

    mi.set_variant(args.worker)
    dr.set_thread_count(args.threads[0])
    compiled = args.worker.startswith("llvm")
    if compiled:
        dr.set_flag(dr.JitFlag.KernelHistory, True)
    folder, described, loaded = Path(args.folder), scenes_of(args), {}

    def cpu():
        used = resource.getrusage(resource.RUSAGE_SELF)
        return used.ru_utime + used.ru_stime

    for line in sys.stdin:
        name, sampler, samples, seed = line.split()
        key = name, sampler
        if key not in loaded:
            loaded[key] = mitsuba_scene(mi, described[name], folder, name, sampler, args.rectangles)
        if compiled:
            dr.kernel_history_clear()
        wall, busy = time.perf_counter(), cpu()
        image = mi.render(loaded[key], spp=int(samples), seed=int(seed))
        if compiled:
            dr.eval(image)
            dr.sync_thread()
        wall, busy = time.perf_counter() - wall, cpu() - busy
        cached, kernel = True, wall
        if compiled:
            launches = [k for k in dr.kernel_history() if k["type"] == dr.KernelType.JIT]
            cached = all(k["cache_hit"] for k in launches)
            kernel = sum(k["execution_time"] for k in launches) / 1000
        np.save(folder / f"{args.worker}.npy", np.array(image, np.float32))
        print("@", json.dumps({"wall": wall, "cpu": busy, "cached": cached, "kernel": kernel}), flush=True)


class Mitsuba:
    """A process that keeps its compiled kernels."""

    workers = {}

    def __init__(self, variant, args, folder, threads, sampler):
        self.name = f"{variant} {sampler}"
        self.sampler, self.picture, self.compiles = sampler, folder / f"{variant}.npy", variant.startswith("llvm")
        key = variant, threads
        if key not in self.workers:
            command = [sys.executable, __file__, "--worker", variant, "--threads", str(threads), "--folder", str(folder)]
            command += ["--size", str(args.size), "--mesh", args.mesh or ""] + ["--rectangles"] * args.rectangles
            self.workers[key] = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.process = self.workers[key]
        self.warm = set()

    def run(self, scene, samples, seed):
        self.process.stdin.write(f"{scene} {self.sampler} {samples} {seed}\n")
        self.process.stdin.flush()
        for line in self.process.stdout:
            if line.startswith("@"):
                return json.loads(line[1:])
        sys.exit(f"{self.name} ended")

    def render(self, scene, samples, seed):
        if self.compiles and (scene, samples) not in self.warm:
            # The first two calls compile.
            for warm_up in (1000, 1001):
                self.run(scene, samples, warm_up)
            self.warm.add((scene, samples))
        done = self.run(scene, samples, seed)
        if not done["cached"]:
            print(f"   ({self.name} compiled a kernel while it was timed)")
        return done["wall"], done["cpu"], np.load(self.picture).astype(np.float64)


# --- the comparison ------------------------------------------------------------------------------------------------------------------------------


def many(renderer, scene, samples, batch, first_seed):
    """The mean of batches and its standard error, per pixel and channel."""
    images = [renderer.render(scene, batch, first_seed + i)[2] for i in range(max(samples // batch, 4))]
    return np.mean(images, axis=0), np.std(images, axis=0, ddof=1) / np.sqrt(len(images))


def same_picture(ours, theirs):
    """Print how the programs agree; the picture that both made together."""
    (a, error_a), (b, error_b) = ours, theirs
    mean_error = np.sqrt((error_a**2 + error_b**2).sum(axis=(0, 1))) / (a.shape[0] * a.shape[1])
    share = (a.mean(axis=(0, 1)) - b.mean(axis=(0, 1))) / b.mean(axis=(0, 1)) * 100
    z = (a.mean(axis=(0, 1)) - b.mean(axis=(0, 1))) / mean_error
    # Neighbours lend a pixel their variance, as few batches say little about one pixel.
    variance = error_a**2 + error_b**2
    padded = np.pad(variance, ((2, 2), (2, 2), (0, 0)), mode="edge")
    height, width = a.shape[:2]
    smooth = sum(padded[y : y + height, x : x + width] for y in range(5) for x in range(5)) / 25
    pixel = np.abs(a - b) / np.sqrt(np.maximum(variance, smooth) + 1e-12)
    print(f"   mean of ours {np.round(a.mean(axis=(0, 1)), 5)}, of Mitsuba {np.round(b.mean(axis=(0, 1)), 5)}")
    print(f"   difference {np.round(share, 3)} %, in standard errors {np.round(z, 2)}")
    print(f"   pixels within 3.5 standard errors: {100 * (pixel < 3.5).mean():.2f} %, largest {pixel.max():.1f}")
    return (a + b) / 2


def measure(scene, renderers, samples, turns, reference):
    """Times and errors of all, in turn; dictionaries by name."""
    rows = {r.name: {"wall": [], "cpu": [], "mse": [], "relmse": []} for r in renderers}
    for turn in range(turns):
        for renderer in renderers:
            wall, cpu, image = renderer.render(scene, samples, 1 + turn)
            square = (image - reference) ** 2
            row = rows[renderer.name]
            row["wall"].append(wall)
            row["cpu"].append(cpu)
            row["mse"].append(square.mean())
            row["relmse"].append((square / (reference**2 + 0.01)).mean())
    return rows


def print_table(scene, rows, threads, samples, pixels):
    print(f"\n{scene}, {threads} thread{'s' * (threads > 1)}, {samples} samples a pixel\n")
    print("| | wall s | CPU s | slowest / fastest wall | Msamples/s wall | Msamples/s a CPU second | RMSE | relMSE | wall s × MSE | CPU s × MSE |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    best = {}
    for name, row in rows.items():
        wall, cpu, mse = min(row["wall"]), min(row["cpu"]), np.mean(row["mse"])
        best[name] = wall, cpu, mse, np.mean(row["relmse"])
        rate = pixels * samples / 1e6
        print(
            f"| {name} | {wall:.3f} | {cpu:.3f} | {max(row['wall']) / wall:.2f} | {rate / wall:.2f} | {rate / cpu:.2f} | {np.sqrt(mse):.5f} "
            f"| {np.mean(row['relmse']):.5f} | {wall * mse:.3e} | {cpu * mse:.3e} |"
        )
    print("\n| ours / theirs | wall | CPU | MSE | relMSE | equal-error wall | equal-error CPU | by relMSE, CPU |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name, (wall, cpu, mse, relmse) in best.items():
        for other, (wall2, cpu2, mse2, relmse2) in best.items():
            if name.startswith("lookfrom") and not other.startswith("lookfrom"):
                w, c, m, r = wall / wall2, cpu / cpu2, mse / mse2, relmse / relmse2
                print(f"| {name} / {other} | {w:.2f} | {c:.2f} | {m:.2f} | {r:.2f} | **{w * m:.2f}** | **{c * m:.2f}** | {c * r:.2f} |")
    sys.stdout.flush()


def scenes_of(args):
    scenes = {"cornell": cornell_box(args.size), "balls": balls(args.size)}
    scenes["balls-lens"] = through_lens(balls(args.size), 0.02)
    if args.mesh:
        scenes["mesh-lens"] = through_lens(dragon(args.size, args.mesh), 0.02)
        scenes["mesh"] = dragon(args.size, args.mesh)
        scenes["materials"] = materials(args.size, args.mesh)
    return scenes


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lookfrom", help="the binary")
    parser.add_argument("--mesh", help="a mesh of about 100,000 triangles, .bin")
    parser.add_argument("--scene", action="append", help="cornell, balls, balls-lens, mesh, mesh-lens or materials; all by default")
    parser.add_argument("--threads", type=int, action="append", help="how many; 2 and then 1 by default")
    parser.add_argument("--size", type=int, default=256, help="rows and columns")
    parser.add_argument("--samples", type=int, default=64, help="samples a pixel where time is taken")
    parser.add_argument("--turns", type=int, default=5, help="how often each is timed")
    parser.add_argument("--reference", type=int, default=2048, help="samples a pixel of each program for the true picture, which the folder keeps")
    parser.add_argument("--variant", action="append", help="of Mitsuba; llvm_ad_rgb and scalar_rgb by default")
    parser.add_argument("--mitsuba-sampler", action="append", help="independent and multijitter by default")
    parser.add_argument("--rectangles", action="store_true", help="give Mitsuba its own rectangles, not two triangles")
    parser.add_argument("--folder", default="/tmp/lookfrom-mitsuba", help="for scenes and pictures")
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.worker:
        mitsuba_worker(args)
        return
    if not args.lookfrom:
        parser.error("--lookfrom is missing: the path of a release build")

    folder = Path(args.folder)
    folder.mkdir(parents=True, exist_ok=True)
    scenes = {name: scene for name, scene in scenes_of(args).items() if not args.scene or name in args.scene}
    threads = args.threads or [2, 1]
    variants = args.variant or ["llvm_ad_rgb", "scalar_rgb"]
    samplers = args.mitsuba_sampler or ["independent", "multijitter"]
    references = {}
    for count in threads:
        ways = ("independent", "uniform"), ("sobol", "uniform"), ("sobol", "adaptive")
        ours = [Lookfrom(args.lookfrom, scenes, folder, count, *way) for way in ways]
        theirs = [Mitsuba(v, args, folder, count, s) for v in variants for s in samplers]
        for name in scenes:
            if name not in references:
                kept = folder / f"{name}-{args.size}-{args.reference}.npy"
                if kept.exists():
                    references[name] = np.load(kept)
                else:
                    print(f"\n{name}: is it the same picture?")
                    pair = [many(r, name, args.reference, 256, 100) for r in (ours[1], theirs[len(samplers) - 1])]
                    for label, picture in zip(("ours", "mitsuba"), pair):
                        np.save(folder / f"{name}-{label}.npy", picture[0])
                    references[name] = same_picture(*pair)
                    np.save(kept, references[name])
            rows = measure(name, ours + theirs, args.samples, args.turns, references[name])
            print_table(name, rows, count, args.samples, args.size**2)


if __name__ == "__main__":
    main()
