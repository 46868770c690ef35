"""Sessions: a scene that is read once and rendered as often as one likes."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Collection, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from . import _arrays, _lookfrom, _toml
from ._arrays import is_array
from ._camera import Camera, Convention
from ._inspect import Inspection, PixelInspection, from_json
from ._labels import Labels
from ._lookfrom import Error
from ._picture import Film, Picture
from ._scene import Scene, image_file, written
from ._words import words

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from ._words import Options

Edits: TypeAlias = dict[tuple[str, str | int], tuple[Any, ...]]

# Called with the samples so far and in all, of all pixels.
Progress = Callable[[int, int], object]


# Options whose change depends on what they were: it is simplest to read the scene again.
_OF_BEFORE = frozenset({"fireflies", "light_path", "part"})
# Options that frame the scene: where they change, nothing stays of another camera.
_OF_VIEW = frozenset({"azimuth", "bounds", "camera", "elevation", "view"})
_OF_PLACE = frozenset({"lookfrom", "lookat", "up"})
_OF_CAMERA = _OF_PLACE | {"fov"}
_OF_SIZE = frozenset({"size", "width", "height", "crop"})
# Options that also decide how a scene is framed, lit and denoised when it is read; later they change the picture alone.
_OF_PICTURE = _OF_CAMERA | _OF_SIZE | {"integrator"}
# The part of the scene that `set_camera` changes.
_CAMERA = ("set_camera", "")


class SceneWarning(UserWarning):
    """A scene is rendered, but the picture may differ from what its file means."""


class Session:
    """A scene that is read and compiled once, to be rendered with any camera and settings.

    scene: the name of a scene or model (.toml, .pbrt, .xml, .gltf, .glb, .obj, .ply, .stl, .hair, .vdb), a Scene, a dictionary in
        its words, a mesh of trimesh, or the bytes of a self-contained file, whose format `name` tells ("model.glb").
    keep: whether the session keeps the scene beside what is compiled, so that `set_material` and `set_lights` can change it; it
        takes the memory of its meshes once more.
    options: those of the command `lookfrom render`: see `Options` and `lookfrom.options()`. `environment` may also be an array,
        float of shape (h, w, 3).

    Raises SceneError, which has file, line and column, where the scene cannot be read or the options do not suit it; Error for
    options that do not exist or make no sense. What the readers doubt is a SceneWarning.

    A session may be used by several threads at once, and after a fork. It can be copied (copies share memory) and pickled (it is
    read again): the pictures are the same.
    """

    def __init__(self, scene: Any, *, name: str = "", keep: bool = False, **options: Unpack[Options]) -> None:
        self._source = _source(scene, name)
        self._keep = keep
        # Those that the scene is read with, and those of `_OF_PICTURE` that were given later.
        self._options: dict[str, Any] = dict(options)
        self._changes: dict[str, Any] = {}
        # The last call that changed each part of the scene, by the part: for where the scene is read again.
        self._edits: Edits = {}
        self._native = self._opened(self._options)
        self._warn(())

    def _warn(self, known: Collection[str]) -> None:
        for text in self.warnings:
            if text not in known:
                warnings.warn(text, SceneWarning, stacklevel=3)

    def _opened(
        self, options: Mapping[str, Any], *changes: Mapping[str, Any], edits: Edits | None = None
    ) -> _lookfrom.Session:
        """The scene, read with some options and then changed by others, one after the other."""
        path, files = self._source
        given = dict(options)
        if is_array(given.get("environment")):
            extension, content = image_file(given["environment"])
            given["environment"] = f"environment.{extension}"
            files = {**files, given["environment"]: content}
        native = _lookfrom.Session(path, files, words(given), self._keep)
        for (name, _), arguments in (self._edits if edits is None else edits).items():
            getattr(native, name)(*arguments)
        for change in changes:
            given = _merged(given, change)
            native.change(words(change), words(given))
        return native

    def _edit(self, name: str, *arguments: Any) -> None:
        if not self._keep:
            raise Error(
                "this session does not keep its scene, so that it cannot be changed: make it with keep=True"
            )
        getattr(self._native, name)(*arguments)
        self._edits.update(self._parts(name, arguments))

    @staticmethod
    def _parts(name: str, arguments: tuple[Any, ...]) -> dict[tuple[str, str | int], tuple[Any, ...]]:
        """What a call changes, each part by itself."""
        if name == "set_poses":
            return {(name, number): ([(number, pose)],) for number, pose in arguments[0]}
        return {(name, arguments[0] if name == "set_material" else ""): arguments}

    def render(self, *, progress: bool | Progress = False, film: Film | None = None) -> Picture:
        """Renders the picture.

        progress: True for a bar, where tqdm is installed; or a function that is called with the samples so far and in all,
            several times a second.
        film: a film of this session's picture (which needs film=True), whose samples are not rendered again.

        The GIL is released. Ctrl-C stops it: the KeyboardInterrupt has the picture of the samples so far as `picture`. An
        exception of `progress` does the same. Raises SceneError where there is not enough memory.
        """
        native = None if film is None else film._native
        if progress is True:
            with _Bar() as bar:
                return _finished(lambda: self._native.render(native, bar))
        return _finished(lambda: self._native.render(native, progress or None))

    def set(self, **options: Unpack[Options]) -> None:
        """Changes options; others stay, as does the camera, however it was found. Nothing is read or built for another size, crop,
        samples, camera (lookfrom, lookat, up, fov), exposure, tonemap, background, integrator, depth, seed, filter, layers, noise
        or time; for others the scene is read again. Where they frame it (view, azimuth, elevation, bounds, camera), all is as
        if given from the start.

        Raises as Session; then nothing has changed.
        """
        given: dict[str, Any] = dict(options)
        late = {name: value for name, value in given.items() if name in _OF_PICTURE}
        early = {name: value for name, value in given.items() if name not in _OF_PICTURE}
        read, before, edits = _merged(self._options, early), self._changes, self._edits
        is_framed, is_turned = not _OF_VIEW.isdisjoint(given), given.get("turn") is not None
        if is_framed:
            read, before, late = _merged(_merged(read, before), late), {}, {}
        elif is_turned:
            # The camera is that of the turntable.
            before = {name: value for name, value in before.items() if name not in _OF_CAMERA}
        if is_framed or is_turned:
            edits = {part: edit for part, edit in edits.items() if part != _CAMERA}
        changed = dict(given)
        if given.get("time") is not None or given.get("noise") is not None:
            # A limit alone replaces the number of samples, but not one that was asked for.
            changed.setdefault("samples", read.get("samples"))
        has_array = is_array(given.get("environment"))
        is_of_before = not _OF_BEFORE.isdisjoint(given)
        # What was given before cannot be taken back without reading.
        taken_back = {name: None for name, value in given.items() if value is None or value is False}
        everything = _merged(_merged(read, before), late)
        if is_array(everything.get("environment")):
            # No words open such a session again.
            del everything["environment"]
        all_words = words(everything)
        is_read = has_array or is_of_before or bool(taken_back)
        if is_read or self._native.change(words(changed), all_words) is not None:
            read, before = _merged(read, taken_back), _merged(before, taken_back)
            known = self.warnings
            self._native = self._opened(read, before, late, edits=edits)
            self._warn(known)
        self._options, self._changes, self._edits = read, _merged(before, late), edits
        if not _OF_SIZE.isdisjoint(self._changes):
            # As they are now: one side alone keeps the aspect ratio that there was, and a crop its part of the picture.
            self._changes = _merged(self._changes, {"size": self.size, "crop": self._native.crop()})

    def set_material(self, material: str, **words: Any) -> None:
        """Replaces a material of this name, by the words of `[materials.NAME]`: set_material("paint", type="diffuse",
        reflectance=0.5).

        Only what depends on materials is compiled again, no tree is built. Raises Error for a name that no material has, and
        SceneError for words that make no material, and for textures, which a session cannot be given. Needs keep=True.
        """
        self._edit("set_material", material, _toml.document(written({"materials": {material: words}})))

    def set_lights(self, lights: Iterable[Mapping[str, Any]]) -> None:
        """Replaces all lights that are no shapes, the studio of a model included, by the words of `[[light]]`. As
        `set_material`."""
        self._edit("set_lights", _toml.document(written({"light": [dict(light) for light in lights]})))

    def set_poses(self, poses: Mapping[int, ArrayLike]) -> None:
        """Moves instances, by their numbers in the scene's `instance` list from 0.

        poses: for each a matrix of shape (4, 4), from the object's space to the world; the last row is 0 0 0 1.

        The trees of objects stay, only the one over the instances is built again. Needs keep=True. Raises Error for numbers that
        no instance has, and matrices that are not affine or have no inverse.
        """
        moved: list[tuple[int, list[list[float]]]] = []
        for number, matrix in poses.items():
            rows = np.asarray(matrix, np.float64)
            if rows.shape != (4, 4) or not np.isfinite(rows).all() or (rows[3] != [0, 0, 0, 1]).any():
                raise Error(f"pose {number} is not a finite affine matrix of shape (4, 4): {rows.tolist()}")
            if number < 0:
                raise Error(f"there is no instance {number}; they are counted from 0")
            moved.append((int(number), rows.tolist()))
        self._edit("set_poses", moved)

    def set_camera(
        self,
        world_from_camera: ArrayLike,
        *,
        intrinsics: ArrayLike | None = None,
        convention: Convention = "opencv",
    ) -> None:
        """Moves the camera by matrices, as real cameras that were calibrated have them. Nothing is read or built.

        world_from_camera: rotation and translation, shape (4, 4), as of `Camera.world_from_camera`.
        intrinsics: the focal lengths and the principal point in pixels of the picture as large as it is now, shape (3, 3), without
            skew, as of `Camera.intrinsics`: the upper left corner is at (0, 0), as in COLMAP. Where the middle of the first pixel
            is there, as in OpenCV, add 0.5 to the principal point. Without them, what the camera sees stays as large.
        convention: the camera's axes: see `Camera.extrinsics`.

        Raises Error for other matrices.
        """
        place = _arrays.numbers(world_from_camera, "world_from_camera").astype(np.float64)
        if place.shape != (4, 4) or not np.isfinite(place).all() or (place[3] != [0, 0, 0, 1]).any():
            raise Error(
                f"world_from_camera is {place.tolist()}, but a finite affine matrix of shape (4, 4) is expected"
            )
        axes = place[:3, :3]
        if np.abs(axes.T @ axes - np.eye(3)).max() > 1e-4 or np.linalg.det(axes) < 0:
            raise Error(f"the axes of world_from_camera are {axes.tolist()}, but a rotation is expected")
        _arrays.one_of(convention, "convention", "opencv", "opengl")
        # Of a camera here x is to the left, y up, z forward.
        signs = [-1, -1, 1, 1] if convention == "opencv" else [-1, 1, -1, 1]
        rows: list[list[float]] = (place * signs).tolist()
        window = None if intrinsics is None else self._window(intrinsics)
        self._native.set_camera(rows, window)
        kept = _OF_PICTURE - (_OF_PLACE if window is None else _OF_CAMERA)
        self._changes = {name: value for name, value in self._changes.items() if name in kept}
        if window is None and _CAMERA in self._edits:
            window = self._edits[_CAMERA][1]
        self._edits = {**self._edits, _CAMERA: (rows, window)}

    def _window(self, intrinsics: ArrayLike) -> tuple[tuple[float, float], tuple[float, float]]:
        """What a camera sees of the plane at distance 1: from left to right, and from bottom to top."""
        k = _arrays.numbers(intrinsics, "intrinsics").astype(np.float64)
        expected = "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]] with positive focal lengths is expected"
        if k.shape != (3, 3) or not np.isfinite(k).all():
            raise Error(f"intrinsics is {k.tolist()}, but {expected}")
        (fx, skew, cx), (zero, fy, cy), last = k.tolist()
        if skew or zero or last != [0, 0, 1] or fx <= 0 or fy <= 0:
            raise Error(f"intrinsics is {k.tolist()}, but {expected}")
        width, height = self.size
        return (-cx / fx, (width - cx) / fx), ((cy - height) / fy, cy / fy)

    @property
    def camera(self) -> Camera:
        """The camera as matrices."""
        told = self._native.camera()
        width, height, _, _ = self._native.settings()
        vectors = {name: np.array(told[name], np.float64) for name in ("lookfrom", "right", "up", "forward")}
        return Camera(
            projection=told["projection"],
            width=width,
            height=height,
            **vectors,
            lens_radius=told["lens_radius"],
            focus_distance=told["focus_distance"],
            _plane_from_pixel=np.array(told["pixel"], np.float64),
        )

    def labels(self) -> Labels:
        """What is seen at the middle of each pixel: ids, depth, positions, normals, for data sets."""
        camera = self.camera
        arrays = self._native.labels()
        shape = (camera.height, camera.width)
        position = arrays["position"].reshape(*shape, 3)
        axis = camera.forward / np.linalg.norm(camera.forward)
        with np.errstate(invalid="ignore"):
            depth = (position - camera.lookfrom) @ axis
        depth[np.isnan(depth)] = np.inf
        shapes, materials, objects = self._native.names()
        return Labels(
            object=arrays["object"].reshape(shape),
            shape=arrays["shape"].reshape(shape),
            instance=arrays["instance"].reshape(shape),
            material=arrays["material"].reshape(shape),
            primitive=arrays["primitive"].reshape(shape),
            depth=depth,
            position=position,
            normal=arrays["normal"].reshape(*shape, 3),
            object_names=objects,
            shape_names=shapes,
            material_names=materials,
            camera=camera,
        )

    def inspect(self, x: int, y: int, sample: int = 0) -> Inspection:
        """Every step of the computation of one sample of a pixel: matrices, tests of primitives, roots, the tree of rays, and
        the additions that make its light, bit for bit. x, y: column and row from the top left.

        Raises IndexError for a pixel or sample that the picture does not have.
        """
        # Text and drawing are made when they are asked for: of the session as it is now.
        native = self._native.snapshot()
        text = _report(native, x, y, sample)
        lines = (native.inspect_text, native.inspect_svg)
        return from_json(Inspection, text, *(lambda line=line: line(x, y, sample) for line in lines))

    def inspect_pixel(self, x: int, y: int) -> PixelInspection:
        """All samples of a pixel, and how far each is from the others. Raises IndexError for a pixel that the picture does not
        have."""
        return from_json(PixelInspection, _report(self._native, x, y, None))

    @property
    def size(self) -> tuple[int, int]:
        """Columns and rows of the picture."""
        width, height, _, _ = self._native.settings()
        return width, height

    @property
    def samples(self) -> int:
        """Samples per pixel."""
        return self._native.settings()[2]

    @property
    def exposure(self) -> float:
        """Exposure in stops, also where it was chosen by what is seen."""
        return self._native.settings()[3]

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
        """The lowest and the highest corner of the scene's bounding box; None where it is empty."""
        return self._native.bounds()

    @property
    def materials(self) -> list[str]:
        """Names of the materials."""
        return self._native.names()[1]

    @property
    def warnings(self) -> list[str]:
        """What the readers doubted."""
        return [text for text, is_note in self._native.warnings() if not is_note]

    @property
    def notes(self) -> list[str]:
        """What the readers chose or left out without harm."""
        return [text for text, is_note in self._native.warnings() if is_note]

    def __copy__(self) -> Session:
        session = type(self).__new__(type(self))
        session.__dict__.update(self.__dict__, _edits=dict(self._edits), _native=self._native.snapshot())
        return session

    def __deepcopy__(self, memo: dict[int, Any]) -> Session:
        return self.__copy__()

    def __getstate__(self) -> dict[str, Any]:
        # One that was chosen by what is seen is that of then.
        state = {**self.__dict__, "_exposure": self.exposure}
        del state["_native"]
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        exposure = state.pop("_exposure")
        self.__dict__.update(state)
        self._native = self._opened(self._options, {**self._changes, "exposure": exposure})

    def __repr__(self) -> str:
        width, height = self.size
        return f"Session({self._source[0]!r}, {width}×{height}, {self.samples} samples)"


