"""Rays for trimesh: `mesh.ray = lookfrom.trimesh.RayMeshIntersector(mesh)`.

A drop-in for `trimesh.ray.ray_pyembree` and `trimesh.ray.ray_triangle`: the same methods, arguments and results, but no ray slips
through an edge, places are right to float64 wherever the mesh is, and all cores work. This module itself does not need trimesh.
"""

from __future__ import annotations

from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._bvh import Bvh

# A ray that starts on a face hits it, as with trimesh.
_START = np.nextafter(0.0, -1.0)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class RayMeshIntersector:
    """Ray queries for a mesh of trimesh.

    geometry: a `trimesh.Trimesh`. The tree is built at the first query, and again when the mesh has changed.
    scale_to_box: has no effect: queries are always relative to the mesh's box.
    threads: at most so many for each query; None for all cores.

    As with trimesh, rays that start on a face hit it, and rays whose direction is zero or not finite hit nothing.
    """

    def __init__(self, geometry: Any, scale_to_box: bool = True, *, threads: int | None = None) -> None:
        self.mesh = geometry
        self._scale_to_box = scale_to_box
        self._threads = threads
        self._built: tuple[int, Bvh] | None = None

    @property
    def _how(self) -> dict[str, Any]:
        return {"t_min": _START, "invalid": "miss", "threads": self._threads}

    @property
    def bvh(self) -> Bvh:
        """The mesh's tree, for other queries."""
        version = hash(self.mesh)
        if self._built is None or self._built[0] != version:
            vertices, faces = (np.asarray(array) for array in (self.mesh.vertices, self.mesh.faces))
            self._built = version, Bvh(vertices, faces, threads=self._threads)
        return self._built[1]

    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True, **kwargs: Any
    ) -> tuple[Floats, Integers, Integers]:
        """Where rays hit the mesh.

        ray_origins, ray_directions: shape (n, 3).
        multiple_hits: every place where a ray crosses the surface, each once, or only the first.

        Returns locations, float64 of shape (m, 3), and for each its ray and its face, int64 of shape (m,); by ray, then by
        distance.
        """
        index_tri, index_ray, locations = self.intersects_id(
            ray_origins, ray_directions, multiple_hits=multiple_hits, return_locations=True, **kwargs
        )
        return locations, index_ray, index_tri

    @overload
    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        return_locations: Literal[False] = False,
    ) -> tuple[Integers, Integers]: ...
    @overload
    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        *,
        return_locations: Literal[True],
    ) -> tuple[Integers, Integers, Floats]: ...
    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        return_locations: bool = False,
    ) -> tuple[Integers, Integers] | tuple[Integers, Integers, Floats]:
        """Which faces rays hit.

        ray_origins, ray_directions: shape (n, 3).
        multiple_hits: every face where a ray crosses the surface, or only the first that it hits.
        max_hits: at most so many for each ray; None for all.
        return_locations: return the places too.

        Returns faces and their rays, int64 of shape (m,), by ray, then by distance; and locations, float64 of shape (m, 3).
        """
        origins, directions, bvh = *_rays(ray_origins, ray_directions), self.bvh
        if multiple_hits:
            hits = bvh.all_hits(origins, directions, crossings=True, **self._how)
            index_tri, index_ray = hits.triangle.astype(np.int64), hits.ray
            chosen: Any = slice(None)
            if max_hits is not None:
                chosen = np.arange(len(index_ray)) - hits.offsets[index_ray] < max_hits
            if not return_locations:
                return index_tri[chosen], index_ray[chosen]
            return index_tri[chosen], index_ray[chosen], hits.points[chosen]
        if not return_locations:
            first = bvh.closest_primitives(origins, directions, **self._how)
            index_ray = np.flatnonzero(first >= 0)
            return first[index_ray].astype(np.int64), index_ray
        closest = bvh.closest_hits(origins, directions, **self._how)
        index_ray = np.flatnonzero(closest.hit)
        return closest.triangle[index_ray].astype(np.int64), index_ray, closest.points[index_ray]

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike, **kwargs: Any) -> Integers:
        """The first face that each ray hits: int64 of shape (n,), -1 for a miss."""
        origins, directions = _rays(ray_origins, ray_directions)
        first = self.bvh.closest_primitives(origins, directions, **self._how)
        return first.astype(np.int64)

    def intersects_any(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, **kwargs: Any
    ) -> NDArray[np.bool_]:
        """Whether each ray hits the mesh: bool of shape (n,)."""
        origins, directions = _rays(ray_origins, ray_directions)
        return self.bvh.occluded(origins, directions, **self._how)

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether points, shape (n, 3), are inside the mesh: bool of shape (n,), as `Bvh.contains`. Points that are not finite
        are outside."""
        rows, _ = _arrays.points(points, "points")
        is_finite = np.isfinite(rows).all(axis=1)
        if is_finite.all():
            return self.bvh.contains(rows, threads=self._threads)
        inside = np.zeros(len(rows), bool)
        inside[is_finite] = self.bvh.contains(rows[is_finite], threads=self._threads)
        return inside

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_built": None}

    def __copy__(self) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, self._scale_to_box, threads=self._threads)

    def __deepcopy__(self, memo: dict[int, Any]) -> RayMeshIntersector:
        return self.__copy__()


def _rays(ray_origins: ArrayLike, ray_directions: ArrayLike) -> tuple[_arrays.Floats, _arrays.Floats]:
    origins, _ = _arrays.points(ray_origins, "ray_origins")
    directions, _ = _arrays.points(ray_directions, "ray_directions")
    if origins.shape != directions.shape:
        raise ValueError(
            f"ray_origins has shape {origins.shape}, but ray_directions has shape {directions.shape}"
        )
    return origins, directions
