#!/usr/bin/env python3
"""Random files: the same pictures, bit by bit, at all SIMD levels, on one thread and two, from films that are added up or gone
on with, and after `lookfrom convert`.

Needs: pip package numpy, and mitsuba for its scenes; a release build of lookfrom.

    same_bits.py --lookfrom target/release/lookfrom [--kind gltf mitsuba pbrt toml] [--files FILE …] [--seeds 0 40] [--options]
                 [--folder DIR]

Files are those of gltf_random.py (of every second seed the animations are blurred, of every fifth the integrator is Whitted's),
of mitsuba_random.py, pbrt_random.py and toml_random.py (of every second seed in spectra); --files adds others. With --options
each is rendered with random options: integrators, layers, samplers, lights, filters. A level that the machine does not have is
the next lower one.

The files remain in the folder. That their hits are shaded eight at a time as one by one is a test:

    LOOKFROM_SCENES=/tmp/lookfrom-same-bits cargo test --locked -p lookfrom --test library -- --ignored scenes_of_a_folder
"""

import argparse
import os
import random
import subprocess
import sys
from pathlib import Path

from gltf_files import File

VARIANTS = [("sse2", 1), ("sse2", 2), ("avx2", 2), ("avx512", 2)]
NIGHT = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + bytes(8)


def gltf(folder, seeds):
    """Files, and options of `convert` and `render` for them."""
    night = folder / "night.hdr"
    night.write_bytes(NIGHT)
    for seed in seeds:
        file = File(seed, is_smooth=seed % 2 == 1)
        file.scene()
        path = folder / f"{seed}.glb"
        file.write(path)
        moving = ["--animation", 0, "--at", 0.4] + (["--shutter", 6] if seed % 2 else [])
        options = (moving if file.json["animations"] else []) + (["--environment", night] if seed % 3 else [])
        yield path, options, ["--width", 48] + (["--integrator", "whitted"] if seed % 5 == 0 else [])


def mitsuba(folder, seeds):
    """Scenes, and options of `convert` and `render` for them."""
    import mitsuba
    from mitsuba_random import Grammar, write_inputs

    mitsuba.set_variant("scalar_rgb")
    write_inputs(folder)
    for seed in seeds:
        path = folder / f"{seed}.xml"
        path.write_text(Grammar(seed, folder).scene())
        yield path, ["-D", "spp=9"], ["--color", ["rgb", "spectral"][seed % 2]]


INTEGRATORS = ["path", "path", "path", "whitted", "raycast", "simple_path", "random_walk", "ambient_occlusion", "normals"]
LIGHT_PATHS = ["C<TD>.*", "C<TG>.*", "C<TS>.*", "C<RD>.*", "C<RG>.*", "C<RS>.*", "C.D.*", "C.G+L", "CV.*", "C.*O", "C.*[LB]"]


def options(seed):
    """Random options of `render`."""
    rng = random.Random(seed)
    words = ["--integrator", rng.choice(INTEGRATORS), "--depth", rng.choice([1, 2, 5, 30]), "--samples", rng.choice([1, 5, 16])]
    for share, choices in [
        (0.3, [["--color", "spectral"], ["--color", "rgb"]]),
        (0.3, [["--sampler", "independent"]]),
        (0.5, [["--light-sampler", name] for name in ("uniform", "power", "bvh")]),
        (0.2, [["--portals", "auto"]]),
        (0.3, [["--filter", name] for name in ("box", "gaussian:1.5", "mitchell", "sinc:3", "triangle:2")]),
        (0.6, [["--layers", "geometry"], ["--layers", "motion"]]),
        (0.3, [["--denoise", "on"]]),
        (0.3, [["--allocation", "adaptive"], ["--noise", "0.2"]]),
        (0.2, [["--fireflies", "median"]]),
        (0.2, [["--crop", "7,5,40,20"]]),
        (0.2, [["--instanced-lights"]]),
    ]:
        if rng.random() < share:
            words += rng.choice(choices)
    for number, way in enumerate(rng.sample(LIGHT_PATHS, rng.choice([0, 0, 2, 4]))):
        words += ["--light-path", f"layer{number}={way}"]
    return words


def pbrt(folder, seeds):
    """Scenes, and options of `convert` and `render` for them."""
    from pbrt_random import Grammar, write_inputs

    write_inputs(folder)
    for seed in seeds:
        path = folder / f"{seed}.pbrt"
        path.write_text(Grammar(seed).scene())
        yield path, [], ["--color", ["spectral", "rgb"][seed % 2]]


