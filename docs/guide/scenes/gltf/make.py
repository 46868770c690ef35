#!/usr/bin/env python3
"""Writes the glTF files of the guide: one for each extension, a row of things with a growing amount of it.

    docs/guide/scenes/gltf/make.py

Needs Python's own library alone. The sphere is shared: ball.bin. Everything else is in the files, so that they can be
read and changed by hand. The compressed ones are as simple as their formats allow: they are for reading, not small.
"""

import base64
import json
import math
import struct
import zlib
from pathlib import Path

HERE = Path(__file__).resolve().parent
FLOAT, USHORT, UBYTE, BYTE, SHORT = 5126, 5123, 5121, 5120, 5122
FORMATS = {FLOAT: "f", USHORT: "H", UBYTE: "B", BYTE: "b", SHORT: "h"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


# What files are made of

def sphere(columns, rows):
    """The unit sphere around the origin: points, texture coordinates, triangles. Poles are to the south and the north."""
    points, uvs, triangles = [], [], []
    for row in range(rows + 1):
        theta = math.pi * row / rows
        for column in range(columns + 1):
            phi = 2 * math.pi * column / columns
            points.append((-math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)))
            uvs.append((column / columns, row / rows))
    for row in range(rows):
        for column in range(columns):
            a = row * (columns + 1) + column
            b = a + columns + 1
            if row > 0:
                triangles.append((a, b, a + 1))
            if row < rows - 1:
                triangles.append((a + 1, b, b + 1))
    return points, uvs, triangles


def picture(width, height, pixel):
    """A PNG as a data URI. `pixel(x, y)` is red, green, blue, opacity from 0 to 255."""
    rows = b"".join(b"\0" + bytes(sum((list(pixel(x, y)) for x in range(width)), [])) for y in range(height))

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
    return "data:image/png;base64," + base64.b64encode(png).decode()


RING_THICKNESS = 0.28


def ring(around=72, across=18):
    """A ring in the plane z = 0, 1 from the origin at most: points, normals, triangles."""
    points, normals, triangles = [], [], []
    for i in range(around):
        a = 2 * math.pi * i / around
        for j in range(across):
            b = 2 * math.pi * j / across
            normal = (math.cos(a) * math.cos(b), math.sin(a) * math.cos(b), math.sin(b))
            middle = ((1 - RING_THICKNESS) * math.cos(a), (1 - RING_THICKNESS) * math.sin(a), 0)
            points.append(tuple(m + RING_THICKNESS * n for m, n in zip(middle, normal)))
            normals.append(normal)
            k, l = (i + 1) % around, (j + 1) % across
            p, q, r, s = i * across + j, k * across + j, i * across + l, k * across + l
            triangles += [(p, q, r), (q, s, r)]
    return points, normals, triangles


