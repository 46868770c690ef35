"""What users pass as arrays: checked, in words about their arguments, and brought into the shapes the compiled module takes."""

from __future__ import annotations

import math
import operator
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._lookfrom import Error

Floats: TypeAlias = NDArray[np.float64 | np.float32]
# t or a distance, u, v, primitive, geometry, instance; the last two are None where they are 0, and none, for all hits.
HitArrays: TypeAlias = tuple[
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.float64],
    NDArray[np.int32],
    NDArray[np.int32] | None,
    NDArray[np.int32] | None,
]
Faces: TypeAlias = Literal["both", "front", "back"]
Shape: TypeAlias = tuple[int, ...]

# Indices of vertices and primitives have 32 bits.
MOST_ROWS = 2**32 - 1


def is_array(value: object) -> bool:
    """Whether a value is an array: of numpy, or of others that numpy reads, such as PyTorch, JAX and Pillow."""
    is_read = hasattr(value, "__array__") or hasattr(value, "__array_interface__")
    return is_read and not isinstance(value, np.generic)


def _array(value: ArrayLike, name: str) -> NDArray[Any]:
    try:
        return np.asarray(value)
    except ValueError as error:
        raise TypeError(f"{name} must be an array of numbers, but rows differ in length: {error}") from error


def numbers(value: ArrayLike, name: str) -> Floats:
    """An array of float32 or float64, as it is where it has that type; of integers and other floats a copy in float64.

    Raises TypeError for anything that is not an array of real numbers.
    """
    array = _array(value, name)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be an array of numbers, but its type is {array.dtype}")
    if array.dtype not in (np.float32, np.float64):
        return array.astype(np.float64)
    if not (array.dtype.isnative and array.flags.aligned):
        return array.astype(array.dtype.newbyteorder("="))
    return array


def vectors(value: ArrayLike, name: str) -> Floats:
    """An array of shape (..., 3): see `numbers`. Raises Error for another shape."""
    array = numbers(value, name)
    if array.ndim == 0 or array.shape[-1] != 3:
        # An empty list has no columns.
        if array.size == 0 and array.ndim == 1:
            return np.zeros((0, 3))
        raise Error(f"{name} has shape {array.shape}, but (..., 3) is expected: three coordinates each")
    return array


def points(value: ArrayLike, name: str) -> tuple[Floats, Shape]:
    """Rows of shape (n, 3), and the shape without the last axis that results have."""
    array = vectors(value, name)
    return array.reshape(-1, 3), array.shape[:-1]


def finite(array: Floats, name: str) -> None:
    """Raises Error where a number of an array of rows is not finite, or where there are more rows than indices of 32 bits reach."""
    if len(array) > MOST_ROWS:
        raise Error(f"{name} has {len(array)} rows, but at most {MOST_ROWS} are possible")
    # The sum of finite numbers may overflow, but that of an array with a NaN or an infinity is never finite.
    with np.errstate(all="ignore"):
        if math.isfinite(array.sum(dtype=np.float64)):
            return
    wrong = np.flatnonzero(~np.isfinite(array).reshape(len(array), -1).all(axis=1))
    if wrong.size:
        row = int(wrong[0])
        raise Error(f"{name}[{row}] is {array[row].tolist()}, but all numbers must be finite")


def indices(value: ArrayLike, name: str, vertices: int) -> NDArray[np.uint32]:
    """Faces: an array of shape (m, 3) of integers from 0 to below `vertices`."""
    array = _array(value, name)
    if array.size == 0:
        return np.zeros((0, 3), np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name} must be an array of integers, but its type is {array.dtype}")
    if array.ndim != 2 or array.shape[1] != 3:
        raise Error(f"{name} has shape {array.shape}, but (m, 3) is expected: three vertices each")
    if array.min() < 0 or array.max() >= vertices:
        row = int(np.flatnonzero(((array < 0) | (array >= vertices)).any(axis=1))[0])
        raise Error(
            f"{name}[{row}] is {array[row].tolist()}, but there are {vertices} vertices, counted from 0"
        )
    return array.astype(np.uint32, copy=False)


def bits(value: Any, name: str) -> int:
    """A mask: an integer of 32 bits."""
    mask = operator.index(value)
    if not 0 <= mask < 2**32:
        raise Error(f"{name} is {mask}, but a mask has 32 bits: 0 to 2**32 - 1")
    return mask


def thread_count(threads: int | None) -> int:
    """The number of threads as the compiled module takes it: 0 stands for all cores."""
    if threads is None:
        return 0
    count = operator.index(threads)
    if not 1 <= count <= 1024:
        raise Error(f"threads is {count}, but 1 to 1024 are possible, or None for all cores")
    return count


def one_of(value: str, name: str, *choices: str) -> str:
    """A word of a few."""
    if value not in choices:
        raise Error(f"{name} is {value!r}, but one of {', '.join(map(repr, choices))} is expected")
    return value


def each(value: ArrayLike, name: str, shape: Shape) -> NDArray[np.float64]:
    """One number for each ray: a float64 array of one axis, broadcast where there is one number for all."""
    array = numbers(value, name).astype(np.float64, copy=False)
    if array.ndim == 0:
        return np.broadcast_to(array, (math.prod(shape),))
    try:
        return np.broadcast_to(array, shape).reshape(-1)
    except ValueError:
        raise Error(f"{name} has shape {array.shape}, but there are rays of shape {shape}") from None


def rows_together(
    first: tuple[str, ArrayLike], second: tuple[str, ArrayLike]
) -> tuple[Floats, Floats, Shape]:
    """Two arrays of shape (..., 3) as rows, with one row for all broadcast without a copy; and the shape that results have."""
    a, b = vectors(first[1], first[0]), vectors(second[1], second[0])
    try:
        shape = np.broadcast_shapes(a.shape[:-1], b.shape[:-1])
    except ValueError:
        raise Error(
            f"{first[0]} has shape {a.shape} and {second[0]} has shape {b.shape}, which do not go together"
        ) from None

    def rows(array: Floats) -> Floats:
        if array.ndim == 1:
            return np.broadcast_to(array, (math.prod(shape), 3))
        return np.broadcast_to(array, (*shape, 3)).reshape(-1, 3)

    return rows(a), rows(b), shape
