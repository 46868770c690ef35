#!/usr/bin/env python3
"""Random scenes by lookfrom and by Mitsuba 3, compared block by block.

Needs: pip packages mitsuba and numpy; a release build of lookfrom.

    mitsuba_random.py --lookfrom target/release/lookfrom [--seeds 0 40] [--samples 64] [--bsdf KIND]
                      [--color spectral] [--folder DIR]

A scene has a floor, sometimes a wall, two to four shapes with BSDFs by a grammar (textures, masks, maps, blends, media inside),
and one to three lights. --bsdf puts one BSDF of a kind on one shape instead. Both programs render eight pictures of other seeds.
A block of pixels differs when its means are more than 1.5 % and six standard errors apart; a scene is told by `<<<` when two
blocks differ, or the mean of the picture.

Left out, because Mitsuba 3.9 is known to be different (docs/guide/mitsuba.md): masks with `path` in place of `volpath`, blends of
smooth and rough BSDFs, maps over rough BSDFs with a grain, a grain on disks, emitting meshes with smooth normals, media outside
of bodies, and filters wider than a pixel.
"""

import argparse
import random
import subprocess
import sys
from pathlib import Path

import mitsuba
import numpy as np
from blocks import HEIGHT, WIDTH, block_means, compare

PICTURES = 8
OPEN = ["diffuse", "conductor", "roughconductor", "plastic", "roughplastic", "principled", "thindielectric", "principledthin"]
CLOSED = [kind for kind in OPEN if "thin" not in kind] + ["dielectric", "roughdielectric", "glass"]
OUTER = ["mask", "bumpmap", "normalmap", "blendbsdf", "twosided"]
ROUGH = ["diffuse", "roughconductor", "roughplastic", "principled"]


def tag(element, *inside, **attributes):
    words = "".join(f' {key}="{value}"' for key, value in attributes.items())
    return f"<{element}{words}>{''.join(inside)}</{element}>"


def number(name, value):
    return tag("float", name=name, value=f"{value:.4f}")


def rgb(name, values):
    return tag("rgb", name=name, value=", ".join(f"{value:.3f}" for value in values))


def transform(*steps):
    return tag("transform", *steps, name="to_world")


def point(name, values):
    return tag("point", name=name, **dict(zip("xyz", values)))


def lookat(origin, target, up="0, 1, 0"):
    return tag("lookat", origin=", ".join(map(str, origin)), target=target, up=up)