class File:
    """A glTF file on its way, with a floor, a camera that looks at a row, and the shared ball as mesh 0's form."""

    def __init__(self, floor=True, high=1.0, look_down=0.17, width=11.6):
        self.root = {
            "asset": {"version": "2.0", "generator": "docs/guide/scenes/gltf/make.py"},
            "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "materials": [],
            "cameras": [], "accessors": [], "bufferViews": [], "buffers": [],
        }
        self.balls = {}
        self.ball_parts = None
        self.own = bytearray()
        self.camera(high, look_down, width)
        if floor:
            self.floor()

    def add(self, what, item):
        self.root.setdefault(what, []).append(item)
        return len(self.root[what]) - 1

    def uses(self, *names, required=False):
        self.root.setdefault("extensionsUsed", []).extend(names)
        if required:
            self.root.setdefault("extensionsRequired", []).extend(names)

    def node(self, **node):
        index = self.add("nodes", node)
        self.root["scenes"][0]["nodes"].append(index)
        return index

    def camera(self, high, look_down, width):
        """Looks along −z and down at what stands around (0, `high`, 0); `width` units fill the picture, 3 : 1."""
        half = 0.1
        distance = width / 3 / 2 / math.tan(half)
        place = [0, high + distance * math.sin(look_down), distance * math.cos(look_down)]
        lens = {"yfov": 2 * half, "aspectRatio": 3, "znear": 0.1}
        self.add("cameras", {"type": "perspective", "perspective": lens})
        turn = [-math.sin(look_down / 2), 0, 0, math.cos(look_down / 2)]
        self.node(name="eye", camera=0, translation=rounded(place), rotation=rounded(turn, 6))

    def view(self, content, **more):
        offset = len(self.own)
        self.own += content + bytes(-len(content) % 4)
        return self.add("bufferViews", {"buffer": "own", "byteOffset": offset, "byteLength": len(content), **more})

    def numbers(self, kind, rows, component=FLOAT, normalized=False, bounds=False, stride=None):
        """An accessor of rows of numbers."""
        width = WIDTHS[kind]
        row = struct.Struct(f"<{width}{FORMATS[component]}")
        padding = bytes((stride or row.size) - row.size)
        content = b"".join(row.pack(*numbers) + padding for numbers in rows)
        view = self.view(content, **({"byteStride": stride} if stride else {}))
        accessor = {"bufferView": view, "componentType": component, "count": len(rows), "type": kind}
        if normalized:
            accessor["normalized"] = True
        if bounds:
            # As they are stored.
            stored = [row.unpack(row.pack(*numbers)) for numbers in rows]
            accessor["min"] = [min(column) for column in zip(*stored)]
            accessor["max"] = [max(column) for column in zip(*stored)]
        return self.add("accessors", accessor)

    def indices(self, triangles):
        return self.numbers("SCALAR", [(corner,) for triangle in triangles for corner in triangle], USHORT)

    def texture(self, uri, nearest=True, mime=None):
        filters = {"magFilter": 9728 if nearest else 9729, "minFilter": 9728 if nearest else 9729}
        sampler = self.add("samplers", filters)
        image = self.add("images", {"uri": uri} if mime is None else {"uri": uri, "mimeType": mime})
        return self.add("textures", {"sampler": sampler, "source": image})

    def floor(self):
        """A matte floor of squares of 4/3, wide enough for every glance."""
        gray = self.texture(picture(2, 2, lambda x, y: [(150, 126)[(x + y) % 2]] * 3 + [255]))
        material = self.add("materials", {
            "name": "floor",
            "pbrMetallicRoughness": {"baseColorTexture": {"index": gray}, "metallicFactor": 0, "roughnessFactor": 1},
            "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
        })
        self.uses("KHR_materials_specular")
        half, squares = 40, 30
        positions = self.numbers("VEC3", [(x, 0, z) for z in (-half, half) for x in (-half, half)], bounds=True)
        uvs = self.numbers("VEC2", [(u, v) for v in (0, squares) for u in (0, squares)])
        primitive = {
            "attributes": {"POSITION": positions, "TEXCOORD_0": uvs},
            "indices": self.indices([(0, 2, 1), (1, 2, 3)]), "material": material,
        }
        self.node(name="floor", mesh=self.add("meshes", {"primitives": [primitive]}))

    def ball(self, material):
        """A mesh: the shared ball, of this material."""
        if self.ball_parts is None:
            shared, places = ball_file()
            buffer = self.add("buffers", {"uri": "ball.bin", "byteLength": len(shared)})
            views = [self.add("bufferViews", {"buffer": buffer, "byteOffset": at, "byteLength": length})
                     for at, length in places]
            points, uvs, triangles = BALL
            accessor = lambda view, component, count, kind, **more: self.add("accessors", {
                "bufferView": views[view], "componentType": component, "count": count, "type": kind, **more})
            self.ball_parts = (
                accessor(0, FLOAT, len(points), "VEC3", min=[-1, -1, -1], max=[1, 1, 1]),
                accessor(1, USHORT, len(uvs), "VEC2", normalized=True),
                accessor(2, USHORT, 3 * len(triangles), "SCALAR"),
            )
        if material not in self.balls:
            # The points of a unit sphere are its normals.
            points, uvs, triangles = self.ball_parts
            attributes = {"POSITION": points, "NORMAL": points, "TEXCOORD_0": uvs}
            primitive = {"attributes": attributes, "indices": triangles, "material": material}
            self.balls[material] = self.add("meshes", {"primitives": [primitive]})
        return self.balls[material]

    def row(self, materials, high=1.0, radius=1.0):
        """Balls side by side, one for each material."""
        for place, material in enumerate(materials):
            x = 2.25 * (place - (len(materials) - 1) / 2)
            mesh = self.ball(self.add("materials", material))
            scale = {} if radius == 1 else {"scale": [radius] * 3}
            self.node(mesh=mesh, translation=rounded([x, high, 0]), **scale)

    def panel(self, material, x, size=2.0):
        """A standing square that faces the camera, its lower edge on the floor."""
        if not hasattr(self, "square"):
            half = size / 2
            positions = self.numbers("VEC3", [(a * half, b * half, 0) for b in (1, -1) for a in (-1, 1)], bounds=True)
            uvs = self.numbers("VEC2", [(u, v) for v in (0, 1) for u in (0, 1)])
            self.square = ({"POSITION": positions, "TEXCOORD_0": uvs}, self.indices([(0, 2, 1), (1, 2, 3)]))
        attributes, indices = self.square
        primitive = {"attributes": attributes, "indices": indices, "material": self.add("materials", material)}
        self.node(mesh=self.add("meshes", {"primitives": [primitive]}), translation=[x, size / 2, 0])

    def write(self, name):
        if self.own:
            uri = "data:application/octet-stream;base64," + base64.b64encode(self.own).decode()
            buffer = self.add("buffers", {"byteLength": len(self.own), "uri": uri})
            for view in self.root["bufferViews"]:
                for place in [view, *view.get("extensions", {}).values()]:
                    place["buffer"] = buffer if place["buffer"] == "own" else place["buffer"]
        if "extensionsUsed" in self.root:
            self.root["extensionsUsed"] = sorted(set(self.root["extensionsUsed"]))
        root = {key: value for key, value in self.root.items() if value != []}
        (HERE / f"{name}.gltf").write_text(text(root) + "\n")


