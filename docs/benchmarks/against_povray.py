#!/usr/bin/env python3
"""Whitted's ray tracing by lookfrom and by POV-Ray, side by side: user CPU time of one thread.

Needs: POV-Ray 3.7 (Debian's povray), a release build of lookfrom; for --check pip packages numpy and Pillow.

    against_povray.py --lookfrom target/release/lookfrom [--turns 3] [--size 320 240] [--samples 64] [SCENE ...]

The scenes are those of the folder `whitted`, and five that are written for both programs from one description: mirrors, a grid of
glass, solids and tori, ten thousand balls, 25 lights. The programs take turns; a ratio is that of their least times, with those of single turns
beside it. --check compares the pictures: their means, and the root mean square of differences of sRGB values of 0 … 1.
"""

import argparse
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).resolve().parent / "whitted"
SCENES = HERE.parents[2] / "scenes"
FILES = ["spheres", "glass", "textures", "mesh"]


class Shape(NamedTuple):
    """A shape for lookfrom, and for POV-Ray up to its material."""

    toml: str
    pov: str

    def of(self, material):
        return Shape(f'{self.toml}, material = "{material}"', f"{self.pov} texture {{ {material.title()} }}")


def vector(values):
    return "<" + ", ".join(str(x) for x in values) + ">"


def ball(center, radius):
    return Shape(f'type = "sphere", center = {list(center)}, radius = {radius}', f"sphere {{ {vector(center)}, {radius}")


def box(low, high):
    return Shape(f'type = "box", min = {list(low)}, max = {list(high)}', f"box {{ {vector(low)}, {vector(high)}")


def cylinder(ends, radius):
    start, end = ends
    toml = f'type = "cylinder", from = {list(start)}, to = {list(end)}, radius = {radius}'
    return Shape(toml, f"cylinder {{ {vector(start)}, {vector(end)}, {radius}")


def torus(center, radius, tube):
    toml = f'type = "torus", center = {list(center)}, radius = {radius}, tube = {tube}'
    return Shape(toml, f"torus {{ {radius}, {tube} translate {vector(center)}")


def solid(operation, *parts):
    toml = f'type = "solid", operation = "{operation}", of = [{", ".join(f"{{ {part.toml} }}" for part in parts)}]'
    return Shape(toml, f"{operation} {{ {' '.join(part.pov + ' }' for part in parts)}")


# Colour, highlight, exponent, and the share that is reflected; glass has Fresnel's.
MATERIALS = {
    "red": ((0.75, 0.1, 0.08), 0.4, 50, 0),
    "green": ((0.1, 0.6, 0.15), 0.4, 50, 0),
    "blue": ((0.12, 0.2, 0.75), 0.4, 50, 0),
    "silver": ((0.1, 0.1, 0.1), 0.4, 100, 0.75),
    "glass": ((0, 0, 0), 0.4, 200, None),
}
SUN = [((-4, 7, 5), 0.9)]


def mirrors():
    """Balls of silver and of colours between three walls of mirrors."""
    walls = [box((-4, 0, -4), (4, 4, -3.8)), box((-4, 0, -3.8), (-3.8, 4, 3)), box((3.8, 0, -3.8), (4, 4, 3))]
    names = ["silver", "red", "silver", "green", "silver", "blue"]
    places = [(i, k) for i in range(5) for k in range(4)]
    balls = [ball((1.2 * i - 2.4, 0.5, 1.2 * k - 2.4), 0.5).of(names[(i + 2 * k) % 6]) for i, k in places]
    return [wall.of("silver") for wall in walls] + balls, SUN


def glass_grid():
    """Balls of glass in a grid."""
    places = [(i, j, k) for i in range(6) for j in range(3) for k in range(3)]
    return [ball((i - 2.5, 0.4 + 0.9 * j, 0.5 - k), 0.4).of("glass") for i, j, k in places], SUN