class Grammar:
    def __init__(self, seed, folder):
        self.random, self.folder = random.Random(seed), folder

    def between(self, low, high):
        return self.random.uniform(low, high)

    def maybe(self, probability, make):
        return make() if self.random.random() < probability else ""

    def color(self, name, low=0.05, high=0.9):
        return rgb(name, [self.between(low, high) for _ in range(3)])

    def picture(self, name, file, *inside, raw=False):
        inside = [tag("string", name="filename", value=self.folder / file), *inside]
        return tag("texture", *inside, tag("boolean", name="raw", value=str(raw).lower()), type="bitmap", name=name)

    def texture(self, name, low=0.05, high=0.9):
        kind = self.random.choices(["color", "checks", "picture"], [4, 1, 1])[0]
        if kind == "color":
            return self.color(name, low, high)
        scale = tag("scale", x=self.random.choice([1, 2, 5]), y=self.random.choice([2, 3, 7]))
        to_uv = tag("transform", scale, name="to_uv")
        if kind == "checks":
            colors = self.color("color0", low, high) + self.color("color1", low, high)
            return tag("texture", colors, to_uv, type="checkerboard", name=name)
        filter_type = tag("string", name="filter_type", value=self.random.choice(["bilinear", "nearest"]))
        wrap = tag("string", name="wrap_mode", value=self.random.choice(["repeat", "mirror", "clamp"]))
        return self.picture(name, "picture.png", filter_type, wrap, to_uv)

    def scalar(self, name, low, high):
        if self.random.random() < 0.7:
            return number(name, self.between(low, high))
        values = number("color0", self.between(low, high)) + number("color1", self.between(low, high))
        return tag("texture", values, type="checkerboard", name=name)

    def alpha(self, has_grain=True):
        distribution = tag("string", name="distribution", value=self.random.choice(["ggx", "beckmann"]))
        names = ["alpha_u", "alpha_v"] if has_grain and self.random.random() < 0.3 else ["alpha"]
        return distribution + "".join(number(name, self.between(0.05, 0.5)) for name in names)

    def metal(self):
        factor = self.maybe(0.3, lambda: self.texture("specular_reflectance", 0.4, 1.0))
        return tag("string", name="material", value=self.random.choice(["Ag", "Al", "Au", "Cu"])) + factor

    def tint(self):
        names = ["specular_reflectance", "specular_transmittance"]
        return "".join(self.maybe(0.3, lambda name=name: self.texture(name, 0.4, 1.0)) for name in names)

    def index(self, name="int_ior"):
        return number(name, self.between(1.2, 1.9))

    def principled(self, has_grain=True):
        shares = ["metallic", "spec_tint", "sheen", "sheen_tint", "clearcoat", "clearcoat_gloss", "flatness"]
        shares += ["anisotropic"] if has_grain else []
        chosen = "".join(self.scalar(name, 0.0, 1.0) for name in shares if self.random.random() < 0.4)
        return self.texture("base_color") + self.scalar("roughness", 0.1, 0.9) + chosen

    def nonlinear(self):
        return tag("boolean", name="nonlinear", value=self.random.choice(["true", "false"]))

    def inside(self, kind, is_closed, has_grain):
        """What the BSDF of a kind has in it."""
        if kind == "diffuse":
            return self.texture("reflectance")
        if kind == "conductor":
            return self.metal()
        if kind == "roughconductor":
            return self.metal() + self.alpha(has_grain)
        if kind == "plastic":
            return self.texture("diffuse_reflectance") + self.index() + self.nonlinear()
        if kind == "roughplastic":
            return self.texture("diffuse_reflectance") + self.alpha(has_grain=False) + self.nonlinear()
        if kind == "principled":
            return self.principled(has_grain)
        if kind == "principledthin":
            shares = self.scalar("spec_trans", 0.0, 1.0) + self.scalar("diff_trans", 0.0, 2.0)
            return self.texture("base_color") + self.scalar("roughness", 0.1, 0.9) + shares + self.index("eta")
        if kind == "glass":
            shares = number("roughness", self.between(0.1, 0.6)) + number("spec_trans", self.between(0.2, 1.0))
            return self.texture("base_color", 0.5, 1.0) + shares + self.index("eta")
        if kind in ("dielectric", "thindielectric"):
            return self.index() + self.tint()
        if kind == "roughdielectric":
            return self.alpha(has_grain) + self.index() + self.tint()
        simple = [each for each in OPEN if "thin" not in each]
        if kind == "mask":
            return self.scalar("opacity", 0.1, 0.9) + self.bsdf(self.random.choice(CLOSED if is_closed else OPEN))
        if kind == "bumpmap":
            height = self.picture("height", "heights.png", raw=True) + number("scale", self.between(0.01, 0.2))
            return height + self.bsdf(self.random.choice(simple), has_grain=False)
        if kind == "normalmap":
            return self.picture("normalmap", "normals.png", raw=True) + self.bsdf(self.random.choice(simple), has_grain=False)
        if kind == "blendbsdf":
            return self.scalar("weight", 0.0, 1.0) + self.bsdf(self.random.choice(ROUGH)) + self.bsdf(self.random.choice(ROUGH))
        return self.bsdf(self.random.choice(simple)) + self.maybe(0.5, lambda: self.bsdf(self.random.choice(simple)))

    def bsdf(self, kind, is_closed=False, has_grain=True):
        return tag("bsdf", self.inside(kind, is_closed, has_grain), type="principled" if kind == "glass" else kind)

    def any_bsdf(self, is_closed=False):
        return self.bsdf(self.random.choice((CLOSED if is_closed else OPEN) * 2 + OUTER), is_closed)

    def medium(self):
        """A medium in a body, with its boundary."""
        phases = ["", tag("phase", number("g", self.between(-0.7, 0.8)), type="hg"), tag("phase", type="rayleigh")]
        phase = self.random.choice(phases)
        if self.random.random() < 0.4:
            # A grid all over the scene.
            place = transform(tag("scale", x=6, y=4, z=6), tag("translate", x=-3, y=-0.5, z=-3))
            density = tag(
                "volume", tag("string", name="filename", value=self.folder / "cloud.vol"), place, type="gridvolume", name="sigma_t"
            )
            albedo = tag("volume", self.color("value", 0.3, 0.95), type="constvolume", name="albedo")
            scale = number("scale", self.between(1.0, 6.0))
            medium = tag("medium", density, albedo, scale, phase, type="heterogeneous", name="interior")
        else:
            coefficients = self.color("albedo", 0.3, 0.95) + number("sigma_t", self.between(0.3, 4.0))
            medium = tag("medium", coefficients, phase, type="homogeneous", name="interior")
        return medium + self.random.choice([tag("bsdf", type="null"), self.bsdf("dielectric"), self.bsdf("roughdielectric")])

    def rotation(self):
        axis = np.array([self.between(-1, 1), 1.0, self.between(-1, 1)])
        axis = dict(zip("xyz", (axis / np.linalg.norm(axis)).round(9)))
        return tag("rotate", **axis, angle=f"{self.between(0, 360):.1f}")

    def shape(self, place, surface=None):
        kind = self.random.choice(["sphere", "sphere", "cube", "cylinder", "rectangle", "disk", "ply", "instance"])
        size = self.between(0.4, 0.75)
        is_closed = kind in ("sphere", "cube", "ply")
        where = tag("translate", x=place[0], y=f"{1.2 * size:.3f}", z=place[1])
        if kind == "sphere":
            inside = point("center", [place[0], size + 0.05, place[1]]) + number("radius", size)
        elif kind == "cylinder":
            inside = transform(tag("scale", value=f"{size:.3f}"), self.rotation(), where)
        else:
            sizes = {axis: f"{size * self.between(0.6, 1.3):.3f}" for axis in "xyz"}
            inside = transform(tag("scale", **sizes), self.rotation(), where)
        if kind == "instance":
            return tag("shape", inside, tag("ref", id="group"), type=kind) if surface is None else self.shape(place, surface)
        if kind == "ply":
            inside += tag("string", name="filename", value=self.folder / "ball.ply")
        if surface is not None:
            return tag("shape", inside, self.bsdf(surface, is_closed), type=kind)
        if is_closed and self.random.random() < 0.2:
            return tag("shape", inside, self.medium(), type=kind)
        inside += self.bsdf(self.random.choice(OPEN), has_grain=False) if kind == "disk" else self.any_bsdf(is_closed)
        if kind != "ply":
            inside += self.maybe(0.15, lambda: tag("emitter", self.color("radiance", 0.5, 4.0), type="area"))
        inside += self.maybe(0.1, lambda: tag("boolean", name="flip_normals", value="true"))
        return tag("shape", inside, type=kind)

    def light(self, kind):
        place = [round(self.between(-3, 3), 2), 4.2, round(self.between(-2, 3), 2)]
        if kind == "rectangle":
            to_world = transform(tag("scale", value=f"{self.between(0.3, 1.2):.2f}"), lookat(place, "0, 0, 0", "1, 0, 0"))
            is_picture = self.random.random() < 0.2
            radiance = self.picture("radiance", "picture.png") if is_picture else self.color("radiance", 4.0, 14.0)
            return tag("shape", to_world, tag("emitter", radiance, type="area"), type="rectangle")
        if kind == "ball":
            ball = point("center", place) + number("radius", self.between(0.1, 0.5))
            return tag("shape", ball, tag("emitter", self.color("radiance", 6.0, 20.0), type="area"), type="sphere")
        if kind == "point":
            return tag("emitter", point("position", place), self.color("intensity", 4.0, 14.0), type="point")
        if kind == "spot":
            to_world = transform(lookat(place, "0, 0.5, 0.1"))
            angle = number("cutoff_angle", self.between(15, 40))
            return tag("emitter", to_world, self.color("intensity", 15.0, 40.0), angle, type="spot")
        if kind == "directional":
            direction = tag("vector", name="direction", x=place[0] / 3, y=-1, z=place[2] / -3)
            return tag("emitter", direction, self.color("irradiance", 0.5, 2.0), type="directional")
        if kind == "constant":
            return tag("emitter", self.color("radiance", 0.1, 0.8), type="constant")
        turns = transform(
            tag("rotate", y=1, angle=f"{self.between(0, 360):.0f}"), tag("rotate", x=1, angle=self.random.choice([0, 25]))
        )
        file = tag("string", name="filename", value=self.folder / "sky.exr")
        return tag("emitter", file, number("scale", self.between(0.3, 1.5)), turns, type="envmap")

    def scene(self, surface=None):
        depth = tag("integer", name="max_depth", value=self.random.choice([3, 5, 8, 12]))
        depth += tag("integer", name="rr_depth", value=1000)
        size = tag("integer", name="width", value=WIDTH) + tag("integer", name="height", value=HEIGHT)
        film = tag("film", size, tag("rfilter", type="box"), type="hdrfilm")
        sampler = tag("sampler", tag("integer", name="sample_count", value="$spp"), type="independent")
        kind = self.random.choice(["perspective", "perspective", "thinlens", "orthographic"])
        view = number("fov", self.between(35, 55)) if kind != "orthographic" else ""
        if kind == "thinlens":
            view += number("aperture_radius", 0.1) + number("focus_distance", 6.0)
        eye = [round(self.between(-3, 3), 2), round(self.between(1, 4), 2), 6]
        window = tag("scale", x=3, y=3) if kind == "orthographic" else ""
        camera = tag("sensor", view, transform(window, lookat(eye, "0, 0.8, 0")), sampler, film, type=kind)
        down = transform(tag("scale", value=5), tag("rotate", x=1, angle=-90))
        behind = transform(tag("scale", value=5), tag("translate", y=2, z=-4))
        parts = [tag("integrator", depth, type="volpath"), camera]
        skies = [self.random.choice(["constant", "envmap"])]
        kinds = self.random.sample(["rectangle", "ball", "point", "spot", "directional"] + skies, self.random.randint(1, 3))
        if surface is not None:
            parts += [tag("shape", down, tag("bsdf", type="diffuse"), type="rectangle"), self.shape((0, 0.5), surface)]
        else:
            parts.append(tag("shape", down, self.any_bsdf(), type="rectangle"))
            parts.append(self.maybe(0.5, lambda: tag("shape", behind, self.any_bsdf(), type="rectangle")))
            group = [
                tag("shape", self.bsdf("diffuse"), type="cube"),
                tag("shape", point("center", [0, 1, 0]), self.any_bsdf(True), type="sphere"),
            ]
            parts.append(tag("shape", *group, type="shapegroup", id="group"))
            places = self.random.sample([(-1.8, 0), (0, -1), (1.8, 0.3), (-0.8, 1.8), (1, 1.9)], self.random.randint(2, 4))
            parts += [self.shape(place) for place in places]
        parts.insert(0, tag("default", name="spp", value=9))
        return tag("scene", "\n", "\n".join(parts + [self.light(kind) for kind in kinds]), version="3.0.0")


