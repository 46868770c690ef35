"""A tree of triangles, spheres and instances, and its queries."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._arrays import Faces, Floats, Shape
from ._geometry import Instance, Spheres, Triangles, _radii
from ._hits import AllHits, ClosestPoints, Hits, Statistics
from ._lookfrom import Error, Tree
from ._open3d import Open3dMethods

Quality = Literal["fast", "balanced", "best"]
Invalid = Literal["raise", "miss"]


class Bvh(Open3dMethods):
    """A bounding volume hierarchy: rays against triangles, watertight and with the accuracy of float64.

    Bvh(vertices, faces) is a tree of one mesh; `Bvh.from_geometries` makes one of several meshes, spheres and instances.

    vertices: positions, shape (n, 3), float32 or float64. They are copied.
    faces: the vertices of each triangle, integers of shape (m, 3).
    masks: one mask of 32 bits for all triangles, or one for each, shape (m,): see `Triangles`.
    quality: how much time is spent on building: "fast", "balanced", "best". No result depends on it.
    threads: how many threads build, at most; None for all cores.

    Which triangle a ray hits is decided for positions that are rounded to about 1e-7 of the size of what is in the tree, wherever
    that is: an error below 4e-6 of half its largest extent in any case. No ray passes between triangles that share an edge or a
    corner. The numbers of the hit, and whether it is in the ray's range, are then computed in float64 from vertices and rays as
    they were given. Coordinates near 4e6 with details of a millimetre, or parts of a size of 1e-20, are as good as any.

    All methods for rays take

    origins, directions: shape (..., 3), float32 or float64, with any strides; one origin or direction for all rays has shape
        (3,). They are not copied. Directions need not be unit vectors: t is in units of their lengths.
    t_min, t_max: hits count where t_min < t < t_max; one number for all rays, or an array of the rays' shape.
    mask: sees only what has a bit in common with it; without one, everything.
    faces: "both", "front" (where vertices are seen counter-clockwise, and spheres from outside) or "back".
    invalid: what happens with rays that make no sense (a NaN, an infinite coordinate, a direction of zero): "raise" Error, or
        "miss".
    threads: at most so many; None for all cores. Results do not depend on it.

    and return arrays of shape (...). They release the GIL while they work, may be called from several threads at once, and stop at
    Ctrl-C. A tree can be copied (copies share memory) and pickled (it is built again), and be used after a fork.

    They raise Error, which is a ValueError, for shapes and numbers that make no sense, and TypeError for what are not numbers.
    """

    _tree: Tree
    _instances: tuple[Instance, ...]
    _quality: Quality
    _version: int

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        masks: int | ArrayLike | None = None,
        quality: Quality = "balanced",
        threads: int | None = None,
    ) -> None:
        self._build([Triangles(vertices, faces, masks)._item("")], (), quality, threads)

    @classmethod
    def from_geometries(
        cls,
        geometries: Iterable[Triangles | Spheres | Instance],
        *,
        quality: Quality = "balanced",
        threads: int | None = None,
    ) -> Bvh:
        """A tree of several geometries: `Triangles`, `Spheres`, and instances of other trees.

        `geometry` of a hit counts triangles and spheres in their order, `instance` counts instances in theirs. In an instance,
        `geometry` is that in the instance's tree.

        Raises Error for geometry that makes no sense, for a matrix without an inverse, and for an instance of a tree that holds
        instances itself.
        """
        items, instances = [], []
        for number, geometry in enumerate(geometries):
            if not isinstance(geometry, (Triangles, Spheres, Instance)):
                raise TypeError(
                    f"geometries[{number}] is {type(geometry).__name__}, but Triangles, Spheres or Instance is expected"
                )
            if isinstance(geometry, Instance):
                # As it is now, even if it is refitted later.
                geometry = Instance(geometry.bvh.__copy__(), np.array(geometry.matrix), geometry.mask)
                instances.append(geometry)
            items.append(geometry._item(f"geometries[{number}]."))
        bvh = cls.__new__(cls)
        bvh._build(items, tuple(instances), quality, threads)
        return bvh

    def _build(
        self,
        items: list[tuple[Any, ...]],
        instances: tuple[Instance, ...],
        quality: Quality,
        threads: int | None,
    ) -> None:
        _arrays.one_of(quality, "quality", "fast", "balanced", "best")
        self._tree = Tree(items, quality, _arrays.thread_count(threads))
        self._instances, self._quality, self._version = instances, quality, 0

    def closest_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        mask: int | None = None,
        faces: Faces = "both",
        invalid: Invalid = "raise",
        threads: int | None = None,
    ) -> Hits:
        """The first hit of each ray: see `Hits` for what is in it, and `Bvh` for the arguments.

        Of hits at equal t it is that with the lowest numbers. Surfaces that are nearer to one another than the rounding (see
        `Bvh`) may be found in either order.
        """
        rays, shape = self._rays(origins, directions, t_min, t_max, mask, faces, invalid, threads)
        return Hits(self, self._tree.closest_hits(rays), shape, rays[:2])

    def closest_primitives(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        mask: int | None = None,
        faces: Faces = "both",
        invalid: Invalid = "raise",
        threads: int | None = None,
    ) -> NDArray[np.int32]:
        """`closest_hits(...).primitive`, but faster: only which triangle or sphere each ray hits first; -1 for a miss."""
        rays, shape = self._rays(origins, directions, t_min, t_max, mask, faces, invalid, threads)
        return self._tree.closest_primitives(rays).reshape(shape)

    def occluded(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        mask: int | None = None,
        faces: Faces = "both",
        invalid: Invalid = "raise",
        threads: int | None = None,
    ) -> NDArray[np.bool_]:
        """Whether each ray hits anything. With `target - origin` as direction and t_max = 1: whether anything is between."""
        rays, shape = self._rays(origins, directions, t_min, t_max, mask, faces, invalid, threads)
        return self._tree.occluded(rays).reshape(shape)

    def all_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        crossings: bool = False,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        mask: int | None = None,
        faces: Faces = "both",
        invalid: Invalid = "raise",
        threads: int | None = None,
    ) -> AllHits:
        """All hits of each ray, sorted by t: see `AllHits`.

        An edge belongs to both of its triangles: a ray through it hits both. With `crossings` each time that the ray crosses the
        surface counts once: it has the hits of a ray that is moved aside by an infinitely small amount. So it hits one of two
        triangles on different sides of it, and both or neither of two on the same side, whose edge it touches. A ray crosses a
        closed mesh an odd number of times if it starts inside, and an even number of times if it starts outside.
        """
        rays, _ = self._rays(origins, directions, t_min, t_max, mask, faces, invalid, threads)
        offsets, arrays = self._tree.all_hits(rays, crossings)
        return AllHits(self, offsets, arrays, rays[:2])

    def count_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        crossings: bool = False,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        mask: int | None = None,
        faces: Faces = "both",
        invalid: Invalid = "raise",
        threads: int | None = None,
    ) -> NDArray[np.int64]:
        """The number of hits of each ray, as `all_hits` finds them, in less memory."""
        rays, shape = self._rays(origins, directions, t_min, t_max, mask, faces, invalid, threads)
        return self._tree.count_hits(rays, crossings).reshape(shape)

    def closest_points(
        self, points: ArrayLike, *, max_distance: float = np.inf, threads: int | None = None
    ) -> ClosestPoints:
        """The points of surfaces that are closest to points: see `ClosestPoints`.

        points: shape (..., 3), finite.
        max_distance: points that are farther away do not count.

        Distances are right to about 1e-15 of the size of what is in the tree. Of several closest points it is that with the
        lowest numbers.
        """
        rows, shape = _arrays.points(points, "points")
        if not max_distance >= 0.0:
            raise Error(f"max_distance is {max_distance}, but it must not be negative or NaN")
        positions, arrays = self._tree.closest_points(
            rows, float(max_distance), _arrays.thread_count(threads)
        )
        return ClosestPoints(self, positions, arrays, shape)

    def signed_distance(self, points: ArrayLike, *, threads: int | None = None) -> NDArray[np.float64]:
        """The distances of points, shape (..., 3), from the closest surface: negative for points inside, as `contains` has it."""
        distance = self.closest_points(points, threads=threads).distance
        return np.where(self.contains(points, threads=threads), -distance, distance)

    def contains(self, points: ArrayLike, *, threads: int | None = None) -> NDArray[np.bool_]:
        """Whether points, shape (..., 3), are inside.

        Where all meshes are closed (`is_closed`), a point is inside if a ray from it crosses surfaces an odd number of times.
        Crossings at edges and corners are counted rightly (see `all_hits`), so one ray is enough. Where meshes overlap, what is in
        two of them is outside.

        Where a mesh is not closed, a point is inside if the magnitude of its winding number is greater than 1/2: see
        `winding_numbers`. Then the directions of triangles matter. It takes longer the more edges are open.

        On the surface, and nearer to it than 1e-6 of half the size of the tree, the answer may be either. Raises Error where open
        meshes are in instances, or in one tree with spheres or instances.
        """
        rows, shape = _arrays.points(points, "points")
        return self._tree.contains(rows, _arrays.thread_count(threads)).reshape(shape)

    def winding_numbers(self, points: ArrayLike, *, threads: int | None = None) -> NDArray[np.float64]:
        """How often meshes go around points, shape (..., 3): 1 in a closed mesh whose fronts are outside, 0 outside of it.

        In and around an open mesh it is the sum of the solid angles of triangles, with signs, divided by 4 pi, as by Jacobson,
        Kavan and Sorkine-Hornung (2013): 1/2 at a hole, and then less. The error is about 1e-6 there. Raises Error as `contains`.
        """
        rows, shape = _arrays.points(points, "points")
        return self._tree.winding_numbers(rows, _arrays.thread_count(threads)).reshape(shape)

    def refit(
        self,
        points: ArrayLike,
        *,
        radii: float | ArrayLike | None = None,
        geometry: int = 0,
        threads: int | None = None,
    ) -> None:
        """Moves a geometry: much faster than a new tree, but rays are slower after large motions relative to one another.

        points: the new vertices of triangles or centers of spheres, as many as before, shape (n, 3).
        radii: the radii of spheres.
        geometry: its number in this tree.

        Copies of the tree, and trees that hold instances of it, stay as they are. Where the tree cannot follow it is built anew:
        where it is shared with copies, where its size changes by much, where triangles lose or gain their area.
        """
        rows, _ = _arrays.points(points, "points")
        _arrays.finite(rows, "points")
        has_spheres, count, _ = self._shape(geometry)
        if has_spheres != (radii is not None):
            raise Error(
                f"geometry {geometry} has {'spheres, which need' if has_spheres else 'triangles, which have no'} radii"
            )
        if len(rows) != count:
            raise Error(f"points has {len(rows)} rows, but geometry {geometry} has {count}")
        of_spheres = None if radii is None else _radii(radii, "radii", len(rows))
        self._tree.refit(geometry, rows, of_spheres, _arrays.thread_count(threads))
        self._version += 1

    @property
    def is_closed(self) -> bool:
        """True if each edge belongs to an even number of triangles, so that meshes have an inside. Vertices at equal positions
        (as rounded for the tree) count as one."""
        return self._tree.is_closed()

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The least and the greatest coordinates, shape (2, 3); of instances those of the box around their box. NaN if there is
        nothing."""
        bounds = self._tree.bounds
        return np.full((2, 3), np.nan) if bounds is None else np.array(bounds)

    @property
    def statistics(self) -> Statistics:
        """Numbers of primitives, and memory."""
        return Statistics(*self._tree.statistics)

    @property
    def geometries(self) -> tuple[Triangles | Spheres | Instance, ...]:
        """What the tree is made of: copies, from which `from_geometries` makes the same tree."""
        parts: list[Triangles | Spheres | Instance] = []
        for number in range(len(self._tree.shapes)):
            points, other, masks = self._tree.geometry(number)
            parts.append(
                Triangles(points, other, masks) if other.ndim == 2 else Spheres(points, other, masks)
            )
        return (*parts, *self._instances)

    def __copy__(self) -> Bvh:
        bvh = type(self).__new__(type(self))
        bvh._tree, bvh._instances = self._tree.clone(), self._instances
        bvh._quality, bvh._version = self._quality, 0
        return bvh

    def __deepcopy__(self, memo: dict[int, Any]) -> Bvh:
        return self.__copy__()

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (type(self), self.geometries, self._quality)

    def __repr__(self) -> str:
        counts = self.statistics
        return f"<Bvh: {counts.triangles} triangles, {counts.spheres} spheres, {counts.instances} instances>"

    def _rays(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike,
        t_max: ArrayLike,
        mask: int | None,
        faces: str,
        invalid: str,
        threads: int | None,
    ) -> tuple[tuple[Any, ...], Shape]:
        """The rays of a query, checked, as the compiled module takes them, and the shape that results have."""
        from_rows: Floats
        from_rows, to_rows, shape = _arrays.rows_together(("origins", origins), ("directions", directions))
        return (
            from_rows,
            to_rows,
            _arrays.each(t_min, "t_min", shape),
            _arrays.each(t_max, "t_max", shape),
            None if mask is None else _arrays.bits(mask, "mask"),
            _arrays.one_of(faces, "faces", "both", "front", "back"),
            _arrays.one_of(invalid, "invalid", "raise", "miss") == "raise",
            shape[-1] if len(shape) > 1 else 0,
            _arrays.thread_count(threads),
        ), shape

    def _shape(self, geometry: int) -> tuple[bool, int, int]:
        """Whether a geometry has spheres, the number of its vertices or centers, and that of its primitives."""
        shapes = self._tree.shapes
        if not 0 <= geometry < len(shapes):
            raise Error(f"geometry is {geometry}, but there are {len(shapes)}, counted from 0")
        return shapes[geometry]

    def _has_spheres(self) -> bool:
        own = any(has_spheres for has_spheres, _, _ in self._tree.shapes)
        return own or any(instance.bvh._has_spheres() for instance in self._instances)


def _unpickled(cls: type[Bvh], geometries: tuple[Any, ...], quality: Quality) -> Bvh:
    return cls.from_geometries(geometries, quality=quality)
