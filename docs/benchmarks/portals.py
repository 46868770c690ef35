#!/usr/bin/env python3
"""Portals that scenes name, or none, against those that are found (`--portals auto`): error and time of both.

Needs: pip packages numpy, OpenEXR; a release build of lookfrom.

    portals.py --lookfrom target/release/lookfrom docs/benchmarks/portals/*.toml "scenes/hero.toml --samples 16"

A scene may be followed by options of `lookfrom render`. The true picture has many samples, of the mode that is better for its
kind, by another seed. Time is the user CPU time of the whole process on one thread, the pre-pass included, the least over the seeds; pictures of both
modes alternate. The relative error is (c − true)² / (true² + 0.01 mean²), of all pixels and of nearly all, without the 0.1 % worst: means over the seeds. The last
columns are named / auto: above 1 auto is better.
"""

import argparse
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from against_mitsuba import read_exr  # noqa: E402

MODES = ("named", "auto")


def render(args, scene, samples, seed, portals, threads=1):
    """CPU seconds and the picture."""
    out = Path(args.folder) / "picture.exr"
    command = [args.lookfrom, "render", *scene.split(), "-o", out, "--color", "rgb", "--denoise", "off", "--quiet"]
    command += ["--integrator", "path", "--width", args.size, "--height", args.size, "--samples", samples, "--seed", seed]
    command += ["--portals", portals, "--threads", threads]
    child = subprocess.Popen([str(word) for word in command], stderr=subprocess.PIPE)
    said = child.stderr.read()
    _, status, used = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(said.decode())
    return used.ru_utime, read_exr(out)


def errors(picture, truth):
    """Relative error, and that of nearly all pixels."""
    relative = ((picture - truth) ** 2 / (truth**2 + 0.01 * truth.mean() ** 2)).mean(axis=2).ravel()
    return relative.mean(), np.sort(relative)[: int(relative.size * 0.999)].mean()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", help="scene files, with options")
    parser.add_argument("--lookfrom", required=True, help="the binary")
    parser.add_argument("--size", type=int, default=128, help="rows and columns")
    parser.add_argument("--samples", type=int, default=64, help="samples a pixel")
    parser.add_argument("--seeds", type=int, default=3, help="pictures of each")
    parser.add_argument("--reference", type=int, default=4096, help="samples a pixel of the true picture, which the folder keeps")
    parser.add_argument("--of-reference", choices=MODES, default="auto", help="the mode of the true picture")
    parser.add_argument("--folder", default="/tmp/lookfrom-portals", help="for pictures")
    args = parser.parse_args()
    Path(args.folder).mkdir(parents=True, exist_ok=True)
    print("| | named s | auto s | named relMSE | auto relMSE | error × time | of nearly all |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for scene in args.scenes:
        kept = Path(args.folder) / f"{scene.replace('/', '_')}-{args.size}-{args.reference}-{args.of_reference}.npy"
        truth = np.load(kept) if kept.exists() else render(args, scene, args.reference, 99, args.of_reference, 2)[1]
        np.save(kept, truth)
        measured = {mode: [] for mode in MODES}
        for seed in range(args.seeds):
            for mode in MODES:
                time, picture = render(args, scene, args.samples, seed, mode)
                measured[mode].append((time, *errors(picture, truth)))
        rows = [[min(row[0] for row in of), *np.mean([row[1:] for row in of], axis=0)] for of in measured.values()]
        (named, *of_named), (auto, *of_auto) = rows
        gains = [named * n / (auto * a) for n, a in zip(of_named, of_auto)]
        print(f"| {scene} | {named:.2f} | {auto:.2f} | {of_named[0]:.5f} | {of_auto[0]:.5f} | {gains[0]:.2f} | {gains[1]:.2f} |", flush=True)


if __name__ == "__main__":
    main()
