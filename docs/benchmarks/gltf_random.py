#!/usr/bin/env python3
"""Random glTF files by lookfrom and by Blender's Cycles, compared block by block.

Needs: pip packages bpy (5.0.1 was used, Python 3.11), numpy, OpenEXR; a release build of lookfrom.

    gltf_random.py --lookfrom target/release/lookfrom [--seeds 0 40] [--samples 256] [--kind KIND] [--without FEATURE …]
                   [--shutter FRAMES] [--folder DIR]

A file (gltf_files.py) has a floor and two to five meshes under nodes of any kind: accessors of all types, interleaved, sparse and
quantized; strips and fans; morph targets, skins, instances, animations; textures with transforms, samplers and two sets of
coordinates; vertex colours, opacity, lights and cameras. Both programs read it on their own, with paths of the same length. A mean
of a block of pixels differs when it is more than 3 % and six standard errors off; a file is told by `<<<` when more than three
of 144 do. --shutter opens the shutter of both for so many frames: then animations are smooth, and more nodes have one, the
camera's too.

Left out, because Blender is known to be different: colours that are interpolated in their encoding, the scale of normal maps,
normals of bent surfaces, colours of glass, soft edges of spots, rotations between keys, negative weights in animations, and backs
that are not drawn. Files with metals, coats and normal maps differ at grazing angles, by up to a tenth.
"""

import argparse
import subprocess
import sys
from pathlib import Path

from against_cycles import read_exr
from blocks import HEIGHT, WIDTH, block_means, compare
from gltf_files import FEATURES, KINDS, File

PICTURES, DEPTH, TIME, FPS = 4, 6, 0.4375, 24


def worker():
    """Renders the files that standard input names, by Cycles: samples, frames of the shutter and a path to a line."""
    import bpy

    for line in sys.stdin:
        samples, shutter, path = line.split()
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.import_scene.gltf(filepath=path, export_import_convert_lighting_mode="COMPAT")
        scene = bpy.context.scene
        scene.camera = next(each for each in bpy.data.objects if each.type == "CAMERA")
        scene.world = bpy.data.worlds.new("world")
        scene.world.use_nodes = True
        scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0, 0, 0, 1)
        for light in bpy.data.lights:
            if light.type in ("POINT", "SPOT"):
                light.shadow_soft_size = 0.0
            else:
                light.angle = 0.0
        scene.render.fps = FPS
        frame = TIME * FPS
        scene.frame_set(int(frame), subframe=frame % 1)
        scene.render.use_motion_blur = float(shutter) > 0
        if scene.render.use_motion_blur:
            scene.render.motion_blur_shutter, scene.render.motion_blur_position = float(shutter), "START"
            for each in bpy.data.objects:
                each.cycles.use_motion_blur = each.cycles.use_deform_motion = True
                each.cycles.motion_steps = 7
        scene.render.engine = "CYCLES"
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.color_depth = "32"
        scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
        scene.render.resolution_percentage = 100
        cycles = scene.cycles
        cycles.device, cycles.use_adaptive_sampling, cycles.use_denoising = "CPU", False, False
        cycles.pixel_filter_type, cycles.filter_width, cycles.samples = "BOX", 1.0, int(samples)
        bounces = "max_bounces diffuse_bounces glossy_bounces transmission_bounces transparent_max_bounces"
        for name in bounces.split():
            setattr(cycles, name, 64 if "transparent" in name else DEPTH - 1)
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
        cycles.blur_glossy = 0
        for seed in range(PICTURES):
            cycles.seed = seed
            scene.render.filepath = f"{path}-{seed}.exr"
            bpy.ops.render.render(write_still=True)
        print(f"\n@{path}", flush=True)


class Cycles:
    def __init__(self):
        command = [sys.executable, __file__, "--worker"]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )

    def render(self, path, samples, shutter):
        self.process.stdin.write(f"{samples} {shutter} {path}\n")
        self.process.stdin.flush()
        for line in self.process.stdout:
            if line.startswith("@"):
                return [read_exr(f"{path}-{seed}.exr") for seed in range(PICTURES)]
        sys.exit("Cycles ended")


def by_lookfrom(lookfrom, path, samples, shutter):
    pictures = []
    # In place of the studio, which lights what has no lamps.
    night = path.with_name("night.hdr")
    night.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + bytes(8))
    for seed in range(PICTURES):
        out = path.with_suffix(".exr")
        command = [lookfrom, "render", path, "--size", f"{WIDTH}x{HEIGHT}"]
        command += ["--samples", samples, "--seed", seed, "--denoise", "off"]
        command += [] if shutter is None else ["--animation", 0, "--at", TIME, "--fps", FPS, "--shutter", shutter]
        command += ["--depth", DEPTH, "--filter", "box:0.5", "--environment", night, "-o", out]
        ran = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
        if ran.returncode:
            sys.exit(f"{path}: {ran.stderr}")
        pictures.append(read_exr(out))
    return pictures, [line for line in ran.stderr.splitlines() if line.startswith("warning")]


def main():
    if sys.argv[1:2] == ["--worker"]:
        worker()
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lookfrom", required=True, type=Path, help="the binary")
    parser.add_argument("--seeds", type=int, nargs=2, default=[0, 40], metavar=("FIRST", "END"))
    parser.add_argument("--samples", type=int, default=256, help="of each pixel")
    parser.add_argument("--kind", choices=KINDS, help="all materials but the floor's are of this kind")
    parser.add_argument("--without", nargs="*", choices=FEATURES, default=[], help="features that are left out")
    parser.add_argument("--shutter", type=float, default=0, metavar="FRAMES", help="blurs what moves")
    parser.add_argument("--folder", type=Path, default=Path("/tmp/lookfrom-gltf"))
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    cycles, told = Cycles(), 0
    for seed in range(*args.seeds):
        path = args.folder.resolve() / f"{seed}.glb"
        file = File(seed, args.without, is_smooth=args.shutter > 0)
        file.scene(args.kind)
        file.write(path)
        theirs = cycles.render(path, args.samples, args.shutter)
        ours, warnings = by_lookfrom(args.lookfrom, path, args.samples, args.shutter if file.json["animations"] else None)
        found = compare(block_means(theirs), block_means(ours), 0.03)
        is_told = found.differ > 3
        told += is_told
        said = f"{seed}: {found.change:+.2%}, {found.differ} of {found.count} means differ"
        print(said, *warnings, "<<<" if is_told else "", flush=True)
    print(f"{told} of {args.seeds[1] - args.seeds[0]} files differ")


if __name__ == "__main__":
    main()
