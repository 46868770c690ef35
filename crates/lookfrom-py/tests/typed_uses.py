"""Uses of the package as a type checker sees them: `mypy` and `pyright` read this, nothing runs it."""

from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import lookfrom
import lookfrom.trimesh

bvh = lookfrom.Bvh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], np.zeros((1, 3), np.int64), masks=1)
hits = bvh.closest_hits((0, 0, 1), np.ones((4, 3), np.float32), t_max=2.0, faces="front", threads=1)
assert_type(hits, lookfrom.Hits)
assert_type(hits.t, NDArray[np.float64])
assert_type(hits.triangle, NDArray[np.int32])
assert_type(hits.points, NDArray[np.float64])
assert_type(bvh.occluded((0, 0, 1), (0, 0, -1)), NDArray[np.bool_])
assert_type(bvh.all_hits((0, 0, 1), (0, 0, -1)).offsets, NDArray[np.int64])
assert_type(bvh.closest_points((0, 0, 1)).distance, NDArray[np.float64])
assert_type(bvh.contains((0, 0, 1)), NDArray[np.bool_])
world = lookfrom.Bvh.from_geometries(
    [
        lookfrom.Triangles(np.zeros((3, 3)), [(0, 1, 2)]),
        lookfrom.Spheres([(0, 0, 0)], 1.0),
        lookfrom.Instance(bvh, np.eye(4)),
    ]
)
assert_type(world, lookfrom.Bvh)
assert_type(world.cast_rays(np.zeros((5, 6)))["t_hit"], NDArray[np.generic])
origin, directions = lookfrom.pinhole_rays(
    8, 8, fov=40, world_from_camera=lookfrom.look_at((1, 1, 1), (0, 0, 0))
)
assert_type(directions, NDArray[np.float64])
ray = lookfrom.trimesh.RayMeshIntersector(object())
assert_type(ray.intersects_first([(0, 0, 0)], [(0, 0, 1)]), NDArray[np.int64])
session = lookfrom.Session({}, samples=np.int64(4), fov=np.float32(30), size=(np.uint8(8), 8), keep=True)
session.set_camera(np.eye(4), intrinsics=[[8, 0, 4], [0, 8, 4], [0, 0, 1]], convention="opengl")
assert_type(session.labels().depth, NDArray[np.float64])
