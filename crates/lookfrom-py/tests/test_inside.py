"""Which points are inside, winding numbers, and distances."""

import numpy as np
import pytest

from lookfrom import Bvh, Error, Instance, Spheres, Triangles
from meshes import box, icosphere, soup


def solid_angles(vertices, faces, points):
    """Winding numbers by the sum over all triangles: the slow, obviously right twin."""
    a, b, c = (vertices[faces][:, i] - points[:, None] for i in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    y = np.einsum("pti,pti->pt", a, np.cross(b, c))
    x = la * lb * lc + (a * b).sum(2) * lc + (b * c).sum(2) * la + (c * a).sum(2) * lb
    return 2 * np.arctan2(y, x).sum(axis=1) / (4 * np.pi)


def brute_closest(vertices, faces, points):
    """Distances by sampling edges and interiors exactly: the least over vertices, edges and planes."""
    best = np.full(len(points), np.inf)
    for a, b, c in vertices[faces]:
        n = np.cross(b - a, c - a)
        inside = np.ones(len(points), bool)
        for p, q in ((a, b), (b, c), (c, a)):
            t = np.clip((points - p) @ (q - p) / ((q - p) @ (q - p)), 0, 1)
            best = np.minimum(best, np.linalg.norm(points - p - t[:, None] * (q - p), axis=1))
            inside &= (points - p) @ np.cross(n, q - p) >= 0
        best = np.where(inside, np.minimum(best, np.abs((points - a) @ n) / np.linalg.norm(n)), best)
    return best


def test_a_ball_contains_what_is_nearer_than_its_faces():
    vertices, faces = icosphere(4)
    bvh = Bvh(vertices, faces)
    assert bvh.is_closed
    rng = np.random.default_rng(1)
    points = rng.uniform(-1.2, 1.2, (20, 1000, 3))
    winding = solid_angles(vertices, faces, points.reshape(-1, 3)[:2000])
    assert (bvh.contains(points).reshape(-1)[:2000] == (winding > 0.5)).all()
    np.testing.assert_allclose(bvh.winding_numbers(points.reshape(-1, 3)[:2000]), winding, atol=1e-9)
    inscribed = np.linalg.norm(vertices[faces].mean(axis=1), axis=1).min()
    radii = np.linalg.norm(points, axis=-1)
    contained = bvh.contains(points)
    assert contained.shape == (20, 1000)
    assert contained[radii < inscribed - 1e-6].all() and not contained[radii > 1 + 1e-6].any()


def test_whole_numbers_make_no_difference():
    # Points from which many rays go through edges and corners.
    cubes = []
    rng = np.random.default_rng(2)
    solid = rng.random((3, 3, 3)) < 0.5
    vertices, faces = box()
    for cell in np.argwhere(solid):
        cubes.append(vertices + cell + 0.5)
    many = np.concatenate(cubes), np.concatenate([faces + 8 * i for i in range(len(cubes))])
    bvh = Bvh(*many)
    cells = np.argwhere(np.ones((3, 3, 3), bool))
    for shift in (0.5, 0.25, 0.75):
        assert (bvh.contains(cells + shift) == solid[tuple(cells.T)]).all()


def test_open_meshes_have_winding_numbers():
    vertices, faces = icosphere(3)
    rng = np.random.default_rng(3)
    points = np.concatenate([rng.uniform(-1.5, 1.5, (2000, 3)), 0.3 * vertices])
    centers = vertices[faces].mean(axis=1)
    for kept in (centers[:, 2] < 0.7, centers[:, 0] > 0, rng.random(len(faces)) < 0.9):
        for some in (faces[kept], faces[kept][:, ::-1]):
            bvh = Bvh(vertices, some)
            assert not bvh.is_closed
            expected = solid_angles(vertices, some, points)
            np.testing.assert_allclose(bvh.winding_numbers(points), expected, atol=2e-6)
            clear = np.abs(np.abs(expected) - 0.5) > 1e-4
            assert (bvh.contains(points) == (np.abs(expected) > 0.5))[clear].all()
    few, several = soup(rng, 30)
    np.testing.assert_allclose(
        Bvh(few, several).winding_numbers(points), solid_angles(few, several, points), atol=2e-6
    )


def test_vertices_in_one_place_are_one():
    vertices, faces = icosphere(2)
    separate = vertices[faces].reshape(-1, 3)
    assert Bvh(separate, np.arange(len(separate)).reshape(-1, 3)).is_closed
    assert not Bvh(vertices, faces[1:]).is_closed


def test_closed_instances_and_open_ones():
    vertices, faces = icosphere(2)
    place = np.diag([2.0, 2.0, 2.0, 1.0])
    ball = Bvh.from_geometries([Instance(Bvh(vertices, faces), place), Spheres([(5, 0, 0)], 1.0)])
    assert ball.contains([(1.5, 0, 0), (2.5, 0, 0), (5.5, 0, 0)]).tolist() == [True, False, True]
    for parts in (
        [Instance(Bvh(vertices, faces[1:]), place)],
        [Triangles(vertices, faces[1:]), Spheres([(5, 0, 0)], 1.0)],
    ):
        with pytest.raises(Error, match="there is no inside"):
            Bvh.from_geometries(parts).contains((0, 0, 0))


def test_distances_against_brute_force():
    rng = np.random.default_rng(4)
    vertices, faces = soup(rng, 60)
    bvh = Bvh(vertices, faces)
    points = rng.uniform(-1, 1, (300, 3))
    found = bvh.closest_points(points)
    np.testing.assert_allclose(found.distance, brute_closest(vertices, faces, points), rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(found.points - points, axis=1), found.distance, atol=1e-14)
    corners = vertices[faces[found.triangle]]
    np.testing.assert_allclose(np.einsum("pk,pki->pi", found.barycentrics, corners), found.points, atol=1e-14)
    some = bvh.closest_points(points, max_distance=0.1)
    assert (some.hit == (found.distance <= 0.1)).all() and np.isinf(some.distance[~some.hit]).all()


@pytest.mark.parametrize(("size", "place"), [(1.0, 0.0), (1.0, 4e6), (1e-20, 0.0), (1e20, 0.0)])
def test_signed_distances_far_away_and_of_all_sizes(size, place):
    vertices, faces = box(2.0)
    bvh = Bvh(size * vertices + place, faces)
    points = np.array([(0, 0, 0), (0.5, 0, 0), (3, 0, 0), (2, 2, 1), (1, 1, 4)], float)
    expected = np.array([-1, -0.5, 2, 2**0.5, 3])
    result = bvh.signed_distance(size * points + place)
    np.testing.assert_allclose(result, size * expected, rtol=1e-13, atol=1e-9 if place else 0)
