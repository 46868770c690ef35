#!/usr/bin/env python3
"""Path tracing by lookfrom and by Blender's Cycles, side by side: glTF models under an environment map, by error and time.

Needs: pip packages bpy (5.0.1 was used, Python 3.11), numpy, OpenEXR; a release build of lookfrom.

    against_cycles.py --lookfrom target/release/lookfrom --model FlightHelmet.gltf --environment studio.hdr

Both see the model from the same camera, with a box filter of one pixel and paths of the same length, on one thread. Each picture is compared with
the converged one of its own program, so that differences of materials do not count as noise; pictures are written, to be looked at. Time
is by the clock, less that of a picture with one sample: a thread of Blender's spins while another one renders, so that the CPU time of its process
is about twice the time. So nothing else should run on the machine; --core pins both programs to one core, on which Blender's threads then take
turns. Equal-error time is time × mean relative squared error. Last come the pictures that each makes by default: ours of a model,
and 16 samples of Cycles with OpenImageDenoise.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

DEPTH = 8


def read_exr(path):
    import OpenEXR

    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        for name in ("RGB", "RGBA", "Combined", "ViewLayer.Combined"):
            if name in channels:
                return np.asarray(channels[name].pixels, np.float64)[..., :3]
        return np.stack([channels[c].pixels for c in "RGB"], axis=-1).astype(np.float64)


def relmse(image, reference):
    """The mean over pixels and channels of squared errors, relative to the squared reference."""
    return float((np.square(image - reference) / (np.square(reference) + 0.01)).mean())


def seconds_of(command):
    """Runs a command; the seconds that it takes."""
    before = time.perf_counter()
    if subprocess.run([str(c) for c in command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode != 0:
        sys.exit(f"failed: {' '.join(str(c) for c in command)}")
    return time.perf_counter() - before


class Lookfrom:
    name = "lookfrom"

    def __init__(self, args):
        self.args = args
        self.start = min(self.sampled(1, 0, "--depth", DEPTH)[0] for _ in range(3))

    def run(self, size, *options):
        args, out = self.args, self.args.folder / "ours.exr"
        command = [args.lookfrom, "render", args.model, "-o", out, "--quiet", "--threads", 1, "--size", size, "--filter", "box:0.5"]
        command += ["--lookfrom", vector(args.eye), "--lookat", vector(args.target), "--fov", args.fov, *options]
        if args.environment:
            command += ["--environment", args.environment]
        return seconds_of(command), read_exr(out)

    def sampled(self, samples, seed, *options, size=None):
        return self.run(size or self.args.size, "--samples", samples, "--seed", seed, "--denoise", "off", *options)

    def render(self, samples, seed):
        seconds, image = self.sampled(samples, seed, "--depth", DEPTH)
        return (seconds - self.start) * samples / (samples - 1), image

    def default(self):
        """The picture of the model without any settings but its view, and the converged one."""
        return *self.run(512), self.sampled(self.args.reference, 1000, size=512)[1]


class Cycles:
    """A process that holds the scene."""

    name = "Cycles"

    def __init__(self, args):
        command = [sys.executable, __file__, "--worker", json.dumps({**vars(args), "folder": str(args.folder)})]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.start = min(self.run(1, 0)[0] for _ in range(3))

    def run(self, samples, seed, size=0, denoise=0):
        self.process.stdin.write(f"{samples} {seed} {size} {denoise}\n")
        self.process.stdin.flush()
        for line in self.process.stdout:
            if line.startswith("@"):
                seconds, path = line[1:].split(maxsplit=1)
                return float(seconds), read_exr(path.strip())
        sys.exit("Cycles ended")

    def render(self, samples, seed):
        seconds, image = self.run(samples, seed)
        return (seconds - self.start) * samples / (samples - 1), image

    def default(self):
        return *self.run(16, 0, 512, 1), self.run(self.args.reference, 1000, 512)[1]


def vector(values):
    return ",".join(repr(v) for v in values)


def worker(settings):
    """Renders what standard input asks for: samples, seed, size, whether to denoise."""
    import bpy
    from mathutils import Vector

    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(Path(settings["model"]).resolve()))
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        if thing.type in ("CAMERA", "LIGHT"):
            bpy.data.objects.remove(thing)

    # glTF's y is up, Blender's z is.
    def point(v):
        return Vector((v[0], -v[2], v[1]))

    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit, lens.angle = "VERTICAL", np.radians(settings["fov"])
    camera = bpy.data.objects.new("camera", lens)
    scene.collection.objects.link(camera)
    camera.location = point(settings["eye"])
    camera.rotation_euler = (point(settings["target"]) - point(settings["eye"])).to_track_quat("-Z", "Y").to_euler()
    scene.camera = camera

    world = bpy.data.worlds.new("world")
    scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = nodes["Background"]
    if settings["environment"]:
        picture = nodes.new("ShaderNodeTexEnvironment")
        picture.image = bpy.data.images.load(str(Path(settings["environment"]).resolve()))
        place, where = nodes.new("ShaderNodeMapping"), nodes.new("ShaderNodeTexCoord")
        place.inputs["Rotation"].default_value[2] = np.radians(settings["turn"])
        links.new(where.outputs["Generated"], place.inputs["Vector"])
        links.new(place.outputs["Vector"], picture.inputs["Vector"])
        links.new(picture.outputs["Color"], background.inputs["Color"])
    else:
        background.inputs["Color"].default_value = (0, 0, 0, 1)

    scene.render.engine = "CYCLES"
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.use_persistent_data = True
    cycles = scene.cycles
    cycles.device, cycles.use_adaptive_sampling = "CPU", False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces", "transparent_max_bounces"):
        setattr(cycles, name, DEPTH)
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0

    for line in sys.stdin:
        samples, seed, size, denoise = (int(n) for n in line.split())
        scene.render.resolution_x = scene.render.resolution_y = size or settings["size"]
        cycles.samples, cycles.seed, cycles.use_denoising = samples, seed, bool(denoise)
        out = f'{settings["folder"]}/cycles.exr'
        scene.render.filepath = out
        before = time.perf_counter()
        bpy.ops.render.render(write_still=True)
        print(f"\n@{time.perf_counter() - before} {out}", flush=True)


def main():
    if sys.argv[1:2] == ["--worker"]:
        worker(json.loads(sys.argv[2]))
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lookfrom", required=True, help="the binary")
    parser.add_argument("--model", required=True, help="glTF")
    parser.add_argument("--environment", help="an environment map")
    parser.add_argument("--turn", type=float, default=-90.0, help="of the environment in Blender, in degrees")
    parser.add_argument("--eye", type=float, nargs=3, required=True)
    parser.add_argument("--target", type=float, nargs=3, required=True)
    parser.add_argument("--fov", type=float, default=30, help="in degrees, of both sides")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--reference", type=int, default=1024, help="samples of each converged picture")
    parser.add_argument("--default", action="store_true", help="the default pictures of 512² as well")
    parser.add_argument("--core", type=int, help="the core to which both programs are pinned")
    parser.add_argument("--folder", type=Path, default=Path("/tmp/lookfrom-cycles"))
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    if args.core is not None:
        os.sched_setaffinity(0, {args.core})
    found = {}
    for program in (Lookfrom(args), Cycles(args)):
        reference = program.render(args.reference, 1000)[1]
        np.save(args.folder / f"{program.name}.npy", reference)
        rows = [program.render(args.samples, 1 + turn) for turn in range(args.turns)]
        seconds, error = min(row[0] for row in rows), np.mean([relmse(row[1], reference) for row in rows])
        found[program.name] = seconds, error
        print(f"{program.name}: {seconds:.3f} s, relMSE {error:.6f}, mean {reference.mean(axis=(0, 1)).round(4)}", flush=True)
        if args.default:
            seconds, picture, converged = program.default()
            np.save(args.folder / f"{program.name}-default.npy", np.stack([picture, converged]))
            print(f"   by default, 512²: relMSE {relmse(picture, converged):.6f}, {seconds:.2f} s", flush=True)
    (ours, our_error), (theirs, their_error) = found["lookfrom"], found["Cycles"]
    print(f"ours / Cycles: time {ours / theirs:.2f}, relMSE {our_error / their_error:.2f}, equal-error **{ours * our_error / theirs / their_error:.2f}**")


if __name__ == "__main__":
    main()
