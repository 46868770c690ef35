"""Do rays of cameras go through the pixels that they should?"""

import numpy as np
import pytest

import lookfrom
from meshes import icosphere


def project(points, intrinsics, world_from_camera):
    """OpenCV's projection: pixels, and depths."""
    local = (points - world_from_camera[:3, 3]) @ world_from_camera[:3, :3]
    pixels = local @ np.asarray(intrinsics).T
    return pixels[:, :2] / pixels[:, 2:], local[:, 2]


def test_points_of_hits_project_to_their_pixels():
    place = lookfrom.look_at((3, -2, 1.5), (0.1, 0, 0))
    k = np.array([(300.0, 2.0, 100.2), (0, 310.0, 79.1), (0, 0, 1)])
    origin, directions = lookfrom.pinhole_rays(200, 160, intrinsics=k, world_from_camera=place)
    hits = lookfrom.Bvh(*icosphere(4)).closest_hits(origin, directions)
    assert 1000 < hits.hit.sum() < hits.hit.size
    pixels, depths = project(hits.points[hits.hit], k, place)
    rows, columns = np.nonzero(hits.hit)
    np.testing.assert_allclose(pixels, np.column_stack([columns, rows]), atol=1e-4)
    np.testing.assert_allclose(depths, hits.t[hits.hit], atol=1e-5)


def test_the_angle_of_view_is_that_of_intrinsics():
    focal = 160 / 2 / np.tan(np.radians(25))
    k = [(focal, 0, 99.5), (0, focal, 79.5), (0, 0, 1)]
    for one, two in zip(
        lookfrom.pinhole_rays(200, 160, fov=50), lookfrom.pinhole_rays(200, 160, intrinsics=k), strict=True
    ):
        np.testing.assert_allclose(one, two, atol=1e-15)


@pytest.mark.parametrize("function", ["pinhole_rays", "orthographic_rays", "panorama_rays"])
def test_conventions_differ_in_axes_only(function):
    arguments = {"pinhole_rays": {"fov": 40.0}, "orthographic_rays": {"size": 2.0}, "panorama_rays": {}}[
        function
    ]
    rays = [
        getattr(lookfrom, function)(
            8,
            6,
            world_from_camera=lookfrom.look_at((1, 2, 3), (0, 0, 0), convention=convention),
            convention=convention,
            **arguments,
        )
        for convention in ("opencv", "opengl")
    ]
    for one, two in zip(*rays, strict=True):
        np.testing.assert_allclose(one, two, atol=1e-15)
    opengl = lookfrom.look_at((0, 0, 5), (0, 0, 0), (0, 1, 0), convention="opengl")
    np.testing.assert_allclose(opengl[:3, :3], np.eye(3), atol=1e-15)


def test_orthographic_rays():
    origins, direction = lookfrom.orthographic_rays(
        40, 20, size=4, world_from_camera=lookfrom.look_at((0, -5, 0), (0, 0, 0))
    )
    np.testing.assert_allclose(direction, (0, 1, 0), atol=1e-15)
    # The top left, and the middle.
    np.testing.assert_allclose(origins[0, 0], (-3.9, -5, 1.9), atol=1e-12)
    np.testing.assert_allclose(origins.mean(axis=(0, 1)), (0, -5, 0), atol=1e-12)


def test_panorama_rays():
    origin, directions = lookfrom.panorama_rays(
        360, 180, world_from_camera=lookfrom.look_at((1, 1, 1), (1, 2, 1))
    )
    np.testing.assert_allclose(np.linalg.norm(directions, axis=2), 1)
    forward, right, up = (
        directions[89:91, 179:181].mean(axis=(0, 1)),
        directions[89:91, 269:271].mean(axis=(0, 1)),
        directions[0].mean(axis=0),
    )
    np.testing.assert_allclose((forward, right, up), ((0, 1, 0), (1, 0, 0), (0, 0, 1)), atol=1e-3)
    np.testing.assert_allclose(origin, (1, 1, 1))
