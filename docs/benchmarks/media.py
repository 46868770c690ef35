#!/usr/bin/env python3
"""Media by lookfrom and by Mitsuba 3's volpath, side by side: the same pictures, how much noise for how much time.

Needs: pip packages mitsuba (3.x), numpy, OpenEXR; Debian's libllvm19 (or another that Mitsuba finds); a release build of lookfrom.

    media.py --lookfrom target/release/lookfrom [--turns 4] [--samples 32] [--reference 1024]

The scenes are written here, for both programs, in RGB. First many samples of both are compared: the means of the pictures. Then the programs take
turns on one thread, each turn with another seed. Time is the CPU time of rendering alone: of lookfrom less that of a picture with one sample, of Mitsuba's
llvm_ad_rgb that of a call of `render` when its kernels are compiled already. What is compared is time × mean squared error against the mean of both references.
"""

import argparse
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

WIDTH, HEIGHT = 128, 96


def smoke(cells=32):
    """A column with a wavy axis, zero in the outermost cells, by z, y, x."""
    z, y, x = np.meshgrid(*[(np.arange(cells) + 0.5) / cells] * 3, indexing="ij")
    away = np.hypot(x - 0.5 - 0.15 * np.sin(9 * y), z - 0.5 - 0.15 * np.cos(9 * y))
    grid = np.clip(1 - away * 5, 0, None) * (1 - 0.6 * y)
    for axis in range(3):
        grid = np.moveaxis(grid, axis, 0)
        grid[[0, -1]] = 0
        grid = np.moveaxis(grid, 0, axis)
    return grid.astype(np.float32)


# By scene: camera, coefficients, phase function, density, the box of the medium, lights, depth in bounces.
SCENES = {
    "fog": dict(fov=40, absorption=(0.05, 0.1, 0.2), scattering=(0.5, 0.45, 0.4), g=0.5, grid=None, box=((-2, 0, -2), (2, 2.4, 2)), lamp=20, sky=0.0, depth=15),
    "smoke": dict(fov=40, absorption=(1, 1.5, 2), scattering=(9, 9, 9), g=0.3, grid=smoke(), box=((-1, 0, -1), (1, 2, 1)), lamp=20, sky=0.3, depth=23),
    "milk": dict(fov=40, absorption=(0.01, 0.05, 0.2), scattering=(12, 13, 14), g=0.0, grid=None, box=((-0.8, 0, -0.8), (0.8, 1.4, 0.8)), lamp=20, sky=0.3, depth=63),
}
EYE, TARGET = (0, 1.3, 6), (0, 1, 0)
LAMP = ((-2.6, 3.4, 1.0), 0.4)


def numbers(values):
    return " ".join(repr(float(v)) for v in np.ravel(values))


def pbrt(scene, path):
    low, high = scene["box"]
    kind = '"homogeneous"'
    if scene["grid"] is not None:
        depth, height, width = scene["grid"].shape
        kind = (
            f'"uniformgrid" "integer nx" {width} "integer ny" {height} "integer nz" {depth} '
            f'"float density" [{numbers(scene["grid"])}] "point3 p0" [{numbers(low)}] "point3 p1" [{numbers(high)}]'
        )
    corners = [[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)]
    faces = [0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5]
    path.write_text(f"""
Scale -1 1 1 LookAt {numbers(EYE)} {numbers(TARGET)} 0 1 0 Camera "perspective" "float fov" {scene["fov"]}
Film "rgb" "integer xresolution" {WIDTH} "integer yresolution" {HEIGHT}
PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5 Integrator "volpath" "integer maxdepth" {scene["depth"]}
WorldBegin
LightSource "infinite" "rgb L" [{numbers([scene["sky"]] * 3)}]
MakeNamedMedium "m" "string type" {kind} "rgb sigma_a" [{numbers(scene["absorption"])}] "rgb sigma_s" [{numbers(scene["scattering"])}] "float g" {scene["g"]}
AttributeBegin Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-9 -0.01 -9 -9 -0.01 9 9 -0.01 9 9 -0.01 -9] AttributeEnd
AttributeBegin Material "diffuse" "rgb reflectance" [0 0 0] AreaLightSource "diffuse" "rgb L" [{numbers([scene["lamp"]] * 3)}]
Translate {numbers(LAMP[0])} Shape "sphere" "float radius" {LAMP[1]} AttributeEnd
AttributeBegin Material "interface" MediumInterface "m" ""
Shape "trianglemesh" "integer indices" [{" ".join(map(str, faces))}] "point3 P" [{numbers(corners)}] AttributeEnd
""")


