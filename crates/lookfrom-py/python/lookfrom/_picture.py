"""Pictures, and the films that they are developed from."""

from __future__ import annotations

import functools
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _lookfrom
from ._lookfrom import Error
from ._words import words

if TYPE_CHECKING:
    from numpy.typing import DTypeLike, NDArray
    from typing_extensions import Unpack

    from ._words import Options

# Layers by the names of their channels in an EXR, which are pbrt's.
_NAMES = {
    "Albedo": "albedo",
    "N": "geometric_normal",
    "Ns": "normal",
    "P": "position",
    "Variance": "variance",
    "S0": "spectrum",
}


class Picture(Mapping[str, "NDArray[np.float32]"]):
    """A finished picture, with rows from the top.

    It is a mapping of layers by name, where they were asked for: `layers="geometry"` gives albedo, normal, geometric_normal and
    position (h, w, 3), uv (h, w, 2), depth (h, w) and variance (h, w, 3), means over the samples, in the space of the camera
    (x right, y up, z forward); `layers="motion"` gives "motion" (h, w, 2) besides: pixels (x right, y up) while the shutter is
    open; light_path={"direct": "C<RD>L"} gives a layer "direct" (h, w, 3); spectral_buckets=16 with color="spectral" gives a
    layer "spectrum" (h, w, 16), by wavelength; a scene's band "red" is a layer "band.red" (h, w); a denoised picture has the layer
    "noisy".

    In Jupyter it shows itself.
    """

    def __init__(self, native: _lookfrom.Picture) -> None:
        self._native = native
        self.width, self.height = native.size

    @functools.cached_property
    def linear(self) -> NDArray[np.float32]:
        """Linear light in Rec. 709, shape (h, w, 3), premultiplied where there is alpha."""
        return self._native.linear().reshape(self.height, self.width, 3)

    @functools.cached_property
    def alpha(self) -> NDArray[np.float32] | None:
        """Alpha, shape (h, w), of a picture whose background is transparent or a colour; None for others."""
        alpha = self._native.alpha()
        return None if alpha is None else alpha.reshape(self.height, self.width)

    @functools.cached_property
    def srgb(self) -> NDArray[np.uint8]:
        """8-bit sRGB as a screen shows it, after exposure and tone map: shape (h, w, 3), or (h, w, 4) with straight alpha."""
        rgba, has_alpha = self._native.srgb()
        return rgba.reshape(self.height, self.width, 4)[:, :, : 4 if has_alpha else 3]

    @functools.cached_property
    def _layers(self) -> dict[str, NDArray[np.float32]]:
        parts: dict[str, list[NDArray[np.float32]]] = {}
        for channel, numbers in self._native.channels().items():
            stem, _, _ = channel.rpartition(".")
            if stem in ("", "band"):
                name = "uv" if channel in ("u", "v") else channel
            else:
                name = _NAMES.get(stem, stem)
            parts.setdefault(name, []).append(numbers.reshape(self.height, self.width))
        return {name: np.stack(part, axis=-1) if len(part) > 1 else part[0] for name, part in parts.items()}

    def __getitem__(self, name: str) -> NDArray[np.float32]:
        try:
            return self._layers[name]
        except KeyError:
            known = ", ".join(self._layers) or 'none: layers="geometry" and light_path={...} add some'
            raise KeyError(f"there is no layer {name!r}; there are {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._layers)

    def __len__(self) -> int:
        return len(self._layers)

    # A picture is itself: comparing all its layers is not what == is asked for.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    @property
    def size(self) -> tuple[int, int]:
        """Columns and rows."""
        return self.width, self.height

    @property
    def samples(self) -> int:
        """Mean number of samples per pixel, rounded down."""
        return self._native.told()[0]

    @property
    def reason(self) -> str:
        """Why the render ended: "samples", "time", "noise", "interrupt"; "film" for a film that was developed."""
        return self._native.told()[1]

    @property
    def rays(self) -> int:
        """Number of rays traced."""
        return self._native.told()[2]

    @property
    def error(self) -> float:
        """Relative standard error of the picture, before it was denoised."""
        return self._native.told()[3]

    @property
    def header(self) -> dict[str, str]:
        """The settings that determine the picture, by name, as files have them."""
        return dict(self._native.header())

    @property
    def film(self) -> Film | None:
        """The film, of a session with film=True; None for others."""
        film = self._native.film()
        return None if film is None else Film(film)

    def save(self, path: str | os.PathLike[str], bits: int | None = None) -> None:
        """Writes a file in the format of its extension: .png, .jpg, .webp, .exr (with layers; with film=True the film), .hdr,
        .pfm, .ppm, .gif. A file that was there stays until the new one is on the disk.

        bits: of a channel: 8 or 16 of a .png, 16 or 32 of an .exr; 8 and 32 without it. An .exr of 16 has its colours, alpha and
        normals so, other layers in 32, and no film.

        Raises Error for another extension, SceneError for other bits, and OSError where the file cannot be written.
        """
        _lookfrom.replace_files([(path, self.encode(Path(path).suffix, bits))])

    def encode(self, extension: str, bits: int | None = None) -> bytes:
        """The bytes of a file in the format of an extension, such as "png", with so many bits of a channel (as `save`)."""
        return self._native.encode(extension.removeprefix("."), bits)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.linear, dtype=dtype, copy=True if copy is None else copy)

    def _repr_png_(self) -> bytes:
        return self.encode("png")

    def __copy__(self) -> Picture:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Picture:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError(
            'a picture cannot be pickled: give other processes its arrays (linear, srgb), its bytes (encode("exr")) or its film'
        )

    def __repr__(self) -> str:
        return f"Picture({self.width}×{self.height}, {self.samples} samples per pixel)"