def write_inputs(folder):
    """The pictures, and a ball of triangles, that scenes name."""
    noise = np.random.RandomState(3).rand(8, 8, 3)
    y, x = np.mgrid[0:64, 0:64] * (2 * np.pi / 64)
    heights = np.repeat((0.5 + 0.25 * np.sin(2 * x) + 0.25 * np.cos(3 * y))[..., None], 3, axis=2)
    normals = np.stack([0.35 * np.sin(2 * x), 0.35 * np.cos(2 * y), np.ones_like(x)], axis=2)
    normals = 0.5 + 0.5 * normals / np.linalg.norm(normals, axis=2, keepdims=True)
    for name, texels in {"picture": noise, "heights": heights, "normals": normals}.items():
        mitsuba.Bitmap((texels.clip(0, 1) * 255).round().astype(np.uint8)).write(str(folder / f"{name}.png"))
    sky = np.full((16, 32, 3), 0.2, np.float32)
    sky[:8], sky[3:5, 8:11], sky[10:] = [0.4, 0.6, 1.0], [20, 18, 14], [0.3, 0.2, 0.1]
    mitsuba.Bitmap(sky).write(str(folder / "sky.exr"))
    mitsuba.VolumeGrid(np.random.RandomState(5).rand(6, 5, 7).astype(np.float32)).write(str(folder / "cloud.vol"))
    rows, columns = 12, 24
    polar, around = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, columns + 1), indexing="ij")
    vertices = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1).reshape(-1, 3)
    uv = np.stack([around / (2 * np.pi), polar / np.pi], axis=-1).reshape(-1, 2)
    corners = [(i * (columns + 1) + k, (i + 1) * (columns + 1) + k) for i in range(rows) for k in range(columns)]
    faces = [face for a, b in corners for face in ((a, b, b + 1), (a, b + 1, a + 1))]
    faces = [face for face in faces if len({tuple(vertices[k].round(6)) for k in face}) == 3]
    mesh = mitsuba.Mesh("ball", len(vertices), len(faces), has_vertex_normals=True, has_vertex_texcoords=True)
    arrays = mitsuba.traverse(mesh)
    arrays["vertex_positions"] = arrays["vertex_normals"] = vertices.ravel()
    arrays["vertex_texcoords"], arrays["faces"] = uv.ravel(), np.ravel(faces)
    arrays.update()
    mesh.write_ply(str(folder / "ball.ply"))


