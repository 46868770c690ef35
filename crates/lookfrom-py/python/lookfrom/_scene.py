"""Scenes as plain data."""

from __future__ import annotations

import copy
import io
import itertools
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _arrays, _toml
from ._colors import linear
from ._lookfrom import Error, replace_files

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# The lists of a mesh, with their types and numbers in a row.
_LISTS = {
    "positions": (np.float32, 3),
    "triangles": (np.uint32, 3),
    "normals": (np.float32, 3),
    "uvs": (np.float32, 2),
    "colors": (np.float32, 3),
}
# Keys whose values are names of images, and of any files.
_IMAGES = ("file", "image", "normal_map", "aperture_shape")
_FILES = (*_IMAGES, "import", "npy", "spd", "font", "lens")


class Scene:
    """A scene as plain data, in the words of the scene format (docs/guide/scene-format.md).

    data: a dictionary of the tables of a scene file: `{"camera": {...}, "materials": {"red": {...}}, "sphere": [{...}], ...}`.
        The scene keeps a copy of it. Lists of meshes (positions, triangles, normals, uvs, colors), images (a texture's `file`,
        a light's `image`, a `normal_map`), matrices of shape (4, 4) and other lists of numbers may be arrays: of numpy, or those
        that it reads, such as tensors of PyTorch. Colours and images of uint8 are sRGB.
    folder: the folder to which names of files are relative; the current one by default.

    Everything is in `data`, which may be changed at will; what a renderer makes of it is told when it is opened, by Session or
    `render`, with the line of the text that `to_toml` makes. Scenes can be compared, copied and pickled.

    ```python
    scene = lookfrom.Scene()
    scene.material("red", type="diffuse", reflectance=[0.8, 0.1, 0.1])
    scene.mesh(vertices, faces, material="red")
    scene.light(type="environment", color=1)
    lookfrom.render(scene, size=256).save("mesh.png")
    ```
    """

    data: dict[str, Any]
    folder: Path

    def __init__(self, data: Mapping[str, Any] | None = None, *, folder: str | os.PathLike[str] = "") -> None:
        self.data = copy.deepcopy(dict(data or {}))
        self.folder = Path(folder)

    @classmethod
    def from_toml(cls, text: str, *, folder: str | os.PathLike[str] = "") -> Scene:
        """The scene of a text in the scene format. Raises Error where it is no TOML."""
        try:
            return cls(tomllib.loads(text), folder=folder)
        except tomllib.TOMLDecodeError as error:
            raise Error(f"this text is no TOML: {error}") from error

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scene:
        """The scene of a .toml file. Arrays in .npy files stay there."""
        path = Path(path)
        return cls.from_toml(path.read_text(encoding="utf-8"), folder=path.parent)

    def to_toml(self) -> str:
        """The scene as text, from which `from_toml` makes an equal one: arrays are written out.

        Raises TypeError for what TOML cannot say, and Error for an image that is an array, which a text cannot hold.
        """
        return _toml.document(written(self.data))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a .toml file; arrays are .npy, .ppm and .pfm files beside it, named after it. Names of files that are relative to
        the scene's folder become relative to that of the new file. Files that were there stay until all new ones are on the disk.

        Raises Error for another extension, and OSError where files cannot be written.
        """
        path = Path(path)
        if path.suffix != ".toml":
            raise Error(f"a scene is written as .toml, but the name of the file is {path.name!r}")
        files: dict[str, bytes] = {}
        data = _rebased(self.data, self.folder, path.parent)
        text = _toml.document(_with_files(data, f"{path.stem}-", files))
        beside = [(path.parent / name, content) for name, content in files.items()]
        replace_files([*beside, (path, text.encode())])

    def add(self, kind: str, **words: Any) -> dict[str, Any]:
        """Adds a table to a list of tables, such as a `sphere`, `mesh`, `light` or `instance`, and returns it."""
        table = copy.deepcopy(words)
        self.data.setdefault(kind, []).append(table)
        return table

    def material(self, name: str, **words: Any) -> str:
        """Adds a material, or replaces the one of this name, and returns its name."""
        self.data.setdefault("materials", {})[name] = copy.deepcopy(words)
        return name

    def texture(self, name: str, **words: Any) -> str:
        """Adds a texture, or replaces the one of this name, and returns its name. Its `file` may be an array: float of shape
        (h, w, 3) or (h, w) in linear light, or uint8 in sRGB."""
        self.data.setdefault("textures", {})[name] = copy.deepcopy(words)
        return name

    def light(self, **words: Any) -> dict[str, Any]:
        """Adds a light."""
        return self.add("light", **words)

    def camera(self, **words: Any) -> None:
        """Sets words of the camera."""
        self.data.setdefault("camera", {}).update(copy.deepcopy(words))

    def mesh(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        **words: Any,
    ) -> dict[str, Any]:
        """Adds a triangle mesh.

        vertices: shape (n, 3). They are rounded to float32 around their middle, which is kept as `translate`, so that a mesh far
            from the origin keeps its details; not where `words` has a transform.
        faces: shape (m, 3), integers.
        normals, uvs, colors: one for each vertex: shapes (n, 3), (n, 2), (n, 3); colours are linear, or sRGB of
            uint8, for the texture "vertex_color". Without a material, a mesh with colours is painted by them.
        words: further words of `[[mesh]]`, such as material="red".
        """
        positions = _arrays.vectors(vertices, "vertices").astype(np.float64).reshape(-1, 3)
        if not any(word in words for word in ("translate", "rotate", "scale", "transform", "matrix", "axis")):
            middle = _middle(positions)
            if middle is not None:
                positions = positions - middle
                words["translate"] = middle.tolist()
        lists = {"positions": positions, "triangles": faces, "normals": normals, "uvs": uvs, "colors": colors}
        given = {name: _rows(name, value) for name, value in lists.items() if value is not None}
        if colors is not None and "material" not in words:
            words["material"] = self.material(
                "vertex colors", type="diffuse", reflectance={"type": "vertex_color"}
            )
        return self.add("mesh", **given, **words)

    def trimesh(self, mesh: Any, **words: Any) -> dict[str, Any]:
        """Adds a mesh of trimesh, with its colours and texture coordinates where it has them."""
        visual: Any = getattr(mesh, "visual", None)
        colors, uvs = None, None
        if getattr(visual, "kind", None) in ("vertex", "face"):
            colors = linear(np.asarray(visual.vertex_colors, np.uint8))
        elif getattr(visual, "uv", None) is not None and len(visual.uv) == len(mesh.vertices):
            uvs = visual.uv
        return self.mesh(mesh.vertices, mesh.faces, colors=colors, uvs=uvs, **words)

    def points(
        self, points: ArrayLike, radius: float, *, colors: ArrayLike | None = None, **words: Any
    ) -> None:
        """Adds a point cloud as spheres; colors: linear, or sRGB of uint8, shape (n, 3), each of which becomes a material."""
        centers = _arrays.vectors(points, "points").astype(np.float64).reshape(-1, 3)
        painted: NDArray[np.float64] | None = None
        if colors is not None:
            painted = _numbers("colors", np.asarray(colors)).astype(np.float64).reshape(-1, 3)
        if painted is not None and len(painted) != len(centers):
            raise Error(f"colors has {len(painted)} rows, but there are {len(centers)} points")
        for index, center in enumerate(centers):
            if painted is not None:
                red, green, blue = painted[index].tolist()
                name = f"point {red:.6g} {green:.6g} {blue:.6g}"
                words["material"] = self.material(name, type="diffuse", reflectance=[red, green, blue])
            self.add("sphere", center=center.tolist(), radius=float(radius), **words)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and _plain(self.data) == _plain(other.data)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        counts = {
            key: len(item) if isinstance(item, Sequence | Mapping) else 1 for key, item in self.data.items()
        }
        return f"Scene({', '.join(f'{key}: {count}' for key, count in counts.items())})"

    def _in_memory(self) -> tuple[str, dict[str, bytes]]:
        """The name of the scene's file, and all files in memory by name: the text, and arrays."""
        files: dict[str, bytes] = {}
        # Of names that no file is likely to have.
        text = _toml.document(_with_files(self.data, "in memory/", files))
        name = os.fspath(self.folder / _unused("scene", ".toml", _texts(self.data)))
        beside = {os.fspath(self.folder / file): content for file, content in files.items()}
        return name, {name: text.encode(), **beside}