class Film:
    """The exact sums of a picture's samples, which can be added up: films of parts make the film of the whole, bit for bit.

    `render(..., film=True).film` is one; `Film.read` reads one from an .exr of `save` or of `lookfrom render --film`. Films can be
    pickled, so that other processes and machines can render parts.
    """

    def __init__(self, native: _lookfrom.Film) -> None:
        self._native = native

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Film:
        """The film of a file. Raises SceneError where it is damaged or no film."""
        return cls(_lookfrom.Film.read(os.fspath(path)))

    @staticmethod
    def merge(films: Iterable[Film]) -> Film:
        """The film with the samples of all, in any order. Raises SceneError for films of other pictures and samples that two
        of them have, and ValueError where there are none."""
        merged: _lookfrom.Film | None = None
        for film in films:
            merged = film._native if merged is None else merged.merged(film._native)
        if merged is None:
            raise ValueError("no films were given to merge")
        return Film(merged)

    def develop(self, **options: Unpack[Options]) -> Picture:
        """The picture, as it was to be developed, or with another exposure, tonemap, background, denoise or fireflies.

        exposure="auto" chooses it by what the picture shows.

        Raises Error for other options, and for a background that the film cannot have: one of environment has no alpha, and
        others have no environment.
        """
        return Picture(self._native.develop(words(options)))

    def resume(self, *, samples: int | None = None, threads: int | None = None) -> Picture:
        """Renders the samples that it lacks, or more: `samples` per pixel in all. The scene is read again from where it was;
        for one that was in memory, `Session.render(film=...)` goes on.

        Returns the finished picture, whose `film` has all. Raises SceneError where the scene has changed, and Error where it
        was in memory.
        """
        scene, arguments = self._native.origin()
        if scene is None:
            raise Error(
                "the scene of this film was in memory: Session.render(film=...) of the same scene goes on with it"
            )
        typed = words({"film": True, "samples": samples, "threads": threads})
        for argument in arguments:
            name, is_valued, value = argument.removeprefix("--").partition("=")
            keyword = "scene_of_file" if name == "scene" else name.replace("-", "_")
            typed.append((keyword, value if is_valued else None))
        return Picture(_lookfrom.Session(scene, {}, typed, False).render(self._native, None))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the film, with its picture, as an .exr. A file that was there stays until the new one is on the disk. Raises
        SceneError where it cannot be written."""
        self._native.save(os.fspath(path))

    @property
    def size(self) -> tuple[int, int]:
        """Columns and rows of the picture."""
        width, height, _, _ = self._native.told()
        return width, height

    @property
    def samples(self) -> int:
        """Samples of all pixels together."""
        return self._native.told()[2]

    @property
    def is_complete(self) -> bool:
        """Whether it has all samples that it was to have."""
        return self._native.told()[3]

    def __reduce__(self) -> tuple[Any, ...]:
        return _film_of_bytes, (self._native.to_bytes(),)

    def __repr__(self) -> str:
        width, height, samples, is_complete = self._native.told()
        return f"Film({width}×{height}, {samples} samples{'' if is_complete else ', incomplete'})"


def _film_of_bytes(content: bytes) -> Film:
    return Film(_lookfrom.Film.from_bytes(content))
