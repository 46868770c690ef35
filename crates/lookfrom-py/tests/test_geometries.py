"""Spheres, instances, masks and motion, against what they stand for."""

import numpy as np
import pytest

import lookfrom
from lookfrom import Bvh, Error, Instance, Spheres, Triangles
from meshes import box, brute_force, icosphere, soup


def random_rays(seed, count=2000):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (count, 3)), rng.normal(size=(count, 3))


def random_map(rng):
    matrix = np.eye(4)
    matrix[:3, :3] = rng.normal(size=(3, 3)) * 10 ** rng.uniform(-0.5, 0.5)
    matrix[:3, 3] = rng.uniform(-1, 1, 3)
    return matrix


def test_spheres_against_the_quadratic():
    rng = np.random.default_rng(1)
    centers, radii = rng.uniform(-1, 1, (50, 3)), rng.uniform(0.02, 0.4, 50)
    origins, directions = random_rays(2)
    f = centers - origins[:, None]
    a, b = (directions**2).sum(axis=1)[:, None], np.einsum("rsi,ri->rs", f, directions)
    discriminant = b**2 - a * ((f**2).sum(axis=2) - radii**2)
    # Tangents may be decided either way.
    clear = (np.abs(discriminant) > 1e-4).all(axis=1)
    root = np.sqrt(np.where(discriminant > 0, discriminant, np.nan))
    roots = np.stack([(b - root) / a, (b + root) / a], axis=2)
    slow = np.where(roots > 0, roots, np.inf)[clear]
    origins, directions = origins[clear], directions[clear]

    bvh = Bvh.from_geometries([Spheres(centers, radii)])
    hits = bvh.closest_hits(origins, directions)
    np.testing.assert_allclose(hits.t, slow.min(axis=(1, 2)), rtol=1e-9)
    assert (hits.primitive[hits.hit] == slow.min(axis=2).argmin(axis=1)[hits.hit]).all()
    assert (bvh.count_hits(origins, directions) == np.isfinite(slow).sum(axis=(1, 2))).all()
    out = (hits.points - centers[hits.primitive])[hits.hit] / radii[hits.primitive[hits.hit], None]
    np.testing.assert_allclose(hits.normals[hits.hit], out, atol=1e-12)
    every = bvh.all_hits(origins, directions)
    np.testing.assert_allclose(
        every.points, origins[every.ray] + every.t[:, None] * directions[every.ray], atol=1e-9
    )

    points = rng.uniform(-2, 2, (500, 3))
    distances = np.abs(np.linalg.norm(points[:, None] - centers, axis=2) - radii)
    found = bvh.closest_points(points)
    np.testing.assert_allclose(found.distance, distances.min(axis=1), atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(found.points - points, axis=1), found.distance, atol=1e-14)
    assert (found.primitive == distances.argmin(axis=1)).all()
    np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1)
    inside = (np.linalg.norm(points[:, None] - centers, axis=2) < radii).sum(axis=1) % 2 == 1
    assert (bvh.contains(points) == inside).all()


def test_geometries_are_numbered_and_masked():
    vertices, faces = soup(np.random.default_rng(3), 60)
    halves = [Triangles(vertices, faces[:30], masks=0b01), Triangles(vertices, faces[30:], masks=0b10)]
    whole, divided = Bvh(vertices, faces), Bvh.from_geometries(halves)
    origins, directions = random_rays(4)
    one, other = whole.closest_hits(origins, directions), divided.closest_hits(origins, directions)
    assert (one.t == other.t).all()
    assert (np.where(one.hit, other.geometry * 30 + other.triangle, -1) == one.triangle).all()
    assert (other.instance == -1).all() and (one.geometry == np.where(one.hit, 0, -1)).all()
    for mask, some in ((0b01, faces[:30]), (0b10, faces[30:])):
        seen = divided.closest_hits(origins, directions, mask=mask)
        np.testing.assert_allclose(
            seen.t, brute_force(vertices, some, origins, directions).min(axis=1), rtol=1e-9
        )
    assert not divided.occluded(origins, directions, mask=0b100).any()
    colours = np.random.default_rng(5).uniform(size=(len(vertices), 4))
    of_first = other.interpolate(colours, geometry=1)
    assert (np.isnan(of_first).all(axis=1) == (other.geometry != 1)).all()


