#!/usr/bin/env python3
"""Random files: the same pictures, bit by bit, at all SIMD levels, on one thread and two, from films that are added up or gone
on with, and after `lookfrom convert`.

Needs: pip package numpy, and mitsuba for its scenes; a release build of lookfrom.

    same_bits.py --lookfrom target/release/lookfrom [--kind gltf mitsuba] [--files FILE …] [--seeds 0 40] [--folder DIR]

Files are those of gltf_random.py (of every second seed the animations are blurred, of every fifth the integrator is Whitted's)
and of mitsuba_random.py (of every second seed in spectra); --files adds others. A level that the machine does not have is the
next lower one.
"""

import argparse
import os
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


class Lookfrom:
    def __init__(self, binary, folder):
        self.binary, self.folder = binary, folder

    def run(self, *words, **variables):
        words = [str(word) for word in (self.binary, *words)]
        ran = subprocess.run(words, env={**os.environ, **variables}, capture_output=True, text=True, check=False)
        if ran.returncode:
            sys.exit(f"{' '.join(words)}: {ran.stderr}")

    def picture(self, path, options, threads=1, **variables):
        out = self.folder / "picture.pfm"
        common = ["--samples", 9, "--seed", 3, "--denoise", "off", "--quiet", "--threads", threads, "-o", out]
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
    parser.add_argument("--kind", nargs="*", choices=["gltf", "mitsuba"], default=["gltf"])
    parser.add_argument("--files", nargs="*", type=Path, default=[], help="other scenes and models, rendered 64 pixels wide")
    parser.add_argument("--seeds", type=int, nargs=2, default=[0, 40], metavar=("FIRST", "END"))
    parser.add_argument("--folder", type=Path, default=Path("/tmp/lookfrom-same-bits"))
    args = parser.parse_args()
    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    lookfrom, count, differ = Lookfrom(args.lookfrom.resolve(), folder), 0, 0
    files = [(path, [], ["--width", 64]) for path in args.files]
    for make in [{"gltf": gltf, "mitsuba": mitsuba}[kind] for kind in args.kind]:
        files += make(folder, range(*args.seeds))
    for path, of_file, of_picture in files:
        found = list(lookfrom.differences(path, of_file, of_picture))
        count, differ = count + 1, differ + bool(found)
        if found:
            print(f"{path}: {'; '.join(found)}", flush=True)
    print(f"{differ} of {count} files make different pictures")


if __name__ == "__main__":
    main()