def rounded(numbers, digits=4):
    return [round(number, digits) + 0.0 for number in numbers]


def text(value, indent=""):
    """JSON with one thing a line where it fits."""
    line = json.dumps(value)
    if len(indent) + len(line) <= 120 or not isinstance(value, (dict, list)):
        return line
    deeper = indent + "  "
    if isinstance(value, dict):
        parts = [f"{deeper}{json.dumps(key)}: {text(item, deeper)}" for key, item in value.items()]
        return "{\n" + ",\n".join(parts) + f"\n{indent}}}"
    return "[\n" + ",\n".join(deeper + text(item, deeper) for item in value) + f"\n{indent}]"


BALL = sphere(60, 40)


def ball_file():
    """The bytes of the shared ball, and where its points, texture coordinates and triangles are."""
    points, uvs, triangles = BALL
    content, places = bytearray(), []
    for part in (
        b"".join(struct.pack("<3f", *point) for point in points),
        b"".join(struct.pack("<2H", *(round(65535 * number) for number in uv)) for uv in uvs),
        b"".join(struct.pack("<3H", *triangle) for triangle in triangles),
    ):
        places.append((len(content), len(part)))
        content += part + bytes(-len(part) % 4)
    return bytes(content), places


def surface(color=(0.8, 0.8, 0.8), metallic=0.0, roughness=0.5, **extensions):
    """A material."""
    body = {"baseColorFactor": [*color, 1], "metallicFactor": metallic, "roughnessFactor": roughness}
    material = {"pbrMetallicRoughness": body}
    if extensions:
        material["extensions"] = {f"KHR_materials_{name}": value for name, value in extensions.items()}
    return material


RED, GOLD, BLUE = (0.6, 0.04, 0.03), (1.0, 0.71, 0.29), (0.05, 0.15, 0.5)
GLASS = {"transmission": {"transmissionFactor": 1}, "volume": {"thicknessFactor": 2}}


# The files

def of_materials(name, extensions, materials):
    """A row of balls."""
    file = File()
    file.uses(*(f"KHR_materials_{extension}" for extension in extensions))
    file.row(materials)
    file.write(name)


