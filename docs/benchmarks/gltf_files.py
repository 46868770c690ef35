"""Random glTF files, by a grammar."""

import json
import random
import struct
import zlib

import numpy as np

ASPECT = 4 / 3
FORMATS = {"f4": 5126, "u1": 5121, "i1": 5120, "u2": 5123, "i2": 5122, "u4": 5125}
KINDS = ["emission", "matte", "metal", "plastic", "glass", "coat"]
FEATURES = "animations colors coordinates instances matrix mirrored morph normals opacity pointers".split()
FEATURES += "quantized skin sparse transform".split()


def png(texels):
    """The bytes of a PNG of 8 bits."""
    height, width, channels = texels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in texels)
    head = struct.pack(">IIBBBBB", width, height, 8, {1: 0, 3: 2, 4: 6}[channels], 0, 0, 0)
    parts = [(b"IHDR", head), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")]
    chunk = [struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunk)


def ball():
    rows, columns = 10, 16
    polar, around = np.meshgrid(np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, columns + 1), indexing="ij")
    points = np.stack([np.sin(polar) * np.cos(around), np.cos(polar), -np.sin(polar) * np.sin(around)], axis=-1)
    uv = np.stack([around / (2 * np.pi), polar / np.pi], axis=-1)
    faces = []
    for i in range(rows):
        for k in range(columns):
            a, b = i * (columns + 1) + k, (i + 1) * (columns + 1) + k
            faces += ([(a, b, b + 1)] if i < rows - 1 else []) + ([(a, b + 1, a + 1)] if i > 0 else [])
    return points.reshape(-1, 3), points.reshape(-1, 3), uv.reshape(-1, 2), np.array(faces)


def cube():
    points, normals, uv, faces = [], [], [], []
    for axis in range(3):
        for sign in (-1, 1):
            normal = np.zeros(3)
            normal[axis] = sign
            along = np.roll(normal, 1) * sign
            across = np.cross(normal, along)
            start = len(points)
            for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
                points.append(normal + along * (2 * s - 1) + across * (2 * t - 1))
                normals.append(normal)
                uv.append((s, 1 - t))
            faces += [(start, start + 1, start + 2), (start, start + 2, start + 3)]
    return np.array(points), np.array(normals), np.array(uv, float), np.array(faces)


def sheet():
    count = 4
    s, t = np.meshgrid(np.linspace(0, 1, count + 1), np.linspace(0, 1, count + 1), indexing="ij")
    points = np.stack([2 * s - 1, 2 * t - 1, 0.3 * np.sin(4 * s)], axis=-1).reshape(-1, 3)
    normals = np.stack([-0.6 * np.cos(4 * s), 0 * s, np.ones_like(s)], axis=-1).reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    faces = []
    for i in range(count):
        for k in range(count):
            a = i * (count + 1) + k
            faces += [(a, a + count + 1, a + count + 2), (a, a + count + 2, a + 1)]
    return points, normals, np.stack([s, 1 - t], axis=-1).reshape(-1, 2), np.array(faces)


def strip(count=12):
    """A band about the y axis, whose vertices are those of one triangle strip."""
    turns = np.repeat(np.linspace(0, 2 * np.pi, count + 1), 2)
    heights = np.tile([1.0, -1.0], count + 1)
    normals = np.stack([np.cos(turns), 0 * turns, -np.sin(turns)], axis=1)
    points = normals + heights[:, None] * np.array([0, 1, 0])
    return points, normals, np.stack([turns / (2 * np.pi), (1 - heights) / 2], axis=1)


def fan(count=9):
    """A disk, whose vertices are those of one triangle fan."""
    turns = np.linspace(0, 2 * np.pi, count + 1)
    rim = np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1)
    points = np.concatenate([[[0, 0, 0]], rim])
    return points, np.tile([0.0, 0, 1], (count + 2, 1)), points[:, :2] * [0.5, -0.5] + 0.5