def test_instances_are_as_their_meshes_moved():
    rng = np.random.default_rng(6)
    vertices, faces = soup(rng, 40)
    vertices = 1e-3 * vertices + (50.0, 60.0, 70.0)
    small = Bvh(vertices, faces)
    back = np.linalg.inv(np.block([[1e-3 * np.eye(3), np.array([[50.0, 60.0, 70.0]]).T], [np.zeros(3), 1.0]]))
    maps = [random_map(rng) @ back for _ in range(5)]
    maps[1][:3, :3] = -maps[1][:3, :3]
    maps[1][:3, 3] = 0.1 - maps[1][:3, :3] @ (50.0, 60.0, 70.0)
    moved = np.concatenate([vertices @ m[:3, :3].T + m[:3, 3] for m in maps])
    all_faces = np.concatenate([faces + len(vertices) * i for i in range(5)])
    bvh = Bvh.from_geometries([Instance(small, m, mask=1 << i) for i, m in enumerate(maps)])
    flat = Bvh(moved, all_faces)
    origins, directions = random_rays(7)
    one, other = flat.closest_hits(origins, directions), bvh.closest_hits(origins, directions)
    agree = np.where(other.hit, other.instance * 40 + other.triangle, -1) == one.triangle
    # Rays near edges may differ: the roundings of the two are not the same.
    assert agree.mean() > 0.998
    np.testing.assert_allclose(other.t[agree], one.t[agree], rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(other.points[agree], one.points[agree], atol=1e-8)
    seen = bvh.closest_hits(origins, directions, mask=0b1000)
    assert set(np.unique(seen.instance)) == {-1, 3}
    near, near_flat = bvh.closest_points(origins[:200]), flat.closest_points(origins[:200])
    np.testing.assert_allclose(near.distance, near_flat.distance, atol=1e-10)
    np.testing.assert_allclose(near.points, near_flat.points, atol=1e-8)
    # The normals of objects, which a reflection turns over in the world.
    signs = np.array([np.sign(np.linalg.det(m[:3, :3])) for m in maps])
    expected = one.normals * np.where(other.hit, signs[other.instance], 1)[:, None]
    np.testing.assert_allclose(other.normals[agree & one.hit], expected[agree & one.hit], atol=1e-7)


def test_an_instance_is_of_the_tree_as_it_was():
    vertices, faces = box(2.0)
    bvh = Bvh(vertices, faces)
    world = Bvh.from_geometries([Instance(bvh, np.eye(4))])
    bvh.refit(3 * vertices)
    assert bvh.closest_hits((9, 0, 0), (-1, 0, 0)).t.item() == 6
    assert world.closest_hits((9, 0, 0), (-1, 0, 0)).t.item() == 8
    with pytest.raises(Error, match="two levels only"):
        Bvh.from_geometries([Instance(world, np.eye(4))])
    with pytest.raises(Error, match="no inverse"):
        Bvh.from_geometries([Instance(bvh, np.diag([1.0, 0.0, 1.0, 1.0]))])
    with pytest.raises(Error, match="last row"):
        Bvh.from_geometries([Instance(bvh, np.ones((4, 4)))])


@pytest.mark.parametrize("motion", [1e-3, 0.1, 100.0, 1e-6])
def test_a_refitted_tree_answers_as_a_new_one(motion):
    rng = np.random.default_rng(8)
    vertices, faces = soup(rng, 200)
    other = Spheres(rng.uniform(-0.5, 0.5, (20, 3)), rng.uniform(0.01, 0.1, 20))
    bvh = Bvh.from_geometries([Triangles(vertices, faces), other])
    old = bvh.closest_hits((0, 0, 3), (0, 0, -1))
    # The last motions change the size, so that the tree is built anew; the flat triangle loses its area.
    shrink = motion if motion == 1e-6 else 1.0
    moved = shrink * vertices if shrink < 1.0 else vertices + motion * rng.normal(size=vertices.shape)
    centers = shrink * (other.centers + 0.01)
    if motion == 0.1:
        moved[faces[7]] = moved[faces[7][0]]
    bvh.refit(moved)
    bvh.refit(centers, radii=0.02 * shrink, geometry=1)
    new = Bvh.from_geometries([Triangles(moved, faces), Spheres(centers, 0.02 * shrink)])
    origins, directions = random_rays(9)
    for near in (origins, motion * origins):
        one, two = bvh.closest_hits(near, directions), new.closest_hits(near, directions)
        same = one.primitive == two.primitive
        assert same.mean() > 0.998
        np.testing.assert_allclose(one.t[same], two.t[same], rtol=1e-9)
    np.testing.assert_array_equal(bvh.bounds, new.bounds)
    with pytest.raises(Error, match="refitted after this query"):
        _ = old.points
    with pytest.raises(Error, match="has 599 rows, but geometry 0 has 600"):
        bvh.refit(moved[1:])
    with pytest.raises(Error, match="spheres, which need radii"):
        bvh.refit(other.centers, geometry=1)
    with pytest.raises(Error, match="there are 2, counted from 0"):
        bvh.refit(moved, geometry=2)


def test_empty_trees():
    for bvh in (Bvh(np.zeros((0, 3)), []), Bvh([], []), Bvh.from_geometries([])):
        assert not bvh.closest_hits(*random_rays(1)).hit.any()
        assert not bvh.contains(np.zeros((5, 3))).any()
        assert np.isinf(bvh.closest_points((1, 2, 3)).distance)
        assert np.isnan(bvh.bounds).all() and bvh.is_closed
        assert bvh.all_hits(*random_rays(1)).points.shape == (0, 3)
        assert bvh.closest_hits(np.zeros((0, 3)), np.zeros((0, 3))).t.shape == (0,)


def test_triangles_without_area_are_left_out():
    bvh = Bvh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2), (0, 0, 1), (1, 1, 1)])
    assert bvh.statistics.triangles == 1 and bvh.statistics.left_out == 2
    assert bvh.closest_hits((0.2, 0.2, 1), (0, 0, -1)).triangle.item() == 0


def test_geometries_make_the_same_tree():
    rng = np.random.default_rng(10)
    vertices, faces = icosphere(1)
    ball = Bvh(vertices, faces)
    parts = [
        Triangles(vertices, faces, masks=rng.integers(0, 2**32, len(faces))),
        Spheres(rng.normal(size=(3, 3)), 0.1, masks=7),
        Instance(ball, random_map(rng), mask=3),
    ]
    bvh = Bvh.from_geometries(parts)
    again = Bvh.from_geometries(bvh.geometries)
    origins, directions = random_rays(11)
    for mask in (None, 1, 4):
        one, two = (b.closest_hits(origins, directions, mask=mask) for b in (bvh, again))
        assert (one.t == two.t).all() and (one.instance == two.instance).all()
    assert lookfrom.Bvh is Bvh and "3 spheres" in repr(bvh)
