"""What a tree is made of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._lookfrom import Error

if TYPE_CHECKING:
    from ._bvh import Bvh


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles with shared vertices.

    vertices: positions, shape (n, 3).
    faces: the vertices of each triangle, integers of shape (m, 3). A triangle's front is the side from which its vertices are
        seen counter-clockwise.
    masks: one mask for all triangles, or an array of one for each: 32 bits. A query with a mask sees those that have a bit in
        common with it. Without masks, all queries see them.
    """

    vertices: ArrayLike
    faces: ArrayLike
    masks: int | ArrayLike | None = None

    def _item(self, name: str) -> tuple[Any, ...]:
        vertices, _ = _arrays.points(self.vertices, f"{name}vertices")
        _arrays.finite(vertices, f"{name}vertices")
        faces = _arrays.indices(self.faces, f"{name}faces", len(vertices))
        return vertices, faces, _masks(self.masks, name, len(faces))


@dataclass(frozen=True, eq=False)
class Spheres:
    """Spheres.

    centers: shape (n, 3).
    radii: one for all, or shape (n,). Not negative; a sphere of radius 0 is never hit.
    masks: as of `Triangles`.
    """

    centers: ArrayLike
    radii: float | ArrayLike
    masks: int | ArrayLike | None = None

    def _item(self, name: str) -> tuple[Any, ...]:
        centers, _ = _arrays.points(self.centers, f"{name}centers")
        _arrays.finite(centers, f"{name}centers")
        return (
            centers,
            _radii(self.radii, f"{name}radii", len(centers)),
            _masks(self.masks, name, len(centers)),
        )


@dataclass(frozen=True, eq=False)
class Instance:
    """A tree in a place, or one of many.

    bvh: the tree, as it is when another one is made of it. It must not hold instances itself.
    matrix: from the tree to the world, shape (4, 4) with the last row 0 0 0 1, or (3, 4): columns are the images of the axes and
        the translation. Any matrix that has an inverse.
    mask: 32 bits, as of `Triangles`.
    """

    bvh: Bvh
    matrix: ArrayLike
    mask: int | None = None

    def _item(self, name: str) -> tuple[Any, ...]:
        matrix = _arrays.numbers(self.matrix, f"{name}matrix").astype(np.float64)
        if matrix.shape not in ((4, 4), (3, 4)):
            raise Error(f"{name}matrix has shape {matrix.shape}, but (4, 4) or (3, 4) is expected")
        if matrix.shape == (4, 4) and matrix[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
            raise Error(f"the last row of {name}matrix is {matrix[3].tolist()}, but 0 0 0 1 is expected")
        _arrays.finite(matrix, f"{name}matrix")
        return (
            self.bvh._tree,
            matrix[:3],
            None if self.mask is None else _arrays.bits(self.mask, f"{name}mask"),
        )


def _radii(value: float | ArrayLike, name: str, count: int) -> NDArray[np.float64]:
    radii = _arrays.numbers(value, name).astype(np.float64)
    if radii.ndim == 0:
        radii = np.full(count, radii)
    if radii.shape != (count,):
        raise Error(f"{name} has shape {radii.shape}, but there are {count} spheres")
    _arrays.finite(radii, name)
    if (radii < 0).any():
        number = int(np.flatnonzero(radii < 0)[0])
        raise Error(f"{name}[{number}] is {radii[number]}, but radii must not be negative")
    return radii


def _masks(value: int | ArrayLike | None, name: str, count: int) -> int | NDArray[np.uint32] | None:
    if value is None:
        return None
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}masks must be integers, but their type is {array.dtype}")
    if array.ndim == 0:
        return _arrays.bits(array[()], f"{name}masks")
    if array.shape != (count,):
        raise Error(f"{name}masks has shape {array.shape}, but there are {count} primitives")
    if count and (array.min() < 0 or array.max() >= 2**32):
        raise Error(f"{name}masks must have 32 bits: 0 to 2**32 - 1")
    return array.astype(np.uint32)