def solids():
    """What is cut out of boxes and balls, a lens, and tori."""

    def die(x, y, z):
        ends = [((x - 1, y, z), (x + 1, y, z)), ((x, y - 1, z), (x, y + 1, z)), ((x, y, z - 1), (x, y, z + 1))]
        whole = solid("intersection", box((x - 0.5, y - 0.5, z - 0.5), (x + 0.5, y + 0.5, z + 0.5)), ball((x, y, z), 0.66))
        return solid("difference", whole, *(cylinder(pair, 0.3) for pair in ends))

    bowl = solid("difference", ball((0, 0.7, -0.6), 0.7), ball((0, 0.7, -0.6), 0.62), box((-1, 0.8, -2), (1, 2, 1)))
    lens = solid("intersection", ball((0, 0.8, 1.2), 1.2), ball((0, 0.8, 2.8), 1.2))
    shapes = [die(-1.8, 0.6, 0.4).of("red"), die(1.8, 0.6, 0.4).of("silver"), bowl.of("blue"), lens.of("glass")]
    tori = {"green": (-0.9, 0.2, 2.6), "silver": (0.9, 0.2, 2.6), "red": (2.6, 0.2, 1.9), "glass": (-2.6, 0.2, 1.9)}
    return shapes + [torus(center, 0.4, 0.18).of(material) for material, center in tori.items()], SUN


def balls():
    """Ten thousand balls, of which one of five reflects."""
    names = ["red", "green", "blue", "red", "silver"]
    places = [(i, k) for i in range(100) for k in range(100)]
    shapes = [ball((round(0.1 * i - 4.95, 2), 0.05, round(4.5 - 0.1 * k, 2)), 0.045).of(names[(3 * i + 7 * k + i * k) % 5]) for i, k in places]
    return shapes, SUN


def lights():
    """Nine balls under 25 lights."""
    names = ["red", "green", "blue", "silver"]
    places = [(i, k) for i in range(3) for k in range(3)]
    shapes = [ball((1.5 * i - 1.5, 0.6, 1.5 * k - 2), 0.6).of(names[(i + 2 * k) % 4]) for i, k in places]
    return shapes, [((2.0 * i - 4, 6, 2.0 * k - 3), 0.045) for i in range(5) for k in range(5)]


WRITTEN = {"mirrors": mirrors, "glass-grid": glass_grid, "solids": solids, "balls": balls, "lights": lights}


def write(name, folder):
    """Writes the scene for both programs; its camera, floor and sky are those of `spheres`."""
    shapes, lamps = WRITTEN[name]()
    common, rest = (HERE / "spheres.toml").read_text().split("[materials.red]")
    toml = ["shape = [", *(f"    {{ {shape.toml} }}," for shape in shapes), "]", common]
    povray = ['#include "camera.inc"', "#default { finish { ambient 0.2 diffuse 1 specular 0 } }"]
    for material, (color, specular, shininess, mirror) in MATERIALS.items():
        toml += [f"[materials.{material}]", f"diffuse = {list(color)}", f"specular = {specular}", f"shininess = {shininess}"]
        highlight = f"specular {specular} roughness 1/{shininess}"
        if mirror is None:
            toml += ["mirror = 1", "transmission = 1", "ior = 1.5", "fresnel = true"]
            finish = f"ambient 0 diffuse 0 {highlight} reflection {{ 0, 1 fresnel }} conserve_energy"
            povray.append(f"#declare {material.title()} = texture {{ pigment {{ rgbt 1 }} finish {{ {finish} }} }}")
        else:
            toml.append(f"mirror = {mirror}")
            pigment = f"pigment {{ rgb {vector(color)} }}"
            povray.append(f"#declare {material.title()} = texture {{ {pigment} finish {{ {highlight} reflection {mirror} }} }}")
    # The file's lights, but for the point light.
    ambient, _, sky = ("[[light]]" + part for part in rest.split("[[light]]")[1:])
    toml += ['[[plane]]\nsize = 20000\nmaterial = "floor"', ambient, sky]
    for position, intensity in lamps:
        toml.append(f'[[light]]\ntype = "point"\nposition = {list(position)}\nintensity = {intensity}\nfalloff = "none"')
        povray.append(f"light_source {{ {vector(position)} rgb {intensity} }}")
    for shape in shapes:
        povray.append(shape.pov + (" interior { ior 1.5 }" if "texture { Glass }" in shape.pov else "") + " }")
    povray.append("plane { y, 0 pigment { Checkerboard } }")
    (folder / f"{name}.toml").write_text("\n".join(toml) + "\n")
    (folder / f"{name}.pov").write_text("\n".join(povray) + "\n")
    # The camera without its light.
    camera = (HERE / "camera.inc").read_text().splitlines(keepends=True)
    (folder / "camera.inc").write_text("".join(line for line in camera if not line.startswith("light_source")))
    return folder


