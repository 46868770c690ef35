#!/usr/bin/env python3
"""Pictures of evenly and of adaptively allocated samples: time and error of each, with as many samples.

Needs: pip packages numpy, OpenEXR; a release build of lookfrom.

    allocation.py --lookfrom target/release/lookfrom scenes/soft-shadows.toml "model.gltf --environment sky.hdr"

A scene may be followed by options of `lookfrom render`. The true picture has many samples, evenly allocated. Time is the least CPU time of the
process over the seeds, less that of one sample; errors are means over the seeds. The relative error is (c − true)² / (true² + 0.01), of "nearly all"
pixels without the 0.1 % worst. The last columns are ratios of time × error, even / adaptive: above 1 adaptive is better.
"""

import argparse
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from against_mitsuba import read_exr  # noqa: E402


def render(args, scene, samples, seed, allocation):
    """CPU seconds and the picture."""
    out = Path(args.folder) / "picture.exr"
    command = [args.lookfrom, "render", *scene.split(), "-o", str(out), "--color", "rgb", "--denoise", "off", "--quiet"]
    command += ["--width", args.size, "--height", args.size, "--samples", samples, "--seed", seed, "--allocation", allocation]
    child = subprocess.Popen([str(word) for word in command], stderr=subprocess.PIPE)
    said = child.stderr.read()
    _, status, used = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(said.decode())
    return used.ru_utime, read_exr(out)


def errors(picture, truth):
    """Mean squared error, relative, relative of nearly all pixels."""
    square = (picture - truth) ** 2
    relative = (square / (truth**2 + 0.01)).mean(axis=2).ravel()
    nearly_all = np.sort(relative)[: int(relative.size * 0.999)]
    return square.mean(), relative.mean(), nearly_all.mean()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", help="scene files, with options")
    parser.add_argument("--lookfrom", required=True, help="the binary")
    parser.add_argument("--size", type=int, default=192, help="rows and columns")
    parser.add_argument("--samples", type=int, default=64, help="samples a pixel, in the mean")
    parser.add_argument("--seeds", type=int, default=4, help="pictures of each")
    parser.add_argument("--reference", type=int, default=2048, help="samples a pixel of the true picture, which the folder keeps")
    parser.add_argument("--folder", default="/tmp/lookfrom-allocation", help="for pictures")
    args = parser.parse_args()
    Path(args.folder).mkdir(parents=True, exist_ok=True)
    print("| | time | squared error | relative | of nearly all | time × squared error | time × relative of nearly all |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    rows = []
    for scene in args.scenes:
        kept = Path(args.folder) / f"{scene.replace('/', '_')}-{args.size}-{args.reference}.npy"
        truth = np.load(kept) if kept.exists() else render(args, scene, args.reference, 99, "uniform")[1]
        np.save(kept, truth)
        start = min(render(args, scene, 1, seed, "uniform")[0] for seed in range(3))
        measured = {}
        for seed in range(args.seeds):
            for allocation in ("uniform", "adaptive"):
                time, picture = render(args, scene, args.samples, seed, allocation)
                measured.setdefault(allocation, []).append((time - start, *errors(picture, truth)))
        even, adaptive = ([min(row[0] for row in of), *np.mean([row[1:] for row in of], axis=0)] for of in measured.values())
        ratios = np.divide(adaptive, even)
        rows.append([*ratios, 1 / (ratios[0] * ratios[1]), 1 / (ratios[0] * ratios[3])])
        print(f"| {Path(scene.split()[0]).name} | " + " | ".join(f"{ratio:.2f}" for ratio in rows[-1]) + " |", flush=True)
    print("| geometric mean | " + " | ".join(f"{ratio:.2f}" for ratio in np.exp(np.log(rows).mean(axis=0))) + " |")


if __name__ == "__main__":
    main()