def render(
    scene: Any, *, name: str = "", progress: bool | Progress = False, **options: Unpack[Options]
) -> Picture:
    """The picture of a scene: `Session(scene, ...).render()`. A model without lights stands in a studio; without a camera it
    is framed."""
    return Session(scene, name=name, **options).render(progress=progress)


def _merged(options: Mapping[str, Any], more: Mapping[str, Any]) -> dict[str, Any]:
    """Options with more of them. The size in one word replaces its sides in two, and the other way round."""
    merged = {**options, **more}
    if more.get("size") is not None:
        merged.update(width=more.get("width"), height=more.get("height"))
    elif more.get("width") is not None or more.get("height") is not None:
        merged.update(size=None)
    return merged


def _source(scene: Any, name: str) -> tuple[str, dict[str, bytes]]:
    """The name of a scene's file, and the files that are in memory."""
    if isinstance(scene, str | os.PathLike):
        return os.fspath(scene), {}
    if isinstance(scene, bytes | bytearray | memoryview):
        if not Path(name).suffix:
            raise Error(
                f'name is {name!r}, but the bytes of a file need one that tells their format, such as "model.glb"'
            )
        return name, {name: bytes(scene)}
    if (made := as_scene(scene)) is not None:
        return made._in_memory()
    raise TypeError(
        f"a scene is a name, a Scene, a dictionary, a mesh of trimesh or the bytes of a file, but not {type(scene).__name__}"
    )


