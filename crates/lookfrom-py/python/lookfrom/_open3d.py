"""Methods named as those of Open3D's `RaycastingScene`, where they mean the same."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._hits import Found
from ._lookfrom import Error

if TYPE_CHECKING:
    from ._bvh import Bvh


class Open3dMethods:
    """The names, arguments and results of Open3D, with numpy's arrays.

    rays: shape (..., 6), origins and directions. query_points: shape (..., 3). nthreads: at most so many; 0 for all cores. Numbers
    are float64; ids are uint32, and `INVALID_ID` for misses.
    """

    INVALID_ID: int = 2**32 - 1

    def cast_rays(self, rays: ArrayLike, nthreads: int = 0) -> dict[str, NDArray[np.generic]]:
        """`Bvh.closest_hits` as a dict: t_hit, geometry_ids, primitive_ids, primitive_uvs, primitive_normals."""
        origins, directions = _origins_and_directions(rays)
        hits = cast("Bvh", self).closest_hits(origins, directions, threads=nthreads or None)
        return {**_of_hits(hits), "primitive_normals": hits.normals}

    def test_occlusions(
        self, rays: ArrayLike, tnear: float = 0.0, tfar: float = np.inf, nthreads: int = 0
    ) -> NDArray[np.bool_]:
        """`Bvh.occluded`."""
        origins, directions = _origins_and_directions(rays)
        return cast("Bvh", self).occluded(
            origins, directions, t_min=tnear, t_max=tfar, threads=nthreads or None
        )

    def count_intersections(self, rays: ArrayLike, nthreads: int = 0) -> NDArray[np.int64]:
        """`Bvh.count_hits`."""
        origins, directions = _origins_and_directions(rays)
        return cast("Bvh", self).count_hits(origins, directions, threads=nthreads or None)

    def list_intersections(self, rays: ArrayLike, nthreads: int = 0) -> dict[str, NDArray[np.generic]]:
        """`Bvh.all_hits` as a dict: ray_splits, ray_ids, t_hit, geometry_ids, primitive_ids, primitive_uvs."""
        origins, directions = _origins_and_directions(rays)
        hits = cast("Bvh", self).all_hits(origins, directions, threads=nthreads or None)
        return {"ray_splits": hits.offsets, "ray_ids": hits.ray, **_of_hits(hits)}

    def compute_closest_points(
        self, query_points: ArrayLike, nthreads: int = 0
    ) -> dict[str, NDArray[np.generic]]:
        """`Bvh.closest_points` as a dict: points, geometry_ids, primitive_ids, primitive_uvs, primitive_normals."""
        found = cast("Bvh", self).closest_points(query_points, threads=nthreads or None)
        rest = {name: array for name, array in _of_hits(found).items() if name != "t_hit"}
        return {"points": found.points, **rest, "primitive_normals": found.normals}

    def compute_distance(self, query_points: ArrayLike, nthreads: int = 0) -> NDArray[np.float64]:
        """`Bvh.closest_points(...).distance`."""
        return cast("Bvh", self).closest_points(query_points, threads=nthreads or None).distance

    def compute_signed_distance(self, query_points: ArrayLike, nthreads: int = 0) -> NDArray[np.float64]:
        """`Bvh.signed_distance`: negative inside."""
        return cast("Bvh", self).signed_distance(query_points, threads=nthreads or None)

    def compute_occupancy(self, query_points: ArrayLike, nthreads: int = 0) -> NDArray[np.float64]:
        """`Bvh.contains` as numbers: 1 inside, 0 outside."""
        return cast("Bvh", self).contains(query_points, threads=nthreads or None).astype(np.float64)


def _origins_and_directions(rays: ArrayLike) -> tuple[_arrays.Floats, _arrays.Floats]:
    array = _arrays.numbers(rays, "rays")
    if array.ndim == 0 or array.shape[-1] != 6:
        raise Error(f"rays has shape {array.shape}, but (..., 6) is expected: origins and directions")
    return array[..., :3], array[..., 3:]


def _of_hits(found: Found) -> dict[str, NDArray[np.generic]]:
    return {
        "t_hit": found._number,
        "geometry_ids": found.geometry.view(np.uint32),
        "primitive_ids": found.primitive.view(np.uint32),
        "primitive_uvs": np.stack([found.u, found.v], axis=-1),
    }