def rows():
    """What shows on a ball."""
    of_materials("metallic-roughness", [], [surface(GOLD, 1, r) for r in (0, 0.2, 0.4, 0.7, 1)])
    of_materials("ior", ["ior", "transmission", "volume"],
                 [surface((1, 1, 1), 0, 0, ior={"ior": n}, **GLASS) for n in (1.0, 1.1, 1.33, 1.5, 2.4)])
    of_materials("transmission", ["transmission"],
                 [surface((0.5, 0.9, 0.6), 0, roughness, transmission={"transmissionFactor": factor})
                  for factor, roughness in ((0, 0), (0.5, 0), (1, 0), (1, 0.25), (1, 0.5))])
    of_materials("volume", ["transmission", "volume"], [
        surface((1, 1, 1), 0, 0, transmission={"transmissionFactor": 1},
                volume={"thicknessFactor": 2, "attenuationColor": [0.9, 0.5, 0.1], **distance})
        for distance in ({}, *({"attenuationDistance": d} for d in (4, 2, 1, 0.4)))])
    # Cloudy glass, milk, jade, wax and skin.
    of_materials("volume-scatter", ["diffuse_transmission", "transmission", "volume", "volume_scatter"], [
        surface((1, 1, 1), 0, roughness, **boundary,
                volume={"thicknessFactor": 2, "attenuationColor": [0.37, 0.37, 0.37], "attenuationDistance": distance},
                volume_scatter={"multiscatterColorFactor": color, "scatterAnisotropy": anisotropy})
        for boundary, roughness, distance, color, anisotropy in (
            ({"transmission": {"transmissionFactor": 1}}, 0, 2, [0.9, 0.9, 0.9], 0),
            ({"transmission": {"transmissionFactor": 1}}, 0, 0.5, [0.9, 0.9, 0.9], 0),
            ({"transmission": {"transmissionFactor": 1}}, 0.3, 0.2, [0.45, 0.8, 0.6], 0.3),
            ({"diffuse_transmission": {"diffuseTransmissionFactor": 1}}, 0.4, 0.2, [0.95, 0.7, 0.35], 0),
            ({"diffuse_transmission": {"diffuseTransmissionFactor": 1}}, 0.4, 0.05, [0.85, 0.45, 0.35], 0))])
    of_materials("clearcoat", ["clearcoat"], [
        surface(RED, 0, 0.8, clearcoat={"clearcoatFactor": factor, "clearcoatRoughnessFactor": roughness})
        for factor, roughness in ((0, 0), (0.3, 0), (1, 0), (1, 0.2), (1, 0.5))])
    of_materials("specular", ["specular"], [
        surface((0.08, 0.08, 0.09), 0, 0.15, specular={"specularFactor": factor, "specularColorFactor": color})
        for factor, color in ((0, [1, 1, 1]), (0.5, [1, 1, 1]), (1, [1, 1, 1]), (1, [1, 0.4, 0.1]), (1, [4, 8, 16]))])
    of_materials("sheen", ["sheen"], [
        surface((0.12, 0.02, 0.03), 0, 0.9, sheen={"sheenColorFactor": color, "sheenRoughnessFactor": roughness})
        for color, roughness in (([0, 0, 0], 0.3), ([0.4, 0.25, 0.25], 0.3), ([1, 0.6, 0.6], 0.15),
                                 ([1, 0.6, 0.6], 0.3), ([1, 0.6, 0.6], 0.8))])
    of_materials("iridescence", ["iridescence"], [
        surface((0.02, 0.02, 0.02), 0, 0.05,
                iridescence={"iridescenceFactor": 1, "iridescenceIor": 1.8, "iridescenceThicknessMaximum": thickness})
        for thickness in (150, 250, 350, 450, 700)])
    of_materials("anisotropy", ["anisotropy"], [
        surface((0.8, 0.8, 0.82), 1, 0.35, anisotropy={"anisotropyStrength": strength, "anisotropyRotation": turn})
        for strength, turn in ((0, 0), (0.5, 0), (1, 0), (1, 0.7854), (1, 1.5708))])
    of_materials("dispersion", ["dispersion", "ior", "transmission", "volume"], [
        surface((1, 1, 1), 0, 0, ior={"ior": 1.7}, dispersion={"dispersion": dispersion}, **GLASS)
        for dispersion in (0, 0.4, 1, 3, 8)])
    of_materials("unlit", ["unlit"], [
        surface((0.9, 0.35, 0.05)),
        *(surface(color, unlit={}) for color in ((0.9, 0.35, 0.05), (0.1, 0.5, 0.15), (0.04, 0.15, 0.6))),
        surface((0.04, 0.15, 0.6))])
    of_materials("emissive-strength", ["emissive_strength"], [
        {**surface((0, 0, 0), 0, 1, emissive_strength={"emissiveStrength": strength}), "emissiveFactor": [1, 0.55, 0.2]}
        for strength in (0.25, 0.5, 1, 2, 4)])
    of_materials("specular-glossiness", ["pbrSpecularGlossiness"], [
        {"extensions": {"KHR_materials_pbrSpecularGlossiness": {
            "diffuseFactor": [*diffuse, 1], "specularFactor": specular, "glossinessFactor": glossiness}}}
        for diffuse, specular, glossiness in (
            (BLUE, [0.04] * 3, 0.2), (BLUE, [0.04] * 3, 0.8), (BLUE, [0.3] * 3, 0.8),
            ((0, 0, 0), [0.95, 0.64, 0.54], 0.6), ((0, 0, 0), [0.95, 0.64, 0.54], 0.9))])


