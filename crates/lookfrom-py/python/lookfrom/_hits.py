"""What queries return: arrays, and what can be computed from them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._arrays import Floats, Shape
from ._lookfrom import Error

if TYPE_CHECKING:
    from ._arrays import HitArrays
    from ._bvh import Bvh


_NO_RAY = np.zeros((1, 3))


class Found:
    """Places on primitives, one for each element of arrays that all have the same shape.

    Computed from rays and geometry when they are first asked for: `points`, `normals`, `barycentrics`, `interpolate`.
    """

    def __init__(self, bvh: Bvh, arrays: HitArrays, shape: Shape) -> None:
        self._bvh, self._version = bvh, bvh._version
        numbers, u, v, primitive, geometry, instance = arrays
        self._number = numbers.reshape(shape)
        self.u: NDArray[np.float64] = u.reshape(shape)
        """Weight of a triangle's second vertex, 0 to 1; 0 for spheres and misses."""
        self.v: NDArray[np.float64] = v.reshape(shape)
        """Weight of a triangle's third vertex, 0 to 1; 0 for spheres and misses."""
        self.primitive: NDArray[np.int32] = primitive.reshape(shape)
        """Number of the triangle or sphere in its geometry; -1 for a miss."""
        self._geometry, self._instance = geometry, instance

    @property
    def triangle(self) -> NDArray[np.int32]:
        """Another name of `primitive`, for trees of triangles: the row of `faces`; -1 for a miss."""
        return self.primitive

    @cached_property
    def geometry(self) -> NDArray[np.int32]:
        """Number of the geometry in its tree; -1 for a miss."""
        if self._geometry is not None:
            return self._geometry.reshape(self.primitive.shape)
        return np.where(self.hit, np.int32(0), np.int32(-1))

    @cached_property
    def instance(self) -> NDArray[np.int32]:
        """Number of the instance; -1 for a miss, and for what is not in an instance."""
        if self._instance is not None:
            return self._instance.reshape(self.primitive.shape)
        return np.full(self.primitive.shape, -1, np.int32)

    @property
    def hit(self) -> NDArray[np.bool_]:
        """Whether there is anything: False for a miss."""
        return self.primitive >= 0

    @property
    def barycentrics(self) -> NDArray[np.float64]:
        """The weights of a triangle's three vertices, shape (..., 3), with the sum 1; 1 0 0 for spheres, NaN for misses."""
        weights = np.stack([1.0 - self.u - self.v, self.u, self.v], axis=-1)
        weights[~self.hit] = np.nan
        return weights

    @property
    def points(self) -> NDArray[np.float64]:
        """The points on the surface, shape (..., 3); NaN for misses.

        From a triangle's vertices and the weights, so they are on the triangle to rounding in f64. On spheres they are computed
        from the rays, which must not have been changed in place.
        """
        return self._points_and_normals[0]

    @property
    def normals(self) -> NDArray[np.float64]:
        """Unit normals of the primitives, shape (..., 3), on the side from which a triangle's vertices are seen counter-clockwise,
        and out of spheres: not turned towards the rays. NaN for misses."""
        return self._points_and_normals[1]

    @cached_property
    def _points_and_normals(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        self._check_version()
        count = self.primitive.size
        origins, directions, t = self._rays_and_t()
        origins, directions = (np.broadcast_to(rows, (count, 3)) for rows in (origins, directions))
        numbers = [array.reshape(-1) for array in (t, self.u, self.v)]
        ids = [array.reshape(-1) for array in (self.primitive, self.geometry, self.instance)]
        both = self._bvh._tree.points_and_normals((origins, directions, numbers, ids), 0)
        points, normals = (array.reshape(*self.primitive.shape, 3) for array in both)
        return points, normals

    def _rays_and_t(self) -> tuple[Floats, Floats, NDArray[np.float64]]:
        """The rays and the t of points on spheres; those of triangles are not used."""
        raise NotImplementedError

    def interpolate(self, values: ArrayLike, *, geometry: int = 0) -> NDArray[np.float64]:
        """Values of vertices, such as texture coordinates, colours or smooth normals, interpolated over triangles.

        values: one row for each vertex of the geometry, shape (n,) or (n, k); texture coordinates have shape (n, 2).
        geometry: number of a geometry of triangles, in the tree itself.

        Returns an array of shape (...) or (..., k), float64; NaN for misses and for other geometries.
        Raises Error where the geometry has no triangles or another number of vertices.
        """
        self._check_version()
        of_vertices = _arrays.numbers(values, "values")
        has_spheres, vertices, _ = self._bvh._shape(geometry)
        if has_spheres:
            raise Error(f"geometry {geometry} has spheres, which have no vertices")
        faces = self._bvh._tree.geometry(geometry)[1]
        if of_vertices.ndim not in (1, 2) or len(of_vertices) != vertices:
            raise Error(
                f"values has shape {of_vertices.shape}, but one row for each of {vertices} vertices is expected"
            )
        is_of_it = (self.geometry == geometry) & (self.instance < 0)
        corners = of_vertices[faces[self.primitive[is_of_it]]]
        result = np.full((*self.primitive.shape, *of_vertices.shape[1:]), np.nan)
        result[is_of_it] = np.einsum("ni,ni...->n...", self.barycentrics[is_of_it], corners)
        return result

    def __len__(self) -> int:
        return len(self.primitive)

    def _check_version(self) -> None:
        if self._version != self._bvh._version:
            raise Error("the tree was refitted after this query: ask for points before, or query again")

    def __repr__(self) -> str:
        shape = self.primitive.shape
        return f"<{type(self).__name__}: shape {shape}, {np.count_nonzero(self.hit)} on surfaces>"


class Hits(Found):
    """The closest hits of rays: arrays with the shape of the rays."""

    def __init__(self, bvh: Bvh, arrays: HitArrays, shape: Shape, rays: tuple[Floats, Floats]) -> None:
        super().__init__(bvh, arrays, shape)
        self._rays = rays

    def _rays_and_t(self) -> tuple[Floats, Floats, NDArray[np.float64]]:
        return *self._rays, self._number

    @property
    def t(self) -> NDArray[np.float64]:
        """The ray's parameter: a hit is at `origin + t * direction`, so t is a distance where directions are unit vectors.
        Infinite for a miss."""
        return self._number


class AllHits(Found):
    """All hits of rays: arrays of one axis, sorted by ray, and for each ray by t."""

    def __init__(
        self,
        bvh: Bvh,
        offsets: NDArray[np.int64],
        arrays: HitArrays,
        rays: tuple[Floats, Floats],
    ) -> None:
        super().__init__(bvh, arrays, (int(offsets[-1]),))
        self.offsets = offsets
        """Where the hits of each ray start and the last end, shape (n + 1,): those of ray i are `offsets[i]:offsets[i + 1]`."""
        self._rays = rays

    @property
    def t(self) -> NDArray[np.float64]:
        """The ray's parameter: a hit is at `origin + t * direction`."""
        return self._number

    @cached_property
    def ray(self) -> NDArray[np.int64]:
        """The number of each hit's ray, counted in C order where rays have several axes."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))

    @property
    def counts(self) -> NDArray[np.int64]:
        """The number of hits of each ray, shape (n,)."""
        return np.diff(self.offsets)

    def _rays_and_t(self) -> tuple[Floats, Floats, NDArray[np.float64]]:
        origins, directions = self._rays
        if self._bvh._has_spheres():
            return origins[self.ray], directions[self.ray], self._number
        return _NO_RAY, _NO_RAY, self._number


class ClosestPoints(Found):
    """The closest points of surfaces to points: arrays with the shape of the points."""

    def __init__(self, bvh: Bvh, points: NDArray[np.float64], arrays: HitArrays, shape: Shape) -> None:
        super().__init__(bvh, arrays, shape)
        self._points = points.reshape(*shape, 3)

    @property
    def distance(self) -> NDArray[np.float64]:
        """The distance, not negative; infinite where nothing is near enough."""
        return self._number

    @property
    def points(self) -> NDArray[np.float64]:
        """The closest points, shape (..., 3); NaN where nothing is near enough."""
        return self._points

    def _rays_and_t(self) -> tuple[Floats, Floats, NDArray[np.float64]]:
        # A sphere's normal is that at the point itself.
        return self._points.reshape(-1, 3), _NO_RAY, np.zeros_like(self._number)


@dataclass(frozen=True)
class Statistics:
    """Numbers about a tree."""

    triangles: int
    """Triangles that rays can hit."""
    spheres: int
    """Spheres that rays can hit."""
    instances: int
    """Instances of other trees."""
    left_out: int
    """Primitives that no ray can hit: triangles without area, spheres without radius."""
    memory: int
    """Bytes, of the tree and its geometry, without the trees of instances."""
