"""Random scenes in lookfrom's own format, for same_bits.py: all its shapes, materials, textures, media, lights and cameras."""

import random
from pathlib import Path

from pbrt_random import write_inputs as write_pictures

PARTS = Path(__file__).resolve().parents[1] / "guide" / "scenes" / "parts"
METALS = ["silver", "aluminium", "gold", "copper", "brass", "MgO", "TiO2"]
GLASSES = ["BK7", "BAF10", "SF11", 1.33, 1.5, 2.1]
TONEMAPS = ["clamp", "reinhard", "filmic", "pbr_neutral", "aces", "agx"]
CUBE = [[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
CUBE_TRIANGLES = [
    [0, 1, 3],
    [0, 3, 2],
    [4, 6, 7],
    [4, 7, 5],
    [0, 4, 5],
    [0, 5, 1],
    [2, 3, 7],
    [2, 7, 6],
    [0, 2, 6],
    [0, 6, 4],
    [1, 5, 7],
    [1, 7, 3],
]


def toml(value):
    """A value as it stands in a file."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str | Path) else repr(value)


class Grammar:
    def __init__(self, seed, folder):
        self.rng, self.folder = random.Random(seed), folder
        self.materials, self.textures, self.media = {}, {}, {}

    def maybe(self, share):
        return self.rng.random() < share

    def number(self, low=0.0, high=1.0):
        return float(f"{self.rng.uniform(low, high):.4g}")

    def numbers(self, low, high, count=3):
        return [self.number(low, high) for _ in range(count)]

    def choice(self, *choices):
        return self.rng.choice(choices)

    def some(self, share, **keys):
        """Some of the keys: each with this probability. Values that depend on chance are functions."""
        return {key: value() if callable(value) else value for key, value in keys.items() if self.maybe(share)}

    def part(self, name):
        return PARTS / name

    # Colours and textures.

    def spectrum(self, high=1.0):
        kind = self.rng.randrange(6)
        if kind == 0:
            return {"curve": [[400, self.number(0, high)], [520, self.number(0, high)], [700, self.number(0, high)]]}
        if kind == 1:
            return self.number(0, high)
        return self.numbers(0, high)

    def color(self, high=1.0, textured=0.3, depth=0):
        if self.maybe(textured):
            return self.texture(0, high, depth)
        if high >= 1 and self.maybe(0.1):
            return self.choice("tomato", "#1b4", "#8a5a2b")
        return self.spectrum(high)

    def value(self, low=0.0, high=1.0, textured=0.2):
        return self.texture(low, high) if self.maybe(textured) else self.number(low, high)

    def mapping(self):
        space = self.choice("uv", "uv", "world", "planar", "cylindrical", "spherical")
        if space == "uv":
            return self.some(0.3, scale=lambda: self.numbers(0.5, 6, 2), offset=lambda: self.numbers(-1, 1, 2))
        turned = self.some(0.3, rotate=lambda: self.numbers(0, 360), translate=lambda: self.numbers(-1, 1))
        return {"space": space, "size": self.number(0.2, 2), **turned}

    def texture(self, low=0.0, high=1.0, depth=0):
        """A texture: in its place, or by a name."""

        def color():
            return self.texture(low, high, depth + 1) if depth < 2 and self.maybe(0.2) else self.numbers(low, high)

        def solid():
            return {"size": self.number(0.1, 1), **self.some(0.3, rotate=lambda: self.numbers(0, 90))}

        kinds = {
            "image": lambda: {
                "file": self.choice("picture.png", "sky.pfm"),
                **self.mapping(),
                **self.some(
                    0.3,
                    encoding=self.choice("linear", "srgb", {"gamma": 1.8}),
                    channel=self.choice("red", "green", "rgb"),
                    wrap=self.choice("mirror", "clamp", "black", ["repeat", "clamp"]),
                    filter=self.choice("nearest", "trilinear", "ewa", "mip_nearest", "mip_bilinear"),
                    invert=True,
                ),
                "multiply": self.number(low, high),
            },
            "checker": lambda: {"even": color(), "odd": color(), **self.mapping(), **self.some(0.3, footprint=0.5)},
            "noise": lambda: {"low": color(), "high": color(), "octaves": self.rng.randint(1, 6), **solid()},
            "marble": lambda: {"vein": color(), "base": color(), **solid()},
            "dots": lambda: {"inside": color(), "outside": color(), **self.mapping()},
            "bilinear": lambda: {"corners": [color() for _ in range(4)], **self.mapping()},
            "pbrt_marble": lambda: {"frequency": self.number(0.5, 3), **solid()},
            "scale": lambda: {"color": color(), "by": self.number()},
            "mix": lambda: {"low": color(), "high": color(), "amount": self.value(textured=0.3 if depth < 2 else 0)},
            "product": lambda: {"a": color(), "b": self.number()},
            "threshold": lambda: {"value": self.texture(0, 1, depth + 1) if depth < 2 else 0.3},
            "direction_mix": lambda: {"low": color(), "high": color(), "direction": self.numbers(-1, 1)},
            "sides": lambda: {"outside": color(), "inside": color()},
            "vertex_color": dict,
        }
        kind = self.rng.choice(list(kinds))
        texture = {"type": kind, **kinds[kind]()}
        # What has a range of its own is brought into the one that is asked for.
        if kind in ("threshold", "sides", "vertex_color", "pbrt_marble"):
            texture = {"type": "mix", "low": low, "high": high, "amount": texture}
        return self.named(self.textures, "texture", texture) if self.maybe(0.4) else texture

    def heights(self):
        kind = self.choice("fbm", "wrinkled", "windy", "picture")
        if kind == "picture":
            return {"type": "image", "file": "picture.png", "multiply": self.number(0.01, 0.1)}
        heights = {"type": kind, "size": self.number(0.05, 0.4), **({} if kind == "windy" else {"octaves": self.rng.randint(1, 6)})}
        return {"type": "scale", "color": heights, "by": self.number(0.02, 0.2)}

    def named(self, table, kind, item):
        name = f"{kind}{len(table)}"
        table[name] = item
        return name

    # Materials.

    def roughness(self):
        def one():
            return self.value(0, 0.7)

        value = [one(), one()] if self.maybe(0.3) else one()
        kind = self.rng.randrange(5)
        return {"alpha": value} if kind == 0 else {"alpha_squared": value} if kind == 1 else value

    def facets(self):
        return self.some(0.3, distribution="beckmann", masking="separable")

    def metal(self):
        return self.choice(
            {"metal": self.choice(*METALS)},
            {"reflectance": self.color()},
            {"eta": self.numbers(0.2, 2), "k": self.numbers(1, 5)},
        )

    def inside(self):
        """A medium in the bodies of a material, for some."""
        return {"medium": self.medium(False)} if self.maybe(0.2) else {}

    def openpbr(self):
        value, color = self.value, self.color
        weights = {
            f"{part}_weight": value for part in ("base", "specular", "transmission", "subsurface", "coat", "fuzz", "thin_film")
        }
        rough = {f"{part}_roughness": value for part in ("base_diffuse", "specular", "coat", "fuzz")}
        thin = self.maybe(0.3)
        through = {"transmission_depth": self.number(0.2, 2), "transmission_scatter": self.numbers(0, 1)} if self.maybe(0.3) else {}
        return {
            **self.some(0.4, **weights, **rough, base_metalness=value, specular_roughness_anisotropy=value),
            **self.some(0.4, base_color=color, specular_color=color, coat_color=color, fuzz_color=color, subsurface_color=color),
            **self.some(0.3, specular_ior=lambda: self.number(1.1, 2.2), coat_ior=lambda: self.number(1, 2), coat_darkening=value),
            **self.some(0.2, thin_film_thickness=lambda: value(0.1, 1), subsurface_radius=lambda: self.number(0.02, 0.4)),
            **self.some(0.2, geometry_opacity=lambda: value(0.3, 1), transmission_dispersion_scale=self.number()),
            **self.some(0.1, geometry_normal={"type": "image", "file": "picture.png", "encoding": "linear"}),
            **({"geometry_thin_walled": True} if thin else through),
        }

    def principled(self):
        value, color = self.value, self.color
        solid = {"solid": True, **self.some(0.5, absorption=lambda: self.numbers(0, 2), dispersion=lambda: self.number(0, 5))}
        return {
            **self.some(0.4, base_color=color, metallic=value, roughness=value, specular=value, specular_color=color),
            **self.some(
                0.25,
                transmission=value,
                diffuse_transmission=value,
                diffuse_transmission_color=color,
                ior=lambda: self.number(1, 2.2),
            ),
            **self.some(0.25, clearcoat=value, clearcoat_roughness=value, sheen_color=color, sheen_roughness=value),
            **self.some(0.25, iridescence=value, iridescence_thickness=lambda: value(100, 800)),
            **self.some(0.2, anisotropy=self.number, anisotropy_rotation=lambda: self.number(0, 180)),
            **(solid if self.maybe(0.25) else {}),
        }

    def disney(self):
        keys = ["roughness", "anisotropic", "metallic", "spec_trans", "spec_tint", "sheen", "sheen_tint", "flatness", "clearcoat"]
        thin = {"thin": True, "diff_trans": self.value(0, 2)} if self.maybe(0.25) else {}
        of_bodies = ("metallic", "clearcoat")
        return {
            **self.some(0.4, base_color=self.color, **{key: self.value for key in keys if not (thin and key in of_bodies)}),
            **thin,
        }

    def whitted(self):
        glass = {"diffuse": 0.05, "mirror": 1, "transmission": 1, "fresnel": True, "ior": self.number(1.1, 2)}
        mirror = {"diffuse": self.color(0.3), "mirror": self.color(0.8)}
        plain = {
            "diffuse": self.color(),
            **self.some(0.5, specular=self.color, shininess=lambda: self.number(1, 200), ambient=self.color),
        }
        return self.choice(plain, plain, mirror, {**glass, **self.some(0.4, absorption=lambda: self.numbers(0, 1))})

    def material(self, inner=True):
        """The name of a new material."""
        value, color, number = self.value, self.color, self.number
        coat = {
            **self.some(0.4, roughness=self.roughness, ior=lambda: number(1.2, 2), thickness=lambda: value(0, 0.1)),
            **self.some(0.2, coat_albedo=lambda: color(0.9), g=lambda: number(-0.6, 0.6), coat_samples=2, coat_estimate="pbrt"),
        }
        tints = self.some(0.2, specular_reflectance=color, specular_transmittance=color)
        kinds = {
            "whitted": self.whitted,
            "diffuse": lambda: {"reflectance": color()},
            "diffuse_transmission": lambda: {"reflectance": color(0.5), "transmittance": color(0.5), **self.some(0.2, scale=0.8)},
            "conductor": lambda: {**self.metal(), "roughness": self.roughness(), **self.facets(), "energy": "single_scattering"},
            "dielectric": lambda: {
                "ior": self.choice(*GLASSES),
                **self.some(0.4, roughness=self.roughness, energy="single_scattering"),
                **self.facets(),
                **tints,
                **self.inside(),
            },
            "thin_dielectric": lambda: {"ior": number(1.1, 2), **tints},
            "coated_diffuse": lambda: {"reflectance": color(), **coat},
            "coated_conductor": lambda: {**self.metal(), "base_roughness": self.roughness(), **coat},
            "plastic": lambda: {
                "reflectance": color(),
                **self.some(
                    0.3, nonlinear=False, ior=lambda: number(1.2, 2), roughness=lambda: number(0.1, 0.8), specular_reflectance=color
                ),
                **self.facets(),
            },
            "subsurface": lambda: {
                **self.choice(
                    {"preset": self.choice("Skin1", "Marble", "Ketchup"), "scale": number(5, 50)},
                    {"reflectance": color(0.9), "mean_free_path": color(0.3)},
                    {"absorption": color(0.5), "scattering": color(5)},
                ),
                **self.some(0.3, roughness=self.roughness, g=lambda: number(-0.5, 0.8), ior=lambda: number(1.1, 1.6)),
            },
            "hair": lambda: {
                **self.choice(
                    {"eumelanin": value(0, 3), "pheomelanin": number(0, 1)}, {"melanin": number()}, {"reflectance": color(0.9)}
                ),
                **self.some(
                    0.3, roughness=lambda: value(0.1, 1), radial_roughness=lambda: value(0.1, 1), offset=lambda: number(-5, 5)
                ),
            },
            "measured": lambda: {"file": self.part(self.choice("pearl", "reflector", "velvet") + ".binary")},
            "principled": self.principled,
            "openpbr": self.openpbr,
            "disney": self.disney,
            "unlit": lambda: {"color": color()},
        }
        kind = self.rng.choice([*kinds, "mix", "principled", "openpbr"] if inner else list(kinds))
        if kind == "mix":
            amount = {"type": "sides"} if self.maybe(0.2) else value(textured=0.6)
            material = {"type": "mix", "materials": [self.material(False), self.material(False)], "amount": amount}
            return self.named(self.materials, "material", material)
        material = {"type": kind, **kinds[kind]()}
        bent = "geometry_normal" in material
        if kind != "unlit" and not bent and self.maybe(0.2):
            material["bump"] = self.heights()
        elif kind != "unlit" and not bent and self.maybe(0.1):
            material["normal_map"] = "picture.png"
        if self.maybe(0.1) and kind not in ("unlit", "subsurface"):
            material.update(emission=self.color(2, 0.2), **self.some(0.3, two_sided=True))
        return self.named(self.materials, "material", material)

    # Media and shapes.

    def medium(self, is_fog):
        formula = {"formula": self.choice("1 - x*x - y*y - z*z", "max(0, 0.5 + x) * 2", "abs(sin(200 * y)) * (x > -0.3 ? 1 : 0)")}
        places = {**formula, "cells": self.rng.randint(4, 24)}
        density = self.choice(
            None,
            None,
            places,
            {"type": "noise", "size": 0.4},
            {"cloud": self.number(0.5, 2)},
        )
        thin = 0.1 if is_fog else 2
        medium = self.choice(
            {"absorption": self.spectrum(thin), "scattering": self.spectrum(thin)},
            {"extinction": self.spectrum(thin), "albedo": self.spectrum()},
            {"scattering": self.number(0, thin)},
        )
        phase = self.choice(
            {}, {"g": self.number(-0.8, 0.9)}, {"droplets": self.number(0.5, 20)}, {"draine": {"g": 0.2, "share": 0.5}}
        )
        medium.update(phase)
        if density is not None and not is_fog:
            medium["density"] = density
        if self.maybe(0.2):
            medium["emission"] = self.numbers(0, 1)
        elif self.maybe(0.1) and not is_fog:
            medium["temperature"] = {**formula, "cells": 8, "factor": 2000}
        return self.named(self.media, "medium", medium)

    def shape(self):
        """A shape about the origin, of the size of 1."""
        number, numbers = self.number, self.numbers
        cut = self.some(0.3, z_min=lambda: number(-0.4, -0.1), z_max=lambda: number(0.1, 0.4), phi_max=lambda: number(90, 360))
        kinds = {
            "sphere": lambda: {"radius": number(0.4, 0.8), **cut},
            "triangle": lambda: {"vertices": [[-0.8, -0.5, 0], [0.8, -0.5, number(-0.5, 0.5)], [0, 0.8, 0]]},
            "quad": lambda: {"corner": [-0.6, -0.6, 0], "edge_u": [1.2, 0, number(-0.3, 0.3)], "edge_v": [0, 1.2, 0]},
            "disk": lambda: {
                "center": [0, 0, 0],
                "normal": self.numbers(-1, 1),
                "radius": 0.8,
                **self.some(0.3, inner_radius=0.3, phi_max=lambda: number(90, 360)),
            },
            "cylinder": lambda: {
                "from": [0, -0.6, 0],
                "to": numbers(-0.2, 0.6),
                "radius": number(0.02, 0.5),
                **self.some(0.3, phi_max=200),
            },
            "cone": lambda: {
                "from": [0, -0.6, 0],
                "to": [0, 0.6, 0],
                "radius": 0.6,
                **self.some(0.3, tip_radius=0.2, closed=False),
            },
            "torus": lambda: {"radius": 0.6, "tube": number(0.05, 0.3), "segments": 24},
            "lathe": lambda: {
                "profile": [[0, -0.5], [0.5, -0.4], [0.6, 0.1], [0.2, 0.5]],
                "segments": 24,
                **self.some(0.3, smooth=False),
            },
            "box": lambda: {"min": [-0.5, -0.4, -0.5], "max": [0.5, 0.5, 0.4]},
            "text": lambda: {"text": "lo", "font": self.part("letters.ttf"), "align": "center", "size": 1.2},
            "heightfield": lambda: {"file": "picture.png", "size": [1.5, 1.5], "height": 0.5},
            "solid": lambda: {
                "operation": self.choice("union", "intersection", "difference"),
                "segments": 16,
                "of": [{"type": "sphere", "radius": 0.6}, {"type": "box", "min": [-0.5, -0.3, -0.9], "max": [0.3, 0.7, 0.9]}],
            },
            "mesh": lambda: {
                "positions": CUBE,
                "triangles": CUBE_TRIANGLES,
                **self.some(
                    0.4,
                    normals=[[2 * x for x in corner] for corner in CUBE],
                    uvs=[[x + y, z] for x, y, z in CUBE],
                    colors=[[x + 0.5, y + 0.5, z + 0.5] for x, y, z in CUBE],
                ),
                **self.some(0.15, displacement=lambda: number(0, 0.2)),
                **self.some(0.15, subdivision=2),
            },
            "patch": lambda: {
                "corners": [[-0.7, number(-0.5, 0.5), 0.7], [0.7, 0.2, 0.7], [-0.7, 0.1, -0.7], [0.7, number(-0.5, 0.5), -0.7]]
            },
            "curve": lambda: {
                "points": [[-0.9, 0, 0], [-0.3, number(0, 0.9), 0], [0.3, number(-0.9, 0), 0.4], [0.9, 0, 0]],
                "width": numbers(0.02, 0.3, 2),
                **self.choice({}, {"profile": "cylinder"}, {"profile": "ribbon", "normals": [[0, 0, 1], [0, 1, 0.1]]}),
            },
            "sphereflake": lambda: {"radius": 0.4, "depth": self.rng.randint(0, 2)},
            "spheres": lambda: {"centers": [numbers(-0.7, 0.7) for _ in range(9)], "radii": numbers(0.05, 0.3, 9)},
        }
        kind = self.rng.choice(list(kinds))
        return {"type": kind, **kinds[kind]()}

    def placing(self, moves=0.15):
        rotate = self.choice(self.numbers(0, 360), {"axis": self.numbers(0.1, 1), "angle": self.number(0, 360)})
        place = {"rotate": rotate, "translate": [self.number(-2, 2), self.number(-0.3, 1.5), self.number(-1.5, 1.5)]}
        if self.maybe(0.3):
            place["scale"] = self.choice(self.number(0.5, 1.3), self.numbers(0.5, 1.3), [-1, 1, 1])
        if self.maybe(moves):
            x, y, z = place["translate"]
            place["translate"] = [f"= {x} + 8 * t", y, f"= {z} - 3 * t"]
            if isinstance(rotate, list) and self.maybe(0.5):
                place["rotate"] = [f"= {rotate[0]} + 900 * t", *rotate[1:]]
        return place

    CLOSED = ("box", "lathe", "torus")

    def placed(self):
        shape = {**self.shape(), **self.placing()}
        if self.maybe(0.12) and (
            shape["type"] in self.CLOSED or shape["type"] == "sphere" and not {"z_min", "z_max", "phi_max"} & set(shape)
        ):
            return {**shape, "medium": self.medium(False), **self.some(0.3, material=self.material)}
        return {
            **shape,
            "material": self.material(),
            **self.some(0.12, alpha=lambda: self.value(0.3, 1, 0.5), reverse_orientation=True, single_sided=True),
            **({"emission": self.color(3, 0.3), **self.some(0.3, two_sided=True)} if self.maybe(0.08) else {}),
        }

    # Lights and cameras.

    def light(self):
        number, numbers = self.number, self.numbers
        color = self.choice(numbers(0.2, 1), {"kelvin": number(2500, 9000)}, {"illuminant": "D65"}, "white")
        at = [number(-3, 3), number(2.5, 4), number(-1, 3)]
        brightness = self.choice({"intensity": numbers(2, 12)}, {"intensity": color, "power": number(40, 300)})
        radiance = self.choice({"radiance": numbers(2, 12)}, {"radiance": color, "power": number(10, 60)})
        sky = {"type": "environment", **self.some(0.2, illuminance=lambda: number(1, 3))}
        kinds = [
            lambda: {"type": "ambient", "color": numbers(0, 0.3)},
            lambda: {"type": "point", "position": at, **brightness, **self.some(0.2, falloff=self.choice("none", "linear"))},
            lambda: {"type": "distant", "direction": [number(-1, 1), -1, number(-1, 1)], "intensity": numbers(0.3, 2)},
            lambda: {
                "type": "spot",
                "position": at,
                "target": [0, 0, 0],
                **brightness,
                "cone_angle": number(15, 50),
                **self.some(0.3, edge="linear"),
            },
            lambda: {
                "type": "projection",
                "position": at,
                "target": [0, 0, 0],
                "image": "picture.png",
                "intensity": number(5, 30),
                **self.some(0.3, filter="bilinear"),
            },
            lambda: {
                "type": "goniometric",
                "position": at,
                "image": self.choice("sphere.pfm", self.part("downlight.ies")),
                **brightness,
            },
            lambda: {
                "type": "rectangle",
                "center": at,
                "target": [0, 0, 0],
                "width": number(0.3, 2),
                "height": 0.6,
                **radiance,
                **self.some(0.2, two_sided=True),
            },
            lambda: {"type": "disk", "center": at, "target": [0, 0, 0], "radius": number(0.2, 1), **radiance},
            lambda: {"type": "sphere", "center": at, "radius": number(0.1, 0.6), **radiance},
            lambda: {**sky, "color": color},
            lambda: {**sky, "zenith": numbers(0, 1), "horizon": numbers(0, 1)},
            lambda: {**sky, "image": "sky.pfm", **self.some(0.3, rotate=lambda: number(0, 360), layout="octahedral")},
            lambda: {
                "type": "sun_and_sky",
                "elevation": number(5, 80),
                "azimuth": number(0, 360),
                "turbidity": number(1.5, 8),
                "illuminance": number(1, 4),
            },
        ]
        return self.rng.choice(kinds)()

    def camera(self):
        camera = {"lookfrom": [self.number(-2, 2), self.number(0.3, 2.5), 6], "lookat": [0, 0.4, 0]}
        kinds = [
            {"fov": self.number(30, 55)},
            {"fov": self.number(30, 55)},
            {"fov": 40, "aperture": self.number(0.02, 0.2), **self.some(0.5, focus=[0, 0, 0.5])},
            {"projection": "orthographic", "height": self.number(3, 5)},
            {"projection": self.choice("equirectangular", "equirectangular_pbrt", "octahedral")},
            {
                "lens": self.part(self.choice("double-gauss.dat", "fisheye.dat")),
                **self.some(0.5, aperture=0.01, aperture_shape=self.choice("star", "pentagon")),
            },
        ]
        camera.update(self.rng.choice(kinds))
        if self.maybe(0.15):
            camera["medium"] = self.medium(True)
        if (
            self.maybe(0.1)
            and "lens" not in camera
            and "equi" not in camera.get("projection", "")
            and camera.get("projection") != "octahedral"
        ):
            camera["clip"] = [self.number(0.5, 5), self.number(7, 12)]
        return {**camera, **self.some(0.5, shutter=self.number(0.2, 1))}

    def scene(self):
        shapes = [{"type": "plane", "point": [0, -0.6, 0], "size": 30, "material": self.material()}]
        shapes += [self.placed() for _ in range(self.rng.randint(2, 7))]
        file = {"camera": self.camera(), "shape": shapes, "light": [self.light() for _ in range(self.rng.randint(1, 4))]}
        if self.maybe(0.3):
            file["objects"] = {"thing": {"shape": [{**self.shape(), "material": self.material()} for _ in range(2)]}}
            file["instance"] = [
                {"object": "thing", **self.placing(), **self.some(0.2, material=self.material)}
                for _ in range(self.rng.randint(1, 4))
            ]
        file["image"] = {
            "width": 48,
            "height": 36,
            "filter": self.choice("box", "gaussian", "mitchell", "blackman_harris", "triangle", {"type": "sinc", "radius": [4, 2]}),
            **self.some(
                0.15,
                tonemap=self.choice(*TONEMAPS),
                exposure=lambda: self.number(-2, 2),
                background=lambda: self.numbers(0, 1),
                max_component=5,
            ),
            **self.some(0.1, white_balance=lambda: self.number(3000, 9000), sensor="canon_eos_5d", imaging_ratio=0.7),
        }
        file["render"] = {
            "integrator": "path",
            "depth": self.choice(1, 4, 12),
            **self.some(
                0.15,
                regularize=True,
                hide_lights=True,
                thin_passages_count=False,
                portals="auto",
                vertex_normals="as_given",
                endless_media=True,
            ),
        }
        tables = {"materials": self.materials, "textures": self.textures, "media": self.media}
        lines = [f"{key} = {toml(value)}" for key, value in file.items()]
        for name, table in tables.items():
            lines += [f"[{name}]", *(f"{key} = {toml(value)}" for key, value in table.items())]
        return "\n".join(lines) + "\n"


def write_inputs(folder):
    """The pictures that the scenes name."""
    write_pictures(folder)