def diffuse_transmission():
    """Shades with a lamp in each."""
    file = File()
    file.uses("KHR_materials_diffuse_transmission", "KHR_lights_punctual")
    file.row([
        {**surface((0.9, 0.8, 0.6), 0, 0.8, diffuse_transmission={
            "diffuseTransmissionFactor": factor, "diffuseTransmissionColorFactor": color}), "doubleSided": True}
        for factor, color in ((0, [1, 1, 1]), (0.25, [1, 1, 1]), (0.5, [1, 1, 1]), (0.75, [1, 1, 1]),
                              (0.75, [1, 0.3, 0.1]))])
    file.root["extensions"] = {"KHR_lights_punctual": {"lights": [
        {"type": "point", "intensity": 1}, {"type": "directional", "intensity": 0.8}]}}
    for place in range(5):
        x = 2.25 * (place - 2)
        file.node(translation=[x, 1, 0], extensions={"KHR_lights_punctual": {"light": 0}})
    # From the upper left, at the front.
    file.node(rotation=rounded([-0.42, -0.28, 0, 0.86], 3), extensions={"KHR_lights_punctual": {"light": 1}})
    file.write("diffuse-transmission")


def lights_punctual():
    """A lamp of each kind."""
    file = File()
    file.uses("KHR_lights_punctual")
    file.row([surface((0.7, 0.7, 0.7), 0, 0.4)] * 5)
    file.root["extensions"] = {"KHR_lights_punctual": {"lights": [
        {"name": "sun", "type": "directional", "color": [1, 0.9, 0.8], "intensity": 1.2},
        {"name": "bulb", "type": "point", "color": [1, 0.35, 0.1], "intensity": 9},
        {"name": "stage", "type": "spot", "color": [0.25, 0.5, 1], "intensity": 70,
         "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.3}},
    ]}}
    light = lambda index: {"KHR_lights_punctual": {"light": index}}
    file.node(name="sun", rotation=[-0.3, 0.35, 0.1, 0.88], extensions=light(0))
    file.node(name="bulb", translation=[-3.4, 0.6, 2.0], extensions=light(1))
    # A spot shines along −z: turned down.
    file.node(name="stage", translation=[3.3, 6, 2.5], rotation=rounded([-math.sin(0.6), 0, 0, math.cos(0.6)], 4),
              extensions=light(2))
    file.write("lights-punctual")


def letter(x, y):
    """A picture of 8 × 8 that shows which way it is turned: an F, on ground that grows brighter to the right."""
    rows = ("........", ".#####..", ".#......", ".####...", ".#......", ".#......", ".#......", "........")
    ground = 90 + 18 * x
    return (200, 40, 30, 255) if rows[y][x] == "#" else (ground, ground, 60, 255)


def texture_transform():
    """One picture on five panels."""
    file = File()
    file.uses("KHR_texture_transform")
    texture = file.texture(picture(8, 8, letter))
    for place, transform in enumerate((
        {}, {"offset": [0.5, 0.25]}, {"rotation": 0.5236}, {"scale": [2, 3]},
        {"offset": [0, 1], "rotation": 0.7854, "scale": [1.5, 1.5]},
    )):
        info = {"index": texture}
        if transform:
            info["extensions"] = {"KHR_texture_transform": transform}
        body = {"metallicFactor": 0, "roughnessFactor": 0.7, "baseColorTexture": info}
        file.panel({"pbrMetallicRoughness": body}, 2.25 * (place - 2))
    file.write("texture-transform")


def variants():
    """Balls that are painted in one of three ways."""
    file = File()
    file.uses("KHR_materials_variants")
    file.root["extensions"] = {"KHR_materials_variants": {
        "variants": [{"name": "clay"}, {"name": "lacquer"}, {"name": "gold"}]}}
    file.row([surface(color, 0, 0.9) for color in ((0.7, 0.5, 0.4), (0.55, 0.35, 0.25), (0.4, 0.25, 0.18))])
    lacquer = file.add("materials", surface(RED, 0, 0.1))
    gold = file.add("materials", surface(GOLD, 1, 0.25))
    for mesh in file.balls.values():
        primitive = file.root["meshes"][mesh]["primitives"][0]
        primitive["extensions"] = {"KHR_materials_variants": {"mappings": [
            {"material": primitive["material"], "variants": [0]},
            {"material": lacquer, "variants": [1]}, {"material": gold, "variants": [2]}]}}
    file.write("variants")


def mesh_quantization():
    """Balls of positions and normals with ever fewer bits."""
    file = File()
    file.uses("KHR_mesh_quantization", required=True)
    material = file.add("materials", surface((0.75, 0.75, 0.78), 1, 0.12))
    points, _, triangles = sphere(32, 24)
    indices = file.indices(triangles)
    for place, (component, most) in enumerate(((FLOAT, 1), (SHORT, 32767), (BYTE, 127), (BYTE, 7))):
        # What is normalised has the greatest number for 1; the last ball uses less of it, and is scaled up.
        def stored(greatest):
            whole = component != FLOAT
            rows = [[round(greatest * x) if whole else x for x in point] for point in points]
            return file.numbers("VEC3", rows, component, whole, True, {FLOAT: 12, SHORT: 8, BYTE: 4}[component])

        index = stored(most)
        normals = stored(127) if most == 7 else index
        primitive = {"attributes": {"POSITION": index, "NORMAL": normals}, "indices": indices, "material": material}
        scale = {"scale": [127 / 7] * 3} if most == 7 else {}
        file.node(mesh=file.add("meshes", {"primitives": [primitive]}),
                  translation=rounded([2.5 * (place - 1.5), 1, 0]), **scale)
    file.write("mesh-quantization")


def mesh_gpu_instancing():
    """One ball, four hundred times."""
    file = File(width=12.5, high=0.5, look_down=0.5)
    file.uses("EXT_mesh_gpu_instancing")
    mesh = file.ball(file.add("materials", surface(BLUE, 0, 0.25)))
    places, scales = [], []
    for seed in range(400):
        turn, distance = seed * 2.399963, 0.3 * math.sqrt(seed)
        size = 0.12 + 0.14 * (0.5 + 0.5 * math.sin(0.6 * distance + 0.5))
        places.append((distance * math.cos(turn), size, distance * math.sin(turn)))
        scales.append((size, size, size))
    attributes = {"TRANSLATION": file.numbers("VEC3", places), "SCALE": file.numbers("VEC3", scales)}
    file.node(mesh=mesh, extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})
    file.write("mesh-gpu-instancing")


