"""Do the queries for rays answer as every ray against every triangle does?"""

import numpy as np
import pytest

import lookfrom
from meshes import box, brute_force, clear_of_edges, every_triangle, icosphere, soup


@pytest.fixture(scope="module")
def scene():
    rng = np.random.default_rng(5)
    vertices, faces = soup(rng, 300)
    origins, directions = rng.uniform(-1, 1, (3000, 3)), rng.normal(size=(3000, 3))
    clear = clear_of_edges(vertices, faces, origins, directions)
    assert clear.mean() > 0.9
    return vertices, faces, origins[clear], directions[clear], lookfrom.Bvh(vertices, faces)


@pytest.mark.parametrize(("t_min", "t_max"), [(0.0, np.inf), (0.2, 0.5), (-1.0, 0.3), (-np.inf, np.inf)])
def test_queries_answer_as_brute_force(scene, t_min, t_max):
    vertices, faces, origins, directions, bvh = scene
    slow = brute_force(vertices, faces, origins, directions, t_min, t_max)
    limits = {"t_min": t_min, "t_max": t_max}
    first = np.where(np.isinf(slow.min(axis=1)), -1, slow.argmin(axis=1))
    assert np.count_nonzero(first < 0) > 100 and np.count_nonzero(first >= 0) > 100

    hits = bvh.closest_hits(origins, directions, **limits)
    assert (hits.triangle == first).all()
    assert (hits.hit == (first >= 0)).all()
    np.testing.assert_allclose(hits.t, slow.min(axis=1), rtol=1e-11, atol=1e-13)
    _, u, v = every_triangle(vertices, faces, origins, directions)
    rows = np.flatnonzero(hits.hit)
    np.testing.assert_allclose(hits.u[rows], u[rows, first[rows]], atol=1e-9)
    np.testing.assert_allclose(hits.v[rows], v[rows, first[rows]], atol=1e-9)
    np.testing.assert_allclose(hits.points[rows], (origins + hits.t[:, None] * directions)[rows], atol=1e-11)
    assert np.isnan(hits.points[~hits.hit]).all() and np.isnan(hits.barycentrics[~hits.hit]).all()
    np.testing.assert_allclose(
        np.einsum("rk,rki->ri", hits.barycentrics, vertices[faces[hits.triangle]])[rows],
        hits.points[rows],
        atol=1e-14,
    )
    assert (bvh.closest_primitives(origins, directions, **limits) == first).all()
    assert (bvh.occluded(origins, directions, **limits) == hits.hit).all()

    counts = np.isfinite(slow).sum(axis=1)
    for crossings in (False, True):
        assert (bvh.count_hits(origins, directions, crossings=crossings, **limits) == counts).all()
        every = bvh.all_hits(origins, directions, crossings=crossings, **limits)
        assert (every.counts == counts).all() and len(every) == counts.sum()
        order = np.argsort(slow, axis=1, kind="stable")
        assert (
            every.triangle == np.concatenate([row[:n] for row, n in zip(order, counts, strict=True)])
        ).all()
        np.testing.assert_allclose(every.t, slow[every.ray, every.triangle], rtol=1e-11, atol=1e-13)
        np.testing.assert_allclose(
            every.points, origins[every.ray] + every.t[:, None] * directions[every.ray], atol=1e-11
        )


def test_faces_select_fronts_or_backs(scene):
    vertices, faces, origins, directions, bvh = scene
    a, b, c = vertices[faces].swapaxes(0, 1)
    front = np.einsum("ti,ri->rt", np.cross(b - a, c - a), directions) < 0
    slow = brute_force(vertices, faces, origins, directions)
    for name, seen in (("front", front), ("back", ~front)):
        expected = np.where(seen, slow, np.inf)
        hits = bvh.closest_hits(origins, directions, faces=name)
        np.testing.assert_allclose(hits.t, expected.min(axis=1), rtol=1e-11)
        assert (bvh.count_hits(origins, directions, faces=name) == np.isfinite(expected).sum(axis=1)).all()
        assert (bvh.occluded(origins, directions, faces=name) == hits.hit).all()


def test_masks_of_triangles(scene):
    vertices, faces, origins, directions, _ = scene
    masks = 1 << (np.arange(len(faces)) % 3)
    bvh = lookfrom.Bvh(vertices, faces, masks=masks)
    slow = brute_force(vertices, faces, origins, directions)
    for mask in (0b001, 0b110, 0b1000):
        expected = np.where(masks & mask, slow, np.inf).min(axis=1)
        np.testing.assert_allclose(bvh.closest_hits(origins, directions, mask=mask).t, expected, rtol=1e-11)


def test_ranges_differ_by_ray(scene):
    vertices, faces, origins, directions, bvh = scene
    rng = np.random.default_rng(6)
    t_min = rng.uniform(0, 0.3, len(origins))
    t_max = t_min + rng.uniform(0, 0.5, len(origins))
    slow = brute_force(vertices, faces, origins, directions)
    slow = np.where((slow > t_min[:, None]) & (slow < t_max[:, None]), slow, np.inf)
    np.testing.assert_allclose(
        bvh.closest_hits(origins, directions, t_min=t_min, t_max=t_max).t, slow.min(axis=1), rtol=1e-11
    )