def mitsuba(mi, scene):
    low, high = (np.array(corner, float) for corner in scene["box"])
    absorption, scattering = np.array(scene["absorption"]), np.array(scene["scattering"])
    extinction = absorption + scattering
    rgb = lambda value: {"type": "rgb", "value": [float(v) for v in value]}
    most = extinction.max()
    medium = {"type": "homogeneous", "albedo": rgb(scattering / extinction), "sigma_t": rgb(extinction / most), "scale": float(most)}
    place = mi.ScalarTransform4f().translate(((low + high) / 2).tolist()).scale(((high - low) / 2).tolist())
    if scene["grid"] is not None:
        to_world = mi.ScalarTransform4f().translate(low.tolist()).scale((high - low).tolist())
        volume = lambda values: {"type": "gridvolume", "grid": mi.VolumeGrid(values.astype(np.float32)), "to_world": to_world, "raw": True}
        colours = scene["grid"][..., None] * extinction[None, None, None]
        medium = {"type": "heterogeneous", "albedo": rgb(scattering / extinction), "sigma_t": volume(colours)}
    medium["phase"] = {"type": "hg", "g": scene["g"]}
    grey = lambda value: {"type": "diffuse", "reflectance": rgb([value] * 3)}
    sky = {"sky": {"type": "constant", "radiance": rgb([scene["sky"]] * 3)}} if scene["sky"] else {}
    return mi.load_dict({
        "type": "scene",
        **sky,
        "integrator": {"type": "volpath", "max_depth": scene["depth"] + 1},
        "sensor": {
            "type": "perspective", "fov": scene["fov"], "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(EYE, TARGET, [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
            "sampler": {"type": "independent"},
        },
        "floor": {"type": "rectangle", "to_world": mi.ScalarTransform4f().translate([0, -0.01, 0]).rotate([1, 0, 0], -90).scale(9), "bsdf": grey(0.5)},
        "lamp": {"type": "sphere", "center": LAMP[0], "radius": LAMP[1], "bsdf": grey(0), "emitter": {"type": "area", "radiance": rgb([scene["lamp"]] * 3)}},
        "body": {"type": "cube", "to_world": place, "bsdf": {"type": "null"}, "interior": medium},
    })


def read_exr(path):
    import OpenEXR

    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        planes = channels["RGB"].pixels if "RGB" in channels else np.stack([channels[c].pixels for c in "RGB"], axis=-1)
        return np.asarray(planes, np.float64)


class Lookfrom:
    def __init__(self, binary, folder):
        self.binary, self.folder = binary, folder

    def prepare(self, name, scene):
        self.file = self.folder / f"{name}.pbrt"
        pbrt(scene, self.file)
        self.start = min(self.run(1, turn)[0] for turn in range(2))

    def run(self, samples, seed):
        out = self.folder / "ours.exr"
        command = [self.binary, "render", self.file, "-o", out, "--color", "rgb", "--quiet", "--threads", 1, "--samples", samples, "--seed", seed]
        child = subprocess.Popen([str(word) for word in command])
        _, status, used = os.wait4(child.pid, 0)
        assert status == 0
        return used.ru_utime + used.ru_stime, read_exr(out)

    def render(self, samples, seed):
        cpu, image = self.run(samples, seed)
        return cpu - self.start, image


class Mitsuba:
    def __init__(self):
        import drjit
        import mitsuba as mi

        mi.set_variant("llvm_ad_rgb")
        drjit.set_thread_count(1)
        self.mi = mi

    def prepare(self, _, scene):
        self.scene = mitsuba(self.mi, scene)

    def render(self, samples, seed):
        before = os.times()
        image = np.array(self.mi.render(self.scene, spp=samples, seed=seed), np.float64)
        after = os.times()
        return after.user + after.system - before.user - before.system, image


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lookfrom", required=True)
    parser.add_argument("--turns", type=int, default=4)
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--reference", type=int, default=1024)
    options = parser.parse_args()
    print("| scene | means, ours over Mitsuba's | CPU of a sample, ours over Mitsuba's | MSE of a sample | MSE × CPU |\n| --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        programs = [Lookfrom(Path(options.lookfrom).resolve(), Path(folder)), Mitsuba()]
        for name, scene in SCENES.items():
            for program in programs:
                program.prepare(name, scene)
            references = [program.render(options.reference, 999)[1] for program in programs]
            means = references[0].mean(axis=(0, 1)) / references[1].mean(axis=(0, 1))
            truth = (references[0] + references[1]) / 2
            programs[1].render(options.samples, 0)
            found = [[], []]
            for turn in range(1, options.turns + 1):
                for index, program in enumerate(programs):
                    cpu, image = program.render(options.samples, turn)
                    found[index].append((cpu, np.mean((image - truth) ** 2)))
            (our_time, our_error), (their_time, their_error) = (np.mean(rows, axis=0) for rows in found)
            time, error = our_time / their_time, our_error / their_error
            print(f"| {name} | {' '.join(f'{mean:.4f}' for mean in means)} | {time:.2f} | {error:.2f} | {time * error:.2f} |", flush=True)


if __name__ == "__main__":
    main()
