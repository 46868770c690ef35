#!/usr/bin/env python3
"""Time and error of filters of textures: a tiled floor to the horizon, and the same floor from so near that no filter has anything to do.

    textures.py --lookfrom target/release/lookfrom

The true picture is bilinear with many samples. Errors are mean squares over the picture, as ratios to bilinear's with as many samples; time is the least user time of the
process over turns, of `--timed` samples less those of one, as a ratio to bilinear's; memory is the most that the process had.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

SCENE = """
[camera]
lookfrom = {eye}
lookat = {at}
fov = 50
[image]
width = 320
height = 160
filter = "box"
[render]
integrator = "path"
color = "rgb"
depth = {depth}
[[light]]
type = "environment"
zenith = 0.9
horizon = 0.9
nadir = 0.9
[materials.floor]
type = "diffuse"
reflectance = {texture}
[[mesh]]
material = "floor"
positions = [[-900, 0, 5], [900, 0, 5], [900, 0, -900], [-900, 0, -900]]
uvs = [[-900, -5], [900, -5], [900, 900], [-900, 900]]
triangles = [[0, 1, 2], [0, 2, 3]]
"""

FAR = {"eye": "[0, 1.2, 0]", "at": "[0, 0.75, -4]"}
NEAR = {"eye": "[0.3, 0.02, 0.2]", "at": "[0.3, 0, 0.19]"}


def image(filter):
    return f'{{ type = "image", file = "{{tiles}}", scale = {{scale}}, {filter} }}'


def checker(footprint):
    return f'{{ type = "checker", even = 0.9, odd = 0.1, scale = {{scale}}{footprint} }}'


IMAGES = [("bilinear", image('filter = "bilinear"'))] + [
    (f"{name}, {width}", image(f'filter = "{name}", footprint = {width}'))
    for name in ("trilinear", "ewa") for width in (1, 0.5, 0.25, 0.125)
]
CHECKERS = [("sharp", checker(""))] + [(f"footprint {width}", checker(f", footprint = {width}")) for width in (1, 0.5, 0.125)]


def render(args, scene, samples, out, seed=0):
    """Seconds of user time, and bytes at most."""
    path = args.folder / "scene.toml"
    path.write_text(scene)
    command = [args.lookfrom, "render", path, "-o", out, "--samples", samples, "--seed", seed, "--threads", 1, "--quiet"]
    child = subprocess.Popen([str(word) for word in command], stderr=subprocess.PIPE)
    said = child.stderr.read()
    _, status, used = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(said.decode())
    return used.ru_utime, used.ru_maxrss / 1024


def compared(args, picture, truth):
    """Mean square of the error, and the relative difference of the means."""
    command = [args.lookfrom, "compare", "--json", picture, truth]
    found = json.loads(subprocess.run([str(word) for word in command], capture_output=True).stdout)
    return found["rmse"] ** 2, max(found["relative"], key=abs)


def table(args, title, place, textures, scale):
    counts = [1, 4, 16, 64]
    scenes = []
    for name, texture in textures:
        texture = texture.replace("{tiles}", str(args.tiles)).replace("{scale}", str(scale))
        scenes.append((name, SCENE.format(texture=texture, depth=1, **place)))
    truth = args.folder / "truth.exr"
    render(args, scenes[0][1], args.reference, truth, seed=99)
    print(f"\n{title}\n\n| filter | time of a sample | " + " | ".join(f"MSE at {count}" for count in counts) + " | mean at 64 |")
    print("| --- |" + " ---: |" * (len(counts) + 2))
    picture, times = args.folder / "picture.exr", {}
    for _ in range(args.turns):
        for name, scene in scenes:
            one, many = (render(args, scene, samples, picture)[0] for samples in (1, args.timed))
            times[name] = min(times.get(name, 1e9), many - one)
    base = None
    for name, scene in scenes:
        errors, mean = [], 0
        for count in counts:
            render(args, scene, count, picture)
            error, mean = compared(args, picture, truth)
            errors.append(error)
        base = base or (times[name], errors)
        ratios = " | ".join(f"{error / other:.3f}" for error, other in zip(errors, base[1]))
        print(f"| {name} | {times[name] / base[0]:.2f} | {ratios} | {100 * mean:+.2f} % |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lookfrom", required=True, help="the binary")
    parser.add_argument("--tiles", type=Path, default=Path(__file__).parents[2] / "scenes/images/tiles.png", help="the image")
    parser.add_argument("--reference", type=int, default=2048, help="samples a pixel of the true picture")
    parser.add_argument("--timed", type=int, default=65, help="samples a pixel of the pictures that are timed")
    parser.add_argument("--turns", type=int, default=3, help="turns of the pictures that are timed")
    parser.add_argument("--scale", type=float, default=0.5, help="repetitions of the image in a unit of the floor")
    parser.add_argument("--folder", type=Path, default=Path("/tmp/lookfrom-textures"), help="for pictures")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    args.tiles = args.tiles.resolve()
    table(args, "Far, images", FAR, IMAGES, args.scale)
    table(args, "Near, images", NEAR, IMAGES, args.scale)
    table(args, "Far, checkerboards", FAR, CHECKERS, 2)


if __name__ == "__main__":
    main()