def test_no_ray_slips_through_an_edge_or_a_vertex():
    vertices, faces = icosphere(7)
    bvh = lookfrom.Bvh(vertices, faces)
    edges = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    for targets in (vertices, vertices[edges].mean(axis=1)):
        assert bvh.closest_hits((0, 0, 0), targets).hit.all()
        assert bvh.occluded((0, 0, 0), targets).all()
        # From another point, so that no origin is shared.
        rng = np.random.default_rng(7)
        origins = rng.uniform(-0.3, 0.3, targets.shape)
        assert bvh.closest_hits(origins, targets - origins).hit.all()
        assert (bvh.count_hits(origins, targets - origins, crossings=True) == 1).all()
    assert len(vertices) == 163_842


def test_crossings_count_shared_edges_once():
    vertices, faces = box(2.0)
    bvh = lookfrom.Bvh(vertices, faces)
    # Along all diagonals, through edges and corners.
    steps = np.array(np.meshgrid(*[np.arange(-2, 3)] * 3)).reshape(3, -1).T
    directions = steps[np.abs(steps).sum(axis=1) > 0].astype(float)
    assert (bvh.count_hits((0, 0, 0), directions, crossings=True) == 1).all()
    assert (bvh.count_hits((0, 0, 0), directions) > 1).any()
    through = bvh.count_hits(-3 * directions, directions, crossings=True)
    assert (through == 2).all()
    # Rays that touch edges from outside.
    touching = bvh.count_hits(
        [(-5.0, 1.0, 1.0), (-5.0, 1.0, 0.5), (3.0, -1.0, 0.0)],
        [(1, 0, 0), (1, 0, 0), (-1, 1, 0)],
        crossings=True,
    )
    assert (touching % 2 == 0).all()


def test_normals_and_interpolated_values():
    vertices, faces = icosphere(3)
    bvh = lookfrom.Bvh(vertices, faces)
    rng = np.random.default_rng(8)
    directions = rng.normal(size=(40, 50, 3))
    hits = bvh.closest_hits((0, 0, 0), directions)
    assert hits.t.shape == (40, 50) and hits.points.shape == hits.normals.shape == (40, 50, 3)
    np.testing.assert_allclose(np.linalg.norm(hits.normals, axis=-1), 1)
    assert (np.einsum("...i,...i", hits.normals, directions) > 0).all()
    np.testing.assert_allclose(hits.interpolate(vertices), hits.points, atol=1e-14)
    np.testing.assert_allclose(hits.interpolate(vertices[:, 0]), hits.points[..., 0], atol=1e-14)
    with pytest.raises(lookfrom.Error, match="one row for each of 642 vertices"):
        hits.interpolate(vertices[1:])


def test_pictures_are_cast_in_tiles_with_the_same_results():
    vertices, faces = icosphere(4)
    bvh = lookfrom.Bvh(vertices, faces)
    place = lookfrom.look_at((3, 1, 2), (0, 0, 0))
    for width, height in ((203, 61), (1030, 17), (9, 300), (128, 128), (8, 8)):
        origin, directions = lookfrom.pinhole_rays(width, height, fov=50, world_from_camera=place)
        rows = directions.reshape(-1, 3)
        picture, row = bvh.closest_hits(origin, directions), bvh.closest_hits(origin, rows)
        assert (picture.triangle.reshape(-1) == row.triangle).all()
        assert (picture.t.reshape(-1) == row.t).all()
        assert (bvh.closest_primitives(origin, directions) == picture.triangle).all()
        assert (bvh.occluded(origin, directions) == picture.hit).all()
        assert (bvh.count_hits(origin, directions).reshape(-1) == bvh.count_hits(origin, rows)).all()
        assert (bvh.all_hits(origin, directions).t == bvh.all_hits(origin, rows).t).all()


def test_results_do_not_depend_on_threads():
    vertices, faces = icosphere(5)
    trees = [lookfrom.Bvh(vertices, faces, threads=threads) for threads in (1, 2, 5)]
    rng = np.random.default_rng(9)
    origins, directions = rng.normal(size=(20_000, 3)), rng.normal(size=(20_000, 3))
    first = trees[0].closest_hits(origins, directions, threads=1)
    for bvh, threads in zip(trees, (1, 2, 5), strict=True):
        hits = bvh.closest_hits(origins, directions, threads=threads)
        for name in ("t", "u", "v", "primitive", "geometry", "instance", "points", "normals"):
            assert getattr(hits, name).tobytes() == getattr(first, name).tobytes()
        every = bvh.all_hits(origins, directions, threads=threads)
        assert every.t.tobytes() == trees[0].all_hits(origins, directions, threads=1).t.tobytes()