def toml(folder, seeds):
    """Scenes, and options of `convert` and `render` for them."""
    from toml_random import Grammar, write_inputs

    write_inputs(folder)
    for seed in seeds:
        path = folder / f"{seed}.toml"
        path.write_text(Grammar(seed, folder).scene())
        yield path, [], ["--color", ["spectral", "rgb"][seed % 2]]


KINDS = {"gltf": gltf, "mitsuba": mitsuba, "pbrt": pbrt, "toml": toml}


class Lookfrom:
    def __init__(self, binary, folder, are_random):
        self.binary, self.folder, self.are_random = binary, folder, are_random
        self.format = "exr" if are_random else "pfm"

    def run(self, *words, **variables):
        words = [str(word) for word in (self.binary, *words)]
        ran = subprocess.run(words, env={**os.environ, **variables}, capture_output=True, text=True, check=False)
        if ran.returncode:
            sys.exit(f"{' '.join(words)}: {ran.stderr}")

    def picture(self, path, options, threads=1, **variables):
        out = self.folder / f"picture.{self.format}"
        usual = {"--samples": 9, "--denoise": "off"}
        common = [word for name, value in usual.items() if name not in options for word in (name, value)]
        common += ["--seed", 3, "--quiet", "--threads", threads, "-o", out]
        self.run("render", path, *options, *common, **variables)
        return out.read_bytes()

    def developed(self, film):
        out = self.folder / "developed.pfm"
        self.run("develop", film, "--denoise", "off", "-o", out)
        return out.read_bytes()

    def films(self, path, options):
        """Names of films, and the pictures that are made of them."""
        common = ["--seed", 3, "--denoise", "off", "--quiet", "--film"]
        parts = [self.folder / f"part-{part}.exr" for part in (3, 1, 2)]
        for part in parts:
            self.run("render", path, *options, *common, "--samples", 9, "--part", f"{part.stem[-1]}/3", "-o", part)
        whole, stopped = self.folder / "whole.exr", self.folder / "stopped.exr"
        self.run("merge", *parts, "--quiet", "-o", whole)
        yield "merge", self.developed(whole)
        self.run("render", path, *options, *common, "--samples", 4, "-o", stopped)
        self.run("resume", stopped, "--samples", 9, "--quiet")
        yield "resume", self.developed(stopped)

    def differences(self, path, of_file, of_picture):
        """The ways in which the file makes another picture."""
        first = self.picture(path, of_file + of_picture)
        for level, threads in VARIANTS:
            if self.picture(path, of_file + of_picture, threads, LOOKFROM_SIMD=level) != first:
                yield f"{level}, {threads} threads"
        # An EXR names its scene, and layers go the same ways through films as the picture does.
        if self.are_random:
            return
        for name, picture in self.films(path, of_file + of_picture):
            if picture != first:
                yield name
        converted = self.folder / f"{path.stem}-converted.toml"
        self.run("convert", path, *of_file, "--force", "--quiet", "-o", converted)
        if self.picture(converted, of_picture) != first:
            yield "convert"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lookfrom", required=True, type=Path, help="the binary")
    parser.add_argument("--kind", nargs="*", choices=list(KINDS), default=["gltf"])
    parser.add_argument("--files", nargs="*", type=Path, default=[], help="other scenes and models, rendered 64 pixels wide")
    parser.add_argument("--seeds", type=int, nargs=2, default=[0, 40], metavar=("FIRST", "END"))
    parser.add_argument("--options", action="store_true", help="render with random options")
    parser.add_argument("--folder", type=Path, default=Path("/tmp/lookfrom-same-bits"))
    args = parser.parse_args()
    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    lookfrom, count, differ = Lookfrom(args.lookfrom.resolve(), folder, args.options), 0, 0
    files = [(path, [], ["--width", 64]) for path in args.files]
    for make in [KINDS[kind] for kind in args.kind]:
        files += make(folder, range(*args.seeds))
    for number, (path, of_file, of_picture) in enumerate(files):
        if args.options:
            of_picture = ["--width", 48, *options(args.seeds[0] + number)]
        found = list(lookfrom.differences(path, of_file, of_picture))
        count, differ = count + 1, differ + bool(found)
        if found:
            print(f"{path} {' '.join(map(str, of_picture))}: {'; '.join(found)}", flush=True)
    print(f"{differ} of {count} files make different pictures")


if __name__ == "__main__":
    main()