class File:
    """A glTF file that grows."""

    def __init__(self, seed, without=(), is_smooth=False):
        """Animations of smooth motion have no steps, and rotations between keys that are near."""
        self.random, self.without, self.data, self.is_smooth = random.Random(seed), without, bytearray(), is_smooth
        self.json = {
            key: []
            for key in "accessors bufferViews images samplers textures materials meshes nodes skins cameras animations".split()
        }
        self.json |= {"asset": {"version": "2.0"}, "extensionsUsed": [], "scene": 0}
        self.lights, self.roots = [], []

    def chance(self, probability, feature=None):
        return self.random.random() < probability and feature not in self.without

    def between(self, low, high):
        return round(self.random.uniform(low, high), 3)

    def numbers(self, count, low, high):
        return [self.between(low, high) for _ in range(count)]

    def add(self, key, value):
        self.json[key].append(value)
        return len(self.json[key]) - 1

    def uses(self, extension, value):
        if extension not in self.json["extensionsUsed"]:
            self.json["extensionsUsed"].append(extension)
        return {extension: value}

    def view(self, data, **more):
        self.data += bytes(-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more}
        self.data += data
        return self.add("bufferViews", view)

    # Accessors.

    def accessor(self, values, form="f4", normalized=False, sparse=False):
        values = np.asarray(values)
        values = values.reshape(len(values), -1)
        if normalized:
            values = np.round(values * {"u1": 255, "i1": 127, "u2": 65535, "i2": 32767}[form])
        values = values.astype("<" + form)
        width = values.shape[1]
        accessor = {
            "componentType": FORMATS[form],
            "count": len(values),
            "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}[width],
            "min": values.min(axis=0).tolist(),
            "max": values.max(axis=0).tolist(),
        }
        accessor |= {"normalized": True} if normalized else {}
        if sparse:
            places = np.sort(self.random.sample(range(len(values)), len(values) // 2)).astype("<u2")
            moved = values.copy()
            moved[places] = 0
            accessor["sparse"] = {
                "count": len(places),
                "indices": {"bufferView": self.view(places.tobytes()), "componentType": FORMATS["u2"]},
                "values": {"bufferView": self.view(values[places].tobytes())},
            }
            values = moved
        size = values.dtype.itemsize * width
        if width != 16 and (size % 4 or self.chance(0.3)):
            # Other bytes between the elements.
            stride = size + (-size % 4) + self.random.choice([0, 4, 8])
            padded = np.full((len(values), stride), 0xA5, np.uint8)
            padded[:, :size] = values.view(np.uint8).reshape(len(values), size)
            accessor["bufferView"] = self.view(padded.tobytes(), byteStride=stride)
        else:
            accessor["bufferView"] = self.view(values.tobytes())
        return self.add("accessors", accessor)

    def indices(self, faces):
        form = self.random.choice(["u1", "u2", "u4"] if faces.max() < 255 else ["u2", "u4"])
        data = faces.ravel().astype("<" + form)
        accessor = {
            "componentType": FORMATS[form],
            "count": data.size,
            "type": "SCALAR",
            "bufferView": self.view(data.tobytes()),
        }
        return self.add("accessors", accessor)

    # Materials.

    def texture(self, kind):
        """A reference to a texture of colours, numbers or normals."""
        size = self.random.choice([(4, 4), (8, 8), (5, 7)])
        state = np.random.RandomState(self.random.randrange(1 << 30))
        channels = 4 if kind == "opacity" else 3
        texels = state.rand(*size, channels)
        if kind == "normals":
            texels = np.concatenate([state.uniform(-0.2, 0.2, (*size, 2)), np.ones((*size, 1))], axis=2)
            texels = 0.5 + 0.5 * texels / np.linalg.norm(texels, axis=2, keepdims=True)
        image = {
            "bufferView": self.view(png((texels * 255).round().astype(np.uint8))),
            "mimeType": "image/png",
        }
        texture = {"source": self.add("images", image)}
        # Blender interpolates colours before it decodes them.
        is_encoded = kind in ("color", "opacity")
        if is_encoded or self.chance(0.7):
            wraps = {f"wrap{axis}": self.random.choice([10497, 33648, 33071]) for axis in "ST"}
            linear = 9728 if is_encoded else self.random.choice([9728, 9729])
            texture["sampler"] = self.add("samplers", wraps | {"magFilter": linear})
        reference = {"index": self.add("textures", texture)}
        if self.chance(0.5, "transform"):
            move = {
                "offset": self.numbers(2, -1, 1),
                "scale": self.numbers(2, -2.5, 2.5),
                "rotation": self.between(-3, 3),
            }
            for key in self.random.sample(sorted(move), self.random.randint(0, 2)):
                del move[key]
            reference["extensions"] = self.uses("KHR_texture_transform", move)
        if self.chance(0.4, "coordinates"):
            reference["texCoord"] = 1
        return reference

    def material(self, kind):
        base, look = {}, {"doubleSided": True, "extensions": {}}
        base["baseColorFactor"] = [*self.numbers(3, 0.1, 0.9), 1.0]
        if self.chance(0.5):
            base["baseColorTexture"] = self.texture("color")
        base["metallicFactor"], base["roughnessFactor"] = 0.0, 1.0
        specular = {"specularFactor": 0.0}
        if kind == "emission":
            look["emissiveFactor"] = self.numbers(3, 0.1, 1)
            if self.chance(0.7):
                look["emissiveTexture"] = self.texture("color")
            if self.chance(0.5):
                look["extensions"] |= self.uses("KHR_materials_emissive_strength", {"emissiveStrength": self.between(0.5, 6)})
            base["baseColorFactor"] = [0, 0, 0, 1]
        elif kind == "metal":
            base |= {"metallicFactor": 1.0, "roughnessFactor": self.between(0.1, 0.7)}
            if self.chance(0.3):
                base["metallicRoughnessTexture"] = self.texture("numbers")
        elif kind == "plastic":
            base["roughnessFactor"] = self.between(0.1, 1)
            specular = {"specularFactor": self.between(0.2, 1)}
            look["extensions"] |= self.uses("KHR_materials_ior", {"ior": self.between(1.2, 2)})
        elif kind == "glass":
            # Blender takes the square root of the colour.
            base |= {
                "roughnessFactor": self.random.choice([0.0, self.between(0.1, 0.5)]),
                "baseColorFactor": [1, 1, 1, 1],
            }
            base.pop("baseColorTexture", None)
            look["extensions"] |= self.uses("KHR_materials_transmission", {"transmissionFactor": self.between(0.6, 1)})
            look["extensions"] |= self.uses("KHR_materials_ior", {"ior": self.between(1.2, 1.8)})
            look["extensions"] |= self.uses("KHR_materials_volume", {"thicknessFactor": 1})
            specular = None
        elif kind == "coat":
            coat = {
                "clearcoatFactor": self.between(0.2, 1),
                "clearcoatRoughnessFactor": self.between(0.05, 0.5),
            }
            look["extensions"] |= self.uses("KHR_materials_clearcoat", coat)
        if specular:
            look["extensions"] |= self.uses("KHR_materials_specular", specular)
        if kind != "emission" and self.chance(0.3, "normals"):
            look["normalTexture"] = self.texture("normals")
        if kind in ("matte", "plastic", "metal") and self.chance(0.25, "opacity"):
            look["alphaMode"] = self.random.choice(["MASK", "BLEND", "OPAQUE"])
            base["baseColorTexture"] = self.texture("opacity")
            base["baseColorFactor"][3] = self.between(0.5, 1)
            look |= {"alphaCutoff": self.between(0.2, 0.7)} if look["alphaMode"] == "MASK" and self.chance(0.7) else {}
        return self.add("materials", look | {"pbrMetallicRoughness": base})

    # Meshes and nodes.

    def mesh(self, material, is_closed, bends, skin=False):
        """A mesh, and what its node must have."""
        kind = self.random.choice([ball, cube] if is_closed else [ball, cube, sheet, strip, fan])
        points, normals, uv, *faces = kind()
        place, attributes = {}, {}
        if self.chance(0.25, "quantized"):
            # A quantized position is moved to its place by its node.
            form = self.random.choice(["i2", "i1", "u2"])
            attributes["POSITION"] = self.accessor((points + (form == "u2")) * (0.5 if form == "u2" else 0.9), form, True)
            place = {"scale": [2] * 3, "translation": [-1] * 3} if form == "u2" else {"scale": [1 / 0.9] * 3}
            self.uses("KHR_mesh_quantization", {})
        else:
            attributes["POSITION"] = self.accessor(points, sparse=self.chance(0.2, "sparse"))
        quantized = self.chance(0.25, "quantized")
        if quantized:
            self.uses("KHR_mesh_quantization", {})
        attributes["NORMAL"] = self.accessor(normals, "i1" if quantized else "f4", quantized)
        form = self.random.choice(["f4", "u1", "u2"])
        attributes["TEXCOORD_0"] = self.accessor(uv, form, form != "f4")
        attributes["TEXCOORD_1"] = self.accessor(uv[:, ::-1] * 1.5 + 0.25)
        if not is_closed and self.chance(0.25, "colors"):
            state = np.random.RandomState(self.random.randrange(1 << 30))
            form = self.random.choice(["f4", "u1", "u2"])
            attributes["COLOR_0"] = self.accessor(state.rand(len(points), 3), form, form != "f4")
        primitive = {"attributes": attributes, "material": material, "mode": {strip: 5, fan: 6}.get(kind, 4)}
        if faces:
            primitive["indices"] = self.indices(faces[0])
        mesh = {"primitives": [primitive]}
        # Blender bends normals with surfaces.
        if bends and not place and self.chance(0.3, "morph"):
            count = self.random.randint(1, 2)
            state = np.random.RandomState(self.random.randrange(1 << 30))
            shifts = [points * state.uniform(-0.4, 0.4, 3) + 0.2 * np.sin(3 * points[:, [1, 2, 0]]) for _ in range(count)]
            primitive["targets"] = [{"POSITION": self.accessor(shift, sparse=self.chance(0.3, "sparse"))} for shift in shifts]
            mesh["weights"] = self.numbers(count, -0.5, 1)
        if skin:
            weights = np.clip((points[:, 1:2] + 1) / 2, 0, 1)
            form = self.random.choice(["f4", "u1", "u2"])
            if form != "f4":
                most = {"u1": 255, "u2": 65535}[form]
                weights = np.round(weights * most) / most
            filled = np.concatenate([1 - weights, weights, 0 * weights, 0 * weights], axis=1)
            attributes["WEIGHTS_0"] = self.accessor(filled, form, form != "f4")
            attributes["JOINTS_0"] = self.accessor(np.tile([0, 1, 0, 0], (len(points), 1)), self.random.choice(["u1", "u2"]))
        return self.add("meshes", mesh), place

    def quaternion(self):
        values = np.array([self.random.gauss(0, 1) for _ in range(4)])
        return (values / np.linalg.norm(values)).tolist()

    def placed(self, children, place, size):
        """A node at a place, with others between it and its children."""
        scale = [size * self.between(0.6, 1.2) * (-1 if self.chance(0.1, "mirrored") else 1) for _ in range(3)]
        node = {"children": children, "rotation": self.quaternion(), "scale": scale}
        if self.chance(0.4, "matrix"):
            x, y, z, w = node.pop("rotation")
            turn = np.array(
                [
                    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
                ]
            )
            matrix = np.eye(4)
            matrix[:3, :3] = turn * node.pop("scale")
            matrix[:3, 3] = place
            node["matrix"] = matrix.T.ravel().tolist()
        else:
            node["translation"] = list(place)
        index = self.add("nodes", node)
        if "matrix" not in node and self.chance(0.7 if self.is_smooth else 0.3, "animations"):
            path = self.random.choice(["translation", "scale", "rotation"])
            if path == "rotation":
                keys = [self.near(node[path]) if self.is_smooth else self.quaternion() for _ in range(4)]
            else:
                keys = [[x + self.between(-0.4, 0.4) for x in node[path]] for _ in range(4)]
            self.animate(index, path, np.array(keys), "STEP" if path == "rotation" else None)
        return index

    def near(self, quaternion):
        """A rotation that is another by half a radian or less."""
        moved = np.array(quaternion) + [self.random.uniform(-0.12, 0.12) for _ in range(4)]
        return (moved / np.linalg.norm(moved)).tolist()

    def animate(self, node, path, keys, interpolation=None):
        """Blender interpolates quaternions component by component."""
        self.animate_target({"node": node, "path": path}, keys, interpolation)

    def animate_property(self, pointer, *keys, interpolation=None):
        """By four keys, each a number or a list."""
        extensions = self.uses("KHR_animation_pointer", {"pointer": pointer})
        self.animate_target({"path": "pointer", "extensions": extensions}, np.array(keys, float), interpolation)

    def animate_target(self, target, keys, interpolation=None):
        """Four keys at random times."""
        drawn = interpolation or self.random.choice(["STEP", "LINEAR"])
        interpolation = "LINEAR" if self.is_smooth else drawn
        times = np.sort(np.array(self.random.sample(range(90), 4)) / 100)
        sampler = {
            "input": self.accessor(times),
            "output": self.accessor(keys),
            "interpolation": interpolation,
        }
        if not self.json["animations"]:
            self.json["animations"].append({"samplers": [], "channels": []})
        animation = self.json["animations"][0]
        animation["samplers"].append(sampler)
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})

    def thing(self, place, kind):
        is_closed = kind == "glass"
        material = self.material(kind)
        size = self.between(0.4, 0.7)
        skin = kind == "emission" and self.chance(0.15, "skin")
        mesh, own = self.mesh(material, is_closed, kind == "emission", skin)
        if skin:
            joints = [self.add("nodes", {"rotation": self.quaternion()} if self.chance(0.5) else {}) for _ in range(2)]
            self.json["nodes"][joints[1]] |= {"translation": self.numbers(3, -0.4, 0.4)}
            self.roots += [self.placed(joints, place, size)]
            inverse = [np.eye(4).ravel()] * 2
            if own:
                matrix = np.diag([*own["scale"], 1.0])
                matrix[:3, 3] = own.get("translation", [0] * 3)
                inverse = [matrix.T.ravel()] * 2
            skin = {"joints": joints, "inverseBindMatrices": self.accessor(np.array(inverse))}
            self.roots.append(self.add("nodes", {"mesh": mesh, "skin": self.add("skins", skin)}))
            return
        node = {"mesh": mesh, **own}
        weights = self.json["meshes"][mesh].get("weights", [])
        if weights:
            if self.chance(0.4):
                node["weights"] = self.numbers(len(weights), -0.5, 1)
            if self.chance(0.3, "animations"):
                # Blender's weights in animations are not negative.
                keys = np.array(self.numbers(4 * len(weights), 0, 1))
                self.animate(len(self.json["nodes"]), "weights", keys)
        elif self.chance(0.15, "instances") and not is_closed:
            count = 3
            attributes = {
                "TRANSLATION": self.accessor(np.array([self.numbers(3, -1.5, 1.5) for _ in range(count)])),
                "ROTATION": self.accessor(np.array([self.quaternion() for _ in range(count)])),
                "SCALE": self.accessor(np.array([self.numbers(3, 0.4, 0.8) for _ in range(count)])),
            }
            for key in self.random.sample(sorted(attributes), self.random.randint(0, 2)):
                del attributes[key]
            if not own:
                node["extensions"] = self.uses("EXT_mesh_gpu_instancing", {"attributes": attributes})
        children = [self.add("nodes", node)]
        self.roots.append(self.placed(children, place, size))

    def quad(self, material, corners):
        points = np.array(corners, float)
        normal = np.cross(points[1] - points[0], points[3] - points[0])
        normals = np.tile(normal / np.linalg.norm(normal), (4, 1))
        attributes = {
            "POSITION": self.accessor(points),
            "NORMAL": self.accessor(normals),
            "TEXCOORD_0": self.accessor(np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * 2.0),
            "TEXCOORD_1": self.accessor(np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * 1.0),
        }
        primitive = {
            "attributes": attributes,
            "material": material,
            "indices": self.indices(np.array([0, 1, 2, 0, 2, 3])),
        }
        mesh = self.add("meshes", {"primitives": [primitive]})
        self.roots.append(self.add("nodes", {"mesh": mesh}))

    def looking(self, eye, target):
        """A node whose −z axis looks at a point."""
        back = np.array(eye, float) - target
        back /= np.linalg.norm(back)
        right = np.cross([0, 1, 0.01], back)
        right /= np.linalg.norm(right)
        matrix = np.eye(4)
        matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = right, np.cross(back, right), back, eye
        return {"matrix": matrix.T.ravel().tolist()}

    def light(self):
        place = [self.between(-3, 3), self.between(3.5, 4.5), self.between(-1, 3)]
        kind = self.random.choice(["point", "directional", "spot", "quad", "quad"])
        if kind == "quad":
            strength = self.uses("KHR_materials_emissive_strength", {"emissiveStrength": self.between(8, 20)})
            black = {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0.0}
            look = {
                "emissiveFactor": self.numbers(3, 0.5, 1),
                "extensions": strength,
                "pbrMetallicRoughness": black,
            }
            look["extensions"] |= self.uses("KHR_materials_specular", {"specularFactor": 0.0})
            x, y, z = place
            size = self.between(0.3, 0.9)
            corners = [[x + a * size, y, z + b * size] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            self.quad(self.add("materials", {**look, "doubleSided": True}), corners)
            return
        light = {
            "type": kind,
            "color": self.numbers(3, 0.5, 1),
            "intensity": self.between(1, 3) if kind == "directional" else self.between(15, 40),
        }
        if kind == "spot":
            outer = self.between(0.4, 0.8)
            light["spot"] = {"outerConeAngle": outer, "innerConeAngle": outer - 0.001}
        self.lights.append(light)
        node = self.looking(place, [self.between(-1, 1), 0, 0])
        node["extensions"] = self.uses("KHR_lights_punctual", {"light": len(self.lights) - 1})
        self.roots.append(self.add("nodes", node))

    def camera(self):
        eye = [self.between(-3, 3), self.between(1.5, 4), 6.0]
        if self.chance(0.7):
            view = {
                "yfov": self.between(0.6, 0.8),
                "aspectRatio": ASPECT,
                "znear": 0.01,
                "zfar": 100.0,
            }
            camera = {"type": "perspective", "perspective": view}
        else:
            camera = {
                "type": "orthographic",
                "orthographic": {"xmag": 3.2, "ymag": 2.4, "znear": 0.01, "zfar": 100.0},
            }
        node = self.add("nodes", {**self.looking(eye, [0, 0.6, 0]), "camera": self.add("cameras", camera)})
        if self.is_smooth and self.chance(0.4):
            above = self.add("nodes", {"children": [node]})
            self.animate(above, "translation", np.array([self.numbers(3, -0.3, 0.3) for _ in range(4)]))
            node = above
        self.roots.append(node)

    def scene(self, kind=None):
        self.camera()
        floor = self.material("matte")
        self.quad(floor, [[-5, -0.2, 5], [5, -0.2, 5], [5, -0.2, -5], [-5, -0.2, -5]])
        places = [(-1.8, 0.6, 0), (0, 0.7, -1), (1.8, 0.6, 0.3), (-0.8, 0.5, 1.8), (1, 0.5, 1.9)]
        for place in self.random.sample(places, self.random.randint(2, 5)):
            self.thing(place, kind or self.random.choice(KINDS))
        for _ in range(self.random.randint(1, 2)):
            self.light()
        if self.chance(0.5, "pointers") and not self.is_smooth:
            self.animate_properties()

    def animate_properties(self):
        """Of a material, lights and the camera. Blender moves one material only, takes intensities for others, interpolates
        the focal length, and ends at most other pointers."""
        shining = [index for index, look in enumerate(self.json["materials"]) if "emissiveFactor" in look]
        if shining:
            index = self.random.choice(shining)
            self.animate_property(f"/materials/{index}/emissiveFactor", *(self.numbers(3, 0.1, 1) for _ in range(4)))
        for index in range(len(self.lights)):
            if self.chance(0.5):
                pointer = f"/extensions/KHR_lights_punctual/lights/{index}/color"
                self.animate_property(pointer, *(self.numbers(3, 0.3, 1) for _ in range(4)))
        if "perspective" in self.json["cameras"][0] and self.chance(0.4):
            self.animate_property("/cameras/0/perspective/yfov", *self.numbers(4, 0.5, 0.9), interpolation="STEP")

    def write(self, path):
        self.json["scenes"] = [{"nodes": self.roots}]
        self.json["buffers"] = [{"byteLength": len(self.data)}]
        if self.lights:
            self.json["extensions"] = {"KHR_lights_punctual": {"lights": self.lights}}
        written = {key: value for key, value in self.json.items() if value not in ([], {})}
        text = json.dumps(written).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.data) + bytes(-len(self.data) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