def meshopt_attributes(rows, stride):
    """Elements of `stride` bytes in meshopt's version 0: differences of bytes from element to element, in groups of 16."""
    block_size = min(256, 8192 // stride // 16 * 16)
    stream, last = bytearray([0xA0]), bytes(rows[0])
    for start in range(0, len(rows), block_size):
        block = rows[start:start + block_size]
        for byte in range(stride):
            before = [last[byte], *(row[byte] for row in block[:-1])]
            steps = [(row[byte] - b + 128) % 256 - 128 for row, b in zip(block, before)]
            zigzag = [2 * step if step >= 0 else -2 * step - 1 for step in steps]
            groups = [zigzag[i:i + 16] for i in range(0, len(zigzag), 16)]
            # Of 16 differences all are 0, all fit into four bits, or they have a byte each.
            kinds = [0 if not any(group) else 2 if max(group) < 15 else 3 for group in groups]
            header = bytearray(-(-len(groups) // 4))
            for i, kind in enumerate(kinds):
                header[i // 4] |= kind << (2 * (i % 4))
            stream += header
            for group, kind in zip(groups, kinds):
                group = group + [0] * (16 - len(group))
                if kind == 2:
                    stream += bytes(a << 4 | b for a, b in zip(group[::2], group[1::2]))
                elif kind == 3:
                    stream += bytes(group)
        last = block[-1]
    tail = bytes(max(32, stride) - stride) + bytes(rows[0])
    return bytes(stream + tail)


def meshopt_indices(indices):
    """Indices in meshopt's version 1 of sequences: each as the difference from one of the last two."""
    stream, last = bytearray([0xD1]), [0, 0]
    for index in indices:
        which = 0 if abs(index - last[0]) <= abs(index - last[1]) else 1
        step = index - last[which]
        last[which] = index
        word = (2 * step if step >= 0 else -2 * step - 1) << 1 | which
        while word > 127:
            stream.append(word & 127 | 128)
            word >>= 7
        stream.append(word)
    return bytes(stream) + bytes(4)


def meshopt_compression():
    """Rings whose bytes are packed."""
    file = File()
    file.uses("EXT_meshopt_compression", "KHR_mesh_quantization", required=True)
    points, directions, triangles = ring()
    positions = [struct.pack("<4h", *(round(32767 * x) for x in point), 0) for point in points]
    normals = [struct.pack("<4b", *(round(127 * x) for x in normal), 0) for normal in directions]
    triangles = [corner for triangle in triangles for corner in triangle]
    empty = file.add("buffers", {"byteLength": 1 << 16, "extensions": {"EXT_meshopt_compression": {"fallback": True}}})

    def packed(stream, count, stride, mode, offset):
        where = file.view(stream)
        own = file.root["bufferViews"][where]
        unpacked = {"buffer": empty, "byteOffset": offset, "byteLength": count * stride}
        if mode == "ATTRIBUTES":
            unpacked["byteStride"] = stride
        unpacked["extensions"] = {"EXT_meshopt_compression": {
            **own, "byteStride": stride, "count": count, "mode": mode}}
        file.root["bufferViews"][where] = unpacked
        return where

    count = len(positions)
    point_view = packed(meshopt_attributes(positions, 8), count, 8, "ATTRIBUTES", 0)
    normal_view = packed(meshopt_attributes(normals, 4), count, 4, "ATTRIBUTES", 8 * count)
    index_view = packed(meshopt_indices(triangles), len(triangles), 2, "INDICES", 12 * count)
    accessor = lambda view, component, count, kind, **more: file.add("accessors", {
        "bufferView": view, "componentType": component, "count": count, "type": kind, **more})
    edge, height = 32767, round(32767 * RING_THICKNESS)
    point = accessor(point_view, SHORT, count, "VEC3", normalized=True, min=[-edge, -edge, -height],
                     max=[edge, edge, height])
    normal = accessor(normal_view, BYTE, count, "VEC3", normalized=True)
    index = accessor(index_view, USHORT, len(triangles), "SCALAR")
    rings(file, {"attributes": {"POSITION": point, "NORMAL": normal}, "indices": index})
    file.write("meshopt-compression")


def rings(file, primitive):
    """Three rings of metal."""
    for place, color in enumerate((GOLD, (0.95, 0.64, 0.54), (0.9, 0.9, 0.92))):
        material = file.add("materials", surface(color, 1, 0.2))
        mesh = file.add("meshes", {"primitives": [{**primitive, "material": material}]})
        turn = 0.35 * (place - 1)
        file.node(mesh=mesh, translation=[2.6 * (place - 1), 1, 0],
                  rotation=rounded([0, math.sin(turn), 0, math.cos(turn)]))


def draco_compression():
    """The same rings from ring.drc: the stream that Google's encoder, as the package DracoPy 2.2 has it, made of them by

        points, normals, triangles = make.ring()
        DracoPy.encode(points, triangles, 11, 9, normals=normals, normal_quantization_bits=8)
    """
    file = File()
    file.uses("KHR_draco_mesh_compression", required=True)
    stream = (HERE / "ring.drc").read_bytes()
    points, _, triangles = ring()
    count = len(points)
    reach = 1.001
    accessor = lambda component, count, kind, **more: file.add("accessors", {
        "componentType": component, "count": count, "type": kind, **more})
    point = accessor(FLOAT, count, "VEC3", min=[-reach, -reach, -RING_THICKNESS], max=[reach, reach, RING_THICKNESS])
    normal = accessor(FLOAT, count, "VEC3")
    index = accessor(USHORT, 3 * len(triangles), "SCALAR")
    packed = {"bufferView": file.view(stream), "attributes": {"NORMAL": 0, "POSITION": 1}}
    rings(file, {"attributes": {"POSITION": point, "NORMAL": normal}, "indices": index,
                 "extensions": {"KHR_draco_mesh_compression": packed}})
    file.write("draco-compression")


def ktx2(width, height, pixel):
    """A picture in KTX 2 with Basis Universal's UASTC, each pixel of it a block of 4 × 4: mode 8, one colour."""
    blocks = b"".join(
        (0x17 | int.from_bytes(bytes(pixel(x, y)), "little") << 5).to_bytes(16, "little")
        for y in range(height) for x in range(width))
    # What the blocks are: colour model 166, sRGB, 16 bytes for 4 × 4 texels with one sample of colour and opacity.
    descriptor = struct.pack("<IHHBBBB4B8B", 0, 2, 40, 166, 1, 2, 0, 3, 3, 0, 0, 16, *[0] * 7)
    descriptor += struct.pack("<HBB4BII", 0, 127, 3, 0, 0, 0, 0, 0, 0xFFFFFFFF)
    descriptor = struct.pack("<I", 4 + len(descriptor)) + descriptor
    head = 80 + 24
    start = -(-(head + len(descriptor)) // 16) * 16
    header = b"\xabKTX 20\xbb\r\n\x1a\n" + struct.pack(
        "<9I", 0, 1, 4 * width, 4 * height, 0, 0, 1, 1, 0) + struct.pack(
        "<4I2Q", head, len(descriptor), 0, 0, 0, 0) + struct.pack("<3Q", start, len(blocks), len(blocks))
    content = header + descriptor
    content += bytes(start - len(content)) + blocks
    return "data:image/ktx2;base64," + base64.b64encode(content).decode()


def texture_formats():
    """The same picture as PNG, as WebP (letter.webp, by `cwebp -lossless`) and in KTX 2."""
    file = File(width=9)
    file.uses("EXT_texture_webp", "KHR_texture_basisu", required=True)
    uris = [
        picture(8, 8, letter),
        "data:image/webp;base64," + base64.b64encode((HERE / "letter.webp").read_bytes()).decode(),
        ktx2(8, 8, letter),
    ]
    for place, (uri, name) in enumerate(zip(uris, (None, "EXT_texture_webp", "KHR_texture_basisu"))):
        mime = uri[5:uri.index(";")]
        texture = file.texture(uri, mime=mime)
        if name:
            entry = file.root["textures"][texture]
            entry["extensions"] = {name: {"source": entry.pop("source")}}
        body = {"metallicFactor": 0, "roughnessFactor": 0.7, "baseColorTexture": {"index": texture}}
        file.panel({"pbrMetallicRoughness": body}, 2.5 * (place - 1))
    file.write("texture-formats")


if __name__ == "__main__":
    (HERE / "ball.bin").write_bytes(ball_file()[0])
    rows()
    diffuse_transmission()
    lights_punctual()
    texture_transform()
    variants()
    mesh_quantization()
    mesh_gpu_instancing()
    meshopt_compression()
    draco_compression()
    texture_formats()