def as_scene(scene: Any) -> Scene | None:
    """The scene of plain data or of a mesh of trimesh; None for anything else."""
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, Mapping):
        return Scene(scene)
    if hasattr(scene, "vertices") and hasattr(scene, "faces"):
        made = Scene()
        made.trimesh(scene)
        return made
    return None


def _report(native: _lookfrom.Session, x: int, y: int, sample: int | None) -> str:
    """The report on a sample of a pixel as JSON, or on all (None)."""
    try:
        return native.inspect(x, y, sample)
    except OverflowError:
        # Numbers below 0, and of more than 32 bits.
        missing = f"pixel ({x}, {y})" if sample is None else f"sample {sample} of a pixel ({x}, {y})"
        raise IndexError(f"there is no {missing}: columns, rows and samples are counted from 0") from None


def _finished(render: Callable[[], _lookfrom.Picture]) -> Picture:
    try:
        return Picture(render())
    except BaseException as stop:
        native = getattr(stop, "picture", None)
        if isinstance(native, _lookfrom.Picture):
            stop.picture = Picture(native)  # type: ignore[attr-defined]
        raise


class _Bar:
    """A bar of tqdm, or nothing where it is not installed."""

    def __init__(self) -> None:
        self._bar: Any = None

    def __enter__(self) -> _Bar:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            return self
        self._bar = tqdm(total=0, unit="sample", unit_scale=True)
        return self

    def __call__(self, done: int, total: int) -> None:
        if self._bar is not None:
            self._bar.total = max(total, done)
            self._bar.update(done - self._bar.n)

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()
