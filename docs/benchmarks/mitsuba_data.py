#!/usr/bin/env python3
"""Mitsuba 3's own test scenes by lookfrom, judged by the Z-test of Mitsuba's developers against their references.

Needs: pip packages numpy, OpenEXR; a release build of lookfrom; the folder tests/scenes of the repository mitsuba-renderer/mitsuba-data.

    mitsuba_data.py --lookfrom target/release/lookfrom --scenes ../shared/mitsuba/tests/scenes [--color rgb,spectral] [--only NAME] [--keep DIR]

The test is that of Mitsuba's test_renders.py. Both pictures are in XYZ. A pixel's channel passes when the probability of a distance as large as that
from the reference, by the variance of one sample that the reference brings, is more than the significance 0.01 with the correction of Šidák for the
number of pixels. A scene passes when 99.75 % of the numbers do. Each picture takes 2 million samples.
"""

import argparse
import math
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR

SAMPLES, SIGNIFICANCE, SHARE = 2_000_000, 0.01, 0.9975
LEAST_VARIANCE = 1e-4
XYZ_FROM_RGB = np.array([[0.412453, 0.357580, 0.180423], [0.212671, 0.715160, 0.072169], [0.019334, 0.119193, 0.950227]])


def xyz(path):
    channels = OpenEXR.File(str(path)).channels()
    if "RGB" in channels:
        rgb = channels["RGB"].pixels
    elif "RGBA" in channels:
        rgb = channels["RGBA"].pixels[..., :3]
    else:
        rgb = np.stack([channels[name].pixels for name in "RGB"], axis=-1)
    return rgb.astype(np.float64) @ XYZ_FROM_RGB.T


def share_that_passes(image, reference, variance, samples):
    """The share of numbers that pass, and the mean of |z|, 0.80 where nothing but noise is different."""
    z = np.abs(image - reference) * np.sqrt(samples / np.maximum(variance, LEAST_VARIANCE))
    pixels = z.shape[0] * z.shape[1]
    level = 1 - (1 - SIGNIFICANCE) ** (1 / pixels)
    passes = np.vectorize(lambda value: math.erfc(value / math.sqrt(2)) > level)(z)
    return passes.mean(), z.mean()


def judge(lookfrom, scene, color, folder):
    stem = scene.stem.rsplit("_", 1)[0]
    reference = scene.parent / "refs" / f"{stem}_ref_{color}.exr"
    variance = reference.with_name(f"{stem}_ref_{color}_var.exr")
    if not (reference.exists() and variance.exists()):
        return None
    want = xyz(reference)
    samples = SAMPLES // (want.shape[0] * want.shape[1])
    picture = folder / f"{stem}.{color}.exr"
    command = [lookfrom, "render", scene, "--samples", str(samples), "--color", color, "-o", picture, "--quiet"]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if ran.returncode:
        return False, ran.stderr.strip().splitlines()[0]
    got = xyz(picture)
    if got.shape != want.shape:
        return False, f"{got.shape[1]} × {got.shape[0]} pixels, the reference has {want.shape[1]} × {want.shape[0]}"
    share, distance = share_that_passes(got, want, xyz(variance), samples)
    brighter = got.sum(axis=(0, 1)) / want.sum(axis=(0, 1)) - 1
    told = f"{100 * share:.2f} % pass, mean of abs(z) {distance:.2f}, means " + " ".join(f"{100 * ratio:+.2f}" for ratio in brighter) + " %"
    return bool(share >= SHARE), told


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lookfrom", required=True)
    parser.add_argument("--scenes", required=True, type=Path)
    parser.add_argument("--color", default="rgb,spectral")
    parser.add_argument("--only", default="", help="a part of the names of scenes")
    parser.add_argument("--keep", type=Path, help="folder for the pictures")
    options = parser.parse_args()
    scenes = [scene for scene in sorted(options.scenes.glob("*/*.xml")) if options.only in scene.name]
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for color in options.color.split(","):
            verdicts = []
            print(f"| {color} | | |\n| --- | --- | --- |")
            for scene in scenes:
                verdict = judge(options.lookfrom, scene, color, folder)
                if verdict is not None:
                    verdicts.append(verdict[0])
                    print(f"| {scene.stem} | {'passes' if verdict[0] else 'fails'} | {verdict[1]} |", flush=True)
            print(f"\n{sum(verdicts)} of {len(verdicts)} pass\n")


if __name__ == "__main__":
    main()