def user_seconds(command, folder):
    child = subprocess.Popen([str(word) for word in command], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = status
    if status != 0:
        sys.exit(f"failed in {folder}: {' '.join(map(str, command))}")
    return used.ru_utime


def commands(name, folder, args):
    """The folder of a scene, and the commands that render it: by POV-Ray and by lookfrom."""
    where = write(name, folder) if name in WRITTEN else HERE
    (width, height), rays = args.size, math.isqrt(args.samples)
    theirs = ["povray", f"{name}.pov", f"+W{width}", f"+H{height}", "+A0.0", "+AM1", f"+R{rays}", "-J", "+WT1", "-D"]
    theirs += [f"+L{SCENES / 'images'}", f"+L{folder}", f"+O{folder / name}-povray.png"]
    ours = [args.lookfrom, "render", f"{name}.toml", "--width", width, "--height", height, "--samples", rays * rays, "--threads", 1]
    return where, theirs, [*ours, "--quiet", "-o", folder / f"{name}-lookfrom.png"]


def check(name, folder):
    import numpy as np
    from PIL import Image

    theirs, ours = (np.asarray(Image.open(folder / f"{name}-{of}.png").convert("RGB"), float) / 255 for of in ("povray", "lookfrom"))
    return f"   means {theirs.mean():.4f} {ours.mean():.4f}, RMSE {np.sqrt(np.square(theirs - ours).mean()):.4f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=[*FILES, *WRITTEN])
    parser.add_argument("--lookfrom", required=True, type=Path, help="the binary")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--size", type=int, nargs=2, default=[320, 240])
    parser.add_argument("--samples", type=int, default=64, help="of each pixel: a square")
    parser.add_argument("--check", action="store_true", help="compare the pictures")
    parser.add_argument("--folder", type=Path, default=Path("/tmp/lookfrom-povray"))
    args = parser.parse_args()
    args.lookfrom, args.folder = args.lookfrom.resolve(), args.folder.resolve()
    args.folder.mkdir(parents=True, exist_ok=True)
    knot = subprocess.run([sys.executable, HERE / "mesh.py", "Knot"], stdin=open(SCENES / "models" / "knot.obj"), capture_output=True, check=True)
    (args.folder / "knot.inc").write_bytes(knot.stdout)
    ratios = []
    for name in args.scenes:
        folder, theirs, ours = commands(name, args.folder, args)
        turns = [(user_seconds(theirs, folder), user_seconds(ours, folder)) for _ in range(args.turns)]
        least = [min(turn[program] for turn in turns) for program in (0, 1)]
        single = sorted(turn[0] / turn[1] for turn in turns)
        ratios.append(least[0] / least[1])
        print(f"| {name} | {least[0]:.2f} | {least[1]:.3f} | **{ratios[-1]:.2f}** | {single[0]:.2f}–{single[-1]:.2f} |", flush=True)
        if args.check:
            print(check(name, args.folder))
    mean = math.exp(sum(map(math.log, ratios)) / len(ratios))
    print(f"| geometric mean | | | **{mean:.2f}** | |")


if __name__ == "__main__":
    main()