def _rows(name: str, value: ArrayLike) -> NDArray[Any]:
    kind, columns = _LISTS[name]
    array: NDArray[Any] = np.asarray(value)
    if array.ndim != 2 or array.shape[1] != columns or array.dtype.kind not in "fiu":
        raise Error(
            f"{name} is an array of {array.dtype} of shape {array.shape}, but (n, {columns}) numbers are expected"
        )
    if kind is np.uint32:
        if array.dtype.kind == "f" or (array.size > 0 and (array.min() < 0 or array.max() >= 2**32)):
            raise Error(f"{name} must be integers from 0 to 2**32 - 1")
    return _numbers(name, array).astype(kind)


def _numbers(key: str, array: NDArray[Any]) -> NDArray[Any]:
    """The numbers of an array as the scene format has them: linear light, where colours of uint8 are sRGB."""
    if key != "colors":
        return array
    if array.dtype == np.uint8 and array.shape[1:] == (3,):
        return linear(array)
    if array.dtype.kind in "iu" and array.size > 0 and array.max() > 1:
        raise Error(
            f"colors is an array of {array.dtype} with numbers up to {array.max()}: colours are linear light, or sRGB of uint8"
        )
    return array


def _middle(positions: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The middle of points that are far from the origin for their size; None for others, and where some are not finite."""
    if len(positions) == 0 or not np.isfinite(positions).all():
        return None
    low, high = positions.min(axis=0), positions.max(axis=0)
    middle = np.asarray((low + high) / 2, np.float64)
    return middle if np.abs(middle).max() > 16 * (high - low).max() else None


def _map(item: Any, array: Any, text: Any = lambda key, item: item, key: str = "") -> Any:
    """A copy of plain data, with each array and text replaced by what `array(key, array)` and `text(key, text)` make of it."""
    if _arrays.is_array(item):
        return array(key, np.asarray(item))
    if isinstance(item, str):
        return text(key, item)
    if isinstance(item, Mapping):
        return {name: _map(part, array, text, name) for name, part in item.items()}
    if isinstance(item, list | tuple):
        return [_map(part, array, text, key) for part in item]
    return item


def _listed(key: str, array: NDArray[Any]) -> Any:
    """The numbers of an array as a text has them: matrices row by row."""
    if key == "transform" and array.shape == (4, 4):
        return [{"matrix": array.reshape(16).tolist()}]
    if key in ("matrix", "motion") and array.shape[-2:] == (4, 4):
        array = array.reshape(*array.shape[:-2], 16)
    return _numbers(key, array).tolist()


def _plain(data: Mapping[str, Any]) -> Any:
    return _map(data, _listed)


def written(data: Mapping[str, Any]) -> Any:
    """The data without arrays. Raises Error for an image that is one."""

    def listed(key: str, array: NDArray[Any]) -> Any:
        if key in _IMAGES:
            raise Error(
                "an image that is an array cannot be written into a text: Scene.save writes it as a file"
            )
        return _listed(key, array)

    return _map(data, listed)


def _texts(data: Mapping[str, Any]) -> set[str]:
    """All texts among the values: names of files are some of them."""
    texts: set[str] = set()
    _map(data, lambda key, array: None, lambda key, text: texts.add(os.path.normpath(text)))
    return texts


def _unused(start: str, end: str, used: set[str]) -> str:
    """A name for a file that no other one has: `start` and `end`, with a number between them if need be."""
    names = itertools.chain([start + end], (f"{start}-{number}{end}" for number in itertools.count(1)))
    return next(name for name in names if os.path.normpath(name) not in used)


def _rebased(data: Mapping[str, Any], old: Path, new: Path) -> Any:
    """The data with names of files that are relative to one folder as names that are relative to another one."""
    here, there = os.path.realpath(old), os.path.realpath(new)
    if here == there:
        return data

    def rebased(text: str) -> str:
        # Words for shapes of apertures have no suffix; some texts of variables cannot be names, as they have zeros in them.
        if not Path(text).suffix or os.path.isabs(text) or "\0" in text:
            return text
        file = os.path.join(here, text)
        if not os.path.isfile(file):
            return text
        try:
            return Path(os.path.relpath(file, there)).as_posix()
        except ValueError:
            # On another drive of Windows.
            return Path(file).as_posix()

    def kept(_: str, array: NDArray[Any]) -> NDArray[Any]:
        return array

    moved = _map(data, kept, lambda key, text: rebased(text) if key in _FILES else text)
    if "variables" in data:
        # Any of them may be a name.
        moved["variables"] = _map(data["variables"], kept, lambda _, text: rebased(text))
    return moved


def _with_files(data: Mapping[str, Any], start: str, files: dict[str, bytes]) -> Any:
    """The data with arrays as files, which are added to `files` by name. The names are numbers after `start`, but none that the
    data have for other files."""
    used = _texts(data)
    numbers = itertools.count()

    def added(extension: str, content: bytes) -> str:
        names = (f"{start}{number}.{extension}" for number in numbers)
        name = next(name for name in names if os.path.normpath(name) not in used)
        files[name] = content
        return name

    def filed(key: str, array: NDArray[Any]) -> Any:
        if key in _IMAGES:
            return added(*image_file(array))
        if key in _LISTS and array.ndim == 2:
            buffer = io.BytesIO()
            np.save(buffer, _rows(key, array))
            return {"npy": added("npy", buffer.getvalue())}
        return _listed(key, array)

    return _map(data, filed)


def image_file(image: ArrayLike) -> tuple[str, bytes]:
    """The extension and the bytes of a file of an image: linear light of floats of shape (h, w, 3) or (h, w), or sRGB of uint8.

    Raises Error for other arrays.
    """
    array: NDArray[Any] = np.asarray(image)
    if array.ndim == 2:
        array = np.repeat(array[:, :, None], 3, axis=2)
    if (
        array.ndim != 3
        or array.shape[2] != 3
        or array.size == 0
        or (array.dtype.kind != "f" and array.dtype != np.uint8)
    ):
        raise Error(
            f"an image is an array of {array.dtype} of shape {array.shape}, but floats or uint8 of shape (h, w, 3) are expected"
        )
    height, width, _ = array.shape
    if array.dtype == np.uint8:
        return "ppm", b"P6\n%d %d\n255\n" % (width, height) + array.tobytes()
    # Rows from the bottom; the sign says that the numbers are in little-endian order.
    return "pfm", b"PF\n%d %d\n-1.0\n" % (width, height) + array[::-1].astype("<f4").tobytes()
