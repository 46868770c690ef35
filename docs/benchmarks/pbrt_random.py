"""Random scenes in pbrt-v4's language, for same_bits.py: shapes, materials, textures, media, lights, lenses and motion."""

import math
import random
import struct
import zlib

RGB_FILTERS = ["box", "gaussian", "mitchell", "sinc", "triangle"]
METALS = ["metal-Cu-eta", "metal-Au-eta", "metal-Ag-eta"]


class Grammar:
    def __init__(self, seed):
        self.rng, self.lines, self.count = random.Random(seed), [], 0

    def number(self, low, high):
        return f"{self.rng.uniform(low, high):.4g}"

    def numbers(self, low, high, count=3):
        return " ".join(self.number(low, high) for _ in range(count))

    def maybe(self, share):
        return self.rng.random() < share

    def write(self, *words):
        self.lines.append(" ".join(words))

    def float_of(self, name, low, high, textured=0.2):
        """A float parameter, sometimes with a texture."""
        if self.maybe(textured):
            return f'"texture {name}" "{self.texture("float", low, high)}"'
        return f'"float {name}" {self.number(low, high)}'

    def color_of(self, name, high=1.0, textured=0.3):
        """A spectrum parameter: a colour, wavelengths and values, or a texture."""
        if self.maybe(textured):
            return f'"texture {name}" "{self.texture("spectrum", 0, high)}"'
        if self.maybe(0.2):
            return f'"spectrum {name}" [ 400 {self.number(0, high)} 550 {self.number(0, high)} 700 {self.number(0, high)} ]'
        return f'"rgb {name}" [ {self.numbers(0, high)} ]'

    def mapping(self):
        kind = self.rng.choice(["uv", "uv", "spherical", "cylindrical", "planar"])
        scale = f' "float uscale" {self.number(0.5, 5)} "float vscale" {self.number(0.5, 5)}' if kind == "uv" else ""
        return f'"string mapping" "{kind}"{scale}'

    def texture(self, kind, low, high):
        """Declares a texture, and returns its name."""
        self.count += 1
        name = f"texture{self.count}"
        value = (
            (lambda key: f'"float {key}" {self.number(low, high)}')
            if kind == "float"
            else (lambda key: f'"rgb {key}" [ {self.numbers(low, high)} ]')
        )
        choices = {
            "constant": lambda: value("value"),
            "scale": lambda: f'{value("tex")} "float scale" {self.number(0.2, 1)}',
            "mix": lambda: f'{value("tex1")} {value("tex2")} "float amount" {self.number(0, 1)}',
            "directionmix": lambda: f'{value("tex1")} {value("tex2")} "vector3 dir" [ {self.numbers(-1, 1)} ]',
            "bilerp": lambda: " ".join(value(key) for key in ("v00", "v01", "v10", "v11")) + " " + self.mapping(),
            "checkerboard": lambda: (
                f"{value('tex1')} {value('tex2')} " + ('"integer dimension" 3' if self.maybe(0.3) else self.mapping())
            ),
            "dots": lambda: f"{value('inside')} {value('outside')} {self.mapping()}",
            "fbm": lambda: f'"integer octaves" {self.rng.randint(1, 8)} "float roughness" {self.number(0.2, 0.8)}',
            "wrinkled": lambda: f'"integer octaves" {self.rng.randint(1, 8)}',
            "windy": lambda: "",
            "marble": lambda: f'"float scale" {self.number(0.5, 4)} "float variation" {self.number(0.1, 0.4)}',
            "imagemap": lambda: (
                f'"string filename" "picture.png" {self.mapping()} '
                f'"string filter" "{self.rng.choice(["point", "bilinear", "trilinear", "ewa"])}" '
                f'"string wrap" "{self.rng.choice(["repeat", "clamp", "black"])}" "float scale" {self.number(0.3, 1)}'
            ),
        }
        only = {"float": ("fbm", "wrinkled", "windy"), "spectrum": ("marble",)}
        other = only["spectrum" if kind == "float" else "float"]
        plain = [key for key in choices if key not in other]
        chosen = self.rng.choice(plain)
        self.write(f'Texture "{name}" "{kind}" "{chosen}"', choices[chosen]())
        return name

    def roughness(self, least=0.0):
        if self.maybe(0.3):
            return f'"float uroughness" {self.number(least, 0.5)} "float vroughness" {self.number(least, 0.5)}'
        return self.float_of("roughness", least, 0.5) + (' "bool remaproughness" false' if self.maybe(0.3) else "")

    def material(self, inner=True):
        """A material's type and parameters."""
        choices = {
            "diffuse": lambda: self.color_of("reflectance"),
            "conductor": lambda: (
                (self.color_of("reflectance") if self.maybe(0.5) else f'"spectrum eta" "{self.rng.choice(METALS)}"')
                + " "
                + self.roughness()
            ),
            "dielectric": lambda: (
                (f'"float eta" {self.number(1.1, 2)}' if self.maybe(0.7) else '"spectrum eta" "glass-BK7"')
                + (f" {self.roughness()}" if self.maybe(0.5) else "")
            ),
            "thindielectric": lambda: f'"float eta" {self.number(1.1, 2)}',
            "diffusetransmission": lambda: f"{self.color_of('reflectance', 0.5)} {self.color_of('transmittance', 0.5)}",
            "coateddiffuse": lambda: (
                f"{self.color_of('reflectance')} {self.roughness()} "
                f'"float thickness" {self.number(0, 0.1)} "integer nsamples" {self.rng.randint(1, 2)}'
                + (f' "float g" {self.number(-0.5, 0.5)} {self.color_of("albedo", 0.9, 0)}' if self.maybe(0.3) else "")
            ),
            "coatedconductor": lambda: (
                f'"float interface.roughness" {self.number(0, 0.3)} "float conductor.roughness" {self.number(0, 0.3)}'
            ),
            "subsurface": lambda: (
                (
                    f'"string name" "{self.rng.choice(["Skin1", "Marble", "Ketchup"])}" "float scale" {self.number(5, 50)}'
                    if self.maybe(0.5)
                    else f"{self.color_of('reflectance', 0.9)} {self.color_of('mfp', 0.3, 0)}"
                )
                + f" {self.roughness()}"
            ),
        }
        kind = self.rng.choice([*choices, "mix"] if inner else list(choices))
        if kind == "mix":
            names = [self.named_material() for _ in range(2)]
            return f'"mix" "string materials" [ "{names[0]}" "{names[1]}" ] {self.float_of("amount", 0, 1, 0.5)}'
        words = f'"{kind}" {choices[kind]()}'
        if self.maybe(0.2):
            words += f' "texture displacement" "{self.texture("float", 0, 0.05)}"'
        elif self.maybe(0.15):
            words += ' "string normalmap" "picture.png"'
        return words

    def named_material(self):
        self.count += 1
        kind, rest = self.material(inner=False).split(" ", 1)
        self.write(f'MakeNamedMaterial "material{self.count}" "string type" {kind} {rest}')
        return f"material{self.count}"

    def medium(self):
        """Declares a medium, and returns its name."""
        self.count += 1
        name = f"medium{self.count}"
        kind = self.rng.choice(["homogeneous", "homogeneous", "uniformgrid", "rgbgrid", "cloud"])
        coefficients = f'"rgb sigma_a" [ {self.numbers(0, 1)} ] "rgb sigma_s" [ {self.numbers(0, 2)} ]'
        common = f'"float g" {self.number(-0.7, 0.7)} "float scale" {self.number(0.2, 2)}'
        cells = '"integer nx" 3 "integer ny" 2 "integer nz" 2 "point3 p0" [ -1 -1 -1 ] "point3 p1" [ 1 1 1 ]'
        words = {
            "homogeneous": lambda: coefficients + (' "rgb Le" [ 0.2 0.1 0.05 ]' if self.maybe(0.2) else ""),
            "uniformgrid": lambda: f'{coefficients} {cells} "float density" [ {self.numbers(0, 2, 12)} ]',
            "rgbgrid": lambda: f'{cells} "rgb sigma_s" [ {self.numbers(0, 2, 36)} ]',
            "cloud": lambda: f'{coefficients} "float density" {self.number(0.5, 2)} "point3 p0" [ -1 -1 -1 ] "point3 p1" [ 1 1 1 ]',
        }[kind]()
        self.write(f'MakeNamedMedium "{name}" "string type" "{kind}" {words} {common if kind != "cloud" else ""}')
        return name

    def shape(self):
        """A shape's type and parameters, about the origin, of the size of 1."""
        number = self.number
        partial = f' "float phimax" {number(90, 360)}' if self.maybe(0.3) else ""
        choices = {
            "sphere": lambda: (
                f'"float radius" {number(0.4, 0.9)}'
                + (f' "float zmin" {number(-0.5, -0.1)} "float zmax" {number(0.1, 0.4)}{partial}' if self.maybe(0.3) else "")
            ),
            "cylinder": lambda: f'"float radius" {number(0.3, 0.8)} "float zmin" -0.6 "float zmax" 0.5{partial}',
            "disk": lambda: f'"float radius" 0.9 "float innerradius" {number(0, 0.5)}{partial}',
            "trianglemesh": lambda: (
                '"point3 P" [ -1 -1 0  1 -1 0.3  1 1 0 -1 1 0.3 ] "integer indices" [ 0 1 2 0 2 3 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ]'
                + (' "normal N" [ -0.3 -0.3 1 0.3 -0.3 1 0.3 0.3 1 -0.3 0.3 1 ]' if self.maybe(0.5) else "")
            ),
            "bilinearmesh": lambda: (
                f'"point3 P" [ -1 -1 {number(-1, 1)}  1 -1 0  -1 1 0  1 1 {number(-1, 1)} ] "integer indices" [ 0 1 2 3 ]'
            ),
            "loopsubdiv": lambda: (
                f'"integer levels" {self.rng.randint(1, 3)} '
                '"point3 P" [ 0.8 0 -0.5  -0.4 0.7 -0.5  -0.4 -0.7 -0.5  0 0 0.8 ] "integer indices" [ 0 2 1 0 1 3 1 2 3 2 0 3 ]'
            ),
            "curve": lambda: (
                f'"string type" "{self.rng.choice(["flat", "cylinder"])}" '
                f'"point3 P" [ -1 0 0  -0.3 {number(0, 1)} 0  0.3 {number(-1, 0)} 0.4  1 0 0 ] '
                f'"float width0" {number(0.1, 0.3)} "float width1" {number(0.02, 0.3)}'
            ),
        }
        kind = self.rng.choice(list(choices))
        alpha = f" {self.float_of('alpha', 0.3, 1, 0.5)}" if self.maybe(0.15) else ""
        return f'"{kind}" {choices[kind]()}{alpha}'

    def placement(self):
        self.write(f"Translate {self.numbers(-1.5, 1.5, 2)} {self.number(-1, 1)}")
        if self.maybe(0.2):
            self.write("ActiveTransform EndTime", f"Translate {self.numbers(-0.3, 0.3)}", f"Rotate {self.number(-40, 40)} 0 1 0.2")
            self.write("ActiveTransform All")
        self.write(f"Rotate {self.number(0, 360)} {self.numbers(0.1, 1)}")
        if self.maybe(0.3):
            self.write(f"Scale {self.numbers(0.4, 1.2)}")

    def light(self):
        power = f' "float power" {self.number(5, 40)}' if self.maybe(0.2) else ""
        kind = self.rng.choice(["infinite", "infinite", "map", "point", "spot", "distant", "goniometric", "projection", "area"])
        spectrum = self.rng.choice([f'"rgb L" [ {self.numbers(0.2, 1)} ]', f'"blackbody L" {self.number(2500, 9000)}'])
        intensity = spectrum.replace(" L", " I") + f' "float scale" {self.number(2, 8)}'
        self.write("AttributeBegin")
        if kind == "infinite":
            self.write(f'LightSource "infinite" {spectrum}')
        elif kind == "map":
            self.write(f"Rotate {self.number(0, 360)} 0 0 1")
            self.write(f'LightSource "infinite" "string filename" "sky.pfm" "float scale" {self.number(0.3, 1)}')
        elif kind == "area":
            self.write(f"Translate {self.numbers(-1, 1, 2)} 2.5")
            self.write(
                f'AreaLightSource "diffuse" {spectrum} "float scale" {self.number(2, 8)}{power}',
                '"bool twosided" true' * self.maybe(0.3),
            )
            self.write(f"Shape {self.shape()}")
        elif kind == "distant":
            self.write(f'LightSource "distant" {spectrum} "point3 from" [ {self.numbers(-1, 1, 2)} 2 ]')
        else:
            self.write(f"Translate {self.numbers(-2, 2, 2)} 2.5", "Rotate 150 1 0.2 0" * (kind in ("projection", "goniometric")))
            words = {
                "point": "",
                "spot": f'"point3 to" [ 0 0 -2.5 ] "float coneangle" {self.number(20, 60)}',
                "goniometric": '"string filename" "sphere.pfm"',
                "projection": f'"string filename" "picture.png" "float fov" {self.number(30, 90)}',
            }[kind]
            if kind == "projection":
                intensity = f'"float scale" {self.number(5, 20)}'
            self.write(f'LightSource "{kind}" {intensity} {words}{power}')
        self.write("AttributeEnd")

    def head(self, fog):
        """Everything before the world."""
        rng = self.rng
        self.write(f"LookAt {self.numbers(-1, 1, 2)} 7  0 0 0  0 1 0")
        if fog:
            self.write(f'MediumInterface "" "{fog}"')
        camera = rng.choice(["perspective", "perspective", "perspective", "orthographic", "spherical"])
        lens = f' "float lensradius" {self.number(0.02, 0.2)} "float focaldistance" 7' if self.maybe(0.3) else ""
        words = {"perspective": f'"float fov" {self.number(30, 60)}{lens}', "orthographic": '"float screenwindow" [ -3 3 -2 2 ]'}
        self.write(
            f'Camera "{camera}" {words.get(camera, "")} "float shutteropen" 0 "float shutterclose" {rng.choice([1, 1, 0.5])}'
        )
        self.write(f'PixelFilter "{rng.choice(RGB_FILTERS)}"')
        self.write(f'Sampler "{rng.choice(["zsobol", "independent", "halton"])}" "integer pixelsamples" 9')
        integrator = rng.choice(["volpath", "volpath", "path", "simplepath", "simplevolpath", "randomwalk"])
        self.write(
            f'Integrator "{integrator}" "integer maxdepth" {rng.choice([2, 6, 20])}', '"bool regularize" true' * self.maybe(0.2)
        )
        self.write('Film "rgb" "integer xresolution" 48 "integer yresolution" 36 "string filename" "out.exr"')
        if self.maybe(0.3):
            self.write('ColorSpace "rec2020"')

    def scene(self):
        fog = self.medium() if self.maybe(0.25) else None
        declared, self.lines = self.lines, []
        self.head(fog)
        self.lines = declared + self.lines
        self.write("WorldBegin")
        for _ in range(self.rng.randint(1, 3)):
            self.light()
        self.write('AttributeBegin Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]')
        self.write(
            'Shape "trianglemesh" "point3 P" [ -6 -2 -6 6 -2 -6 6 -2 6 -6 -2 6 ] "integer indices" [ 0 1 2 0 2 3 ] AttributeEnd'
        )
        if self.maybe(0.4):
            self.write('ObjectBegin "thing"')
            self.write(f"Material {self.material()}")
            self.write(f"Shape {self.shape()}")
            self.write("ObjectEnd")
            for _ in range(3):
                self.write("AttributeBegin")
                self.placement()
                self.write('ObjectInstance "thing" AttributeEnd')
        for _ in range(self.rng.randint(2, 5)):
            self.write("AttributeBegin")
            self.placement()
            inside = self.medium() if self.maybe(0.25) else None
            if inside:
                self.write(f'MediumInterface "{inside}" "{fog or ""}"')
            if inside and self.maybe(0.5):
                self.write('Material "interface"')
                self.write(f'Shape "sphere" "float radius" {self.number(0.4, 1)}')
            else:
                self.write(f"Material {self.material()}")
                if self.maybe(0.1):
                    self.write("ReverseOrientation")
                self.write(f"Shape {self.shape()}")
            self.write("AttributeEnd")
        return "\n".join(self.lines) + "\n"


def write_inputs(folder):
    """The pictures that the scenes name."""
    rows = [b"\0" + bytes(value for x in range(16) for value in (x * 16, y * 32, 2 * x * y)) for y in range(8)]
    parts = [(b"IHDR", struct.pack(">IIBBBBB", 16, 8, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(b"".join(rows))), (b"IEND", b"")]
    chunks = [struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts]
    (folder / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(chunks))
    values = [0.3 + 0.3 * math.sin(0.7 * x + y + k) for y in range(16) for x in range(16) for k in range(3)]
    for name in ("sky", "sphere"):
        (folder / f"{name}.pfm").write_bytes(b"PF\n16 16\n-1\n" + struct.pack(f"<{len(values)}f", *values))