def by_mitsuba(path, samples):
    scene = mitsuba.load_file(str(path), spp=str(samples))
    return [np.array(mitsuba.render(scene, spp=samples, seed=seed))[..., :3] for seed in range(PICTURES)]


def by_lookfrom(lookfrom, path, samples, color):
    pictures = []
    for seed in range(PICTURES):
        command = [lookfrom, "render", path, "-D", f"spp={samples}", "--seed", seed, "--color", color, "--denoise", "off"]
        command += ["-o", path.with_suffix(".exr")]
        ran = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
        if ran.returncode:
            sys.exit(f"{path}: {ran.stderr}")
        pictures.append(np.array(mitsuba.Bitmap(str(path.with_suffix(".exr"))))[..., :3])
    return pictures, [line for line in ran.stderr.splitlines() if line.startswith("warning")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lookfrom", required=True, type=Path, help="the binary")
    parser.add_argument("--seeds", type=int, nargs=2, default=[0, 40], metavar=("FIRST", "END"))
    parser.add_argument("--samples", type=int, default=64, help="of each pixel")
    parser.add_argument("--bsdf", choices=sorted({*OPEN, *CLOSED, *OUTER}), help="one shape with a BSDF of this kind")
    parser.add_argument("--color", choices=["rgb", "spectral"], default="rgb")
    parser.add_argument("--folder", type=Path, default=Path("/tmp/lookfrom-random"))
    args = parser.parse_args()
    mitsuba.set_variant(f"scalar_{args.color}")
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    folder = args.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    write_inputs(folder)
    told = count = 0
    for seed in range(*args.seeds):
        path = folder / f"{seed}.xml"
        path.write_text(Grammar(seed, folder).scene(args.bsdf))
        theirs = block_means(by_mitsuba(path, args.samples))
        if not np.isfinite(theirs).all():
            print(f"{seed}: Mitsuba's picture has values that are no numbers")
            continue
        pictures, warnings = by_lookfrom(args.lookfrom, path, args.samples, args.color)
        ours = block_means(pictures)
        found = compare(theirs, ours, 0.015)
        is_told = found.differ > 1 or (abs(found.z) > 6 and abs(found.change) > 0.005)
        count, told = count + 1, told + is_told
        print(
            f"{seed}: {found.change:+.2%}, {found.z:+.1f} standard errors, {found.differ} blocks differ",
            *warnings,
            "<<<" if is_told else "",
            flush=True,
        )
    print(f"{told} of {count} scenes differ")


if __name__ == "__main__":
    main()
