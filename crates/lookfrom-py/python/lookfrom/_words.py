"""Options as keyword arguments: the options of the command `lookfrom render`, and how their values are worded."""

from __future__ import annotations

import datetime
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict

import numpy as np

from . import _toml
from ._arrays import is_array
from ._lookfrom import Error, keyword_list

if TYPE_CHECKING:
    from numpy.typing import NDArray

Int: TypeAlias = "int | np.integer[Any]"
Float: TypeAlias = "float | np.floating[Any] | np.integer[Any]"
Vector: TypeAlias = "Sequence[float] | NDArray[Any]"
Words: TypeAlias = list[tuple[str, "str | None"]]


class Options(TypedDict, total=False):
    """The keyword arguments of `Session`, `render` and `show`: names and values are those of the command `lookfrom render`.

    `lookfrom.options()` tells what each of them is.
    """

    # Size.
    size: Int | tuple[Int, Int]
    width: Int
    height: Int
    crop: Sequence[Int]
    # Samples, time, noise.
    samples: Int | range | tuple[Int, Int]
    time: Float | str | datetime.timedelta
    noise: Float
    allocation: str
    denoise: bool
    fireflies: str
    part: tuple[Int, Int]
    # Camera.
    lookfrom: Vector
    lookat: Vector
    up: str | Vector
    fov: Float
    view: str
    azimuth: Float
    elevation: Float
    bounds: Sequence[Float] | NDArray[Any]
    turn: Float
    camera: str
    # Light, background, colours.
    environment: str | os.PathLike[str] | NDArray[Any]
    rotate_environment: Float
    background: str | Sequence[Float]
    floor: bool
    exposure: Float | str
    tonemap: str
    # Contents of the scene.
    define: Mapping[str, Any]
    at: Float
    shutter: Float
    fps: Float
    animation: str | Int
    variant: str | Int
    scene_of_file: str | Int
    subdivide: Int
    instanced_lights: bool
    # Films.
    film: bool
    # Light transport.
    integrator: str
    depth: Int
    color: str
    light_sampler: str
    portals: str
    min_contribution: Float
    sampler: str
    seed: Int
    filter: str | tuple[str, Float] | tuple[str, Float, Float]
    # Layers.
    layers: str
    light_path: Mapping[str, str]
    cryptomatte: str | Sequence[str]
    spectral_buckets: Int
    wavelengths: tuple[Float, Float]
    # The call.
    threads: Int
    memory: Int | str


def options() -> dict[str, str]:
    """What each keyword argument of `Session` is, by its name."""
    return {name: told for name, told, _ in keyword_list()}


_SWITCHES = frozenset(name for name, _, is_switch in keyword_list() if is_switch)


def words(given: Mapping[str, Any]) -> Words:
    """Keyword arguments as the command takes them: names, and values as one would type them.

    Raises TypeError for values of a type that no option has. Names and values that make no sense are found where they are used.
    """
    result: Words = []
    for name, value in given.items():
        if value is None or (name in _SWITCHES and value is False):
            continue
        if name in _SWITCHES and value is True:
            result.append((name, None))
        elif name in ("define", "light_path"):
            result.extend(_pairs(name, value))
        else:
            result.append((name, _worded(name, value)))
    return result


def _pairs(name: str, value: Any) -> Words:
    if not isinstance(value, Mapping):
        raise TypeError(f"{name} must be a dictionary, but it is {type(value).__name__}")
    word = str if name == "light_path" else _toml.value
    return [(name, f"{key}={word(item)}") for key, item in value.items()]


def _worded(name: str, value: Any) -> str:
    if is_array(value):
        value = np.asarray(value).tolist()
    if isinstance(value, str | os.PathLike):
        return os.fspath(value)
    if isinstance(value, bool | np.bool_):
        return "on" if value else "off"
    if isinstance(value, int | np.integer):
        # Numbers of bytes and of seconds.
        unit = {"memory": f"{int(value) / 1024!r}KiB", "time": f"{int(value)}s"}
        return unit.get(name, str(int(value)))
    if isinstance(value, float | np.floating):
        return f"{float(value)!r}s" if name == "time" else repr(float(value))
    if isinstance(value, datetime.timedelta):
        return f"{value.total_seconds()!r}s"
    if isinstance(value, range):
        if value.step != 1:
            raise Error(f"{name} is {value}, but samples are a range with the step 1")
        return f"{value.start}..{value.stop}"
    if isinstance(value, Sequence):
        items = [_worded("", item) for item in value]
        if name == "background":
            return _hex(value)
        return {"size": "x", "samples": "..", "part": "/", "filter": ":"}.get(name, ",").join(items)
    raise TypeError(f"{name} is {type(value).__name__}, which no option can be")


def _hex(color: Sequence[Any]) -> str:
    """A colour of numbers from 0 to 1, as matplotlib has them, in hexadecimal digits."""
    if len(color) not in (3, 4) or not all(0 <= part <= 1 for part in color):
        raise Error(
            f'background is {tuple(color)}, but a name, "#rrggbb" or three numbers from 0 to 1 are expected'
        )
    return "#" + "".join(f"{round(255 * part):02x}" for part in color[:3])
