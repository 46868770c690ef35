"""Are hits right to float64, wherever meshes are and however large they are?

The bounds of the documentation, held against exact arithmetic: t is that of the triangle's plane with an error of 2**-46 relative
to the products that it is computed from, and the hit is beside the ray by less than 4e-6 of half the tree's extent.
"""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lookfrom
from meshes import box, brute_force, icosphere


def exact(values):
    return [Fraction(float(x)) for x in values]


def plane_error(corners, origin, direction, t):
    """n · (o + t d - a) for the triangle's normal n, exactly, relative to what it is a sum of."""
    a, b, c = (exact(p) for p in corners)
    o, d, t = exact(origin), exact(direction), Fraction(float(t))
    e1 = [x - y for x, y in zip(b, a, strict=True)]
    e2 = [x - y for x, y in zip(c, a, strict=True)]
    pairs = ((1, 2), (2, 0), (0, 1))
    n = [e1[i] * e2[j] - e1[j] * e2[i] for i, j in pairs]
    magnitude = [abs(e1[i] * e2[j]) + abs(e1[j] * e2[i]) for i, j in pairs]
    f = [o[i] + t * d[i] - a[i] for i in range(3)]
    of_f = [abs(o[i] - a[i]) + abs(t * d[i]) for i in range(3)]
    return float(
        abs(sum(x * y for x, y in zip(n, f, strict=True)))
        / sum(x * y for x, y in zip(magnitude, of_f, strict=True))
    )


@settings(max_examples=60, deadline=None)
@given(
    size=st.integers(-60, 60),
    place=st.floats(-1, 7),
    distance=st.floats(-3, 6),
    length=st.integers(-60, 60),
    seed=st.integers(0, 2**32 - 1),
)
def test_t_is_exact_to_rounding(size, place, distance, length, seed):
    # Sizes of 10**-18 to 10**18, at up to 10**7 of their own size from the origin; rays from near and far, of any length.
    rng = np.random.default_rng(seed)
    scale = 2.0**size
    vertices, faces = icosphere(2)
    vertices = scale * (vertices + 10**place * rng.normal(size=3))
    targets = vertices[faces].mean(axis=1)
    origins = targets + scale * 10**distance * rng.normal(size=targets.shape)
    directions = 2.0**length * (targets - origins) / scale
    hits = lookfrom.Bvh(vertices, faces).closest_hits(origins, directions)
    assert hits.hit.all()
    half = np.ptp(vertices, axis=0).max() / 2
    for number in range(0, len(origins), 16):
        corners = vertices[faces[hits.triangle[number]]]
        assert plane_error(corners, origins[number], directions[number], hits.t[number]) < 2.0**-46
    beside = np.linalg.norm(hits.points - (origins + hits.t[:, None] * directions), axis=1)
    rounding = 1e-14 * (np.abs(origins).max() + np.abs(vertices).max())
    assert (beside < 4e-6 * half + rounding).all()


@pytest.mark.parametrize("offset", [0.0, 4e6, 1e9])
def test_details_of_a_millimetre_far_from_the_origin(offset):
    # A terrain of 100 m with waves of a millimetre.
    x, y = np.meshgrid(np.arange(201) * 0.5, np.arange(201) * 0.5, indexing="ij")
    height = 1e-3 * np.sin(3 * x) * np.cos(2 * y)
    vertices = np.stack([x, y, height], axis=-1).reshape(-1, 3) + offset
    number = np.arange(201 * 201).reshape(201, 201)
    a, b, c, d = (n.reshape(-1) for n in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    faces = np.vstack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    bvh = lookfrom.Bvh(vertices, faces)
    rng = np.random.default_rng(3)
    origins = offset + np.column_stack([rng.uniform(1, 99, (2000, 2)), rng.uniform(10, 20, 2000)])
    hits = bvh.closest_hits(origins, (0.0, 0.0, -1.0))
    assert hits.hit.all()
    # Straight down the plane of the triangle that is hit; where the ray passes beside it, by less than 4e-6 of 50 m.
    corners = vertices[faces[hits.triangle]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    above = np.einsum("ri,ri->r", normals, origins - corners[:, 0]) / normals[:, 2]
    np.testing.assert_allclose(hits.t, above, rtol=1e-13)
    assert np.abs(hits.points - (origins - [0, 0, 1] * hits.t[:, None])).max() < 2e-4


@pytest.mark.parametrize("size", [1e-300, 1e-150, 1e-20, 1.0, 1e20, 1e150, 1e300])
def test_tiny_and_huge_parts(size):
    vertices, faces = icosphere(3)
    bvh = lookfrom.Bvh(size * vertices, faces)
    rng = np.random.default_rng(4)
    directions = rng.normal(size=(500, 3))
    hits = bvh.closest_hits((0, 0, 0), directions)
    slow = brute_force(vertices, faces, np.zeros((500, 3)), directions).min(axis=1)
    np.testing.assert_allclose(hits.t, size * slow, rtol=1e-12)
    np.testing.assert_allclose(hits.points, size * slow[:, None] * directions, rtol=1e-9, atol=1e-12 * size)
    np.testing.assert_allclose(np.linalg.norm(hits.normals, axis=1), 1)
    assert bvh.contains(0.5 * size * vertices).all()
    np.testing.assert_allclose(bvh.closest_points(3 * size * vertices).distance, 2 * size, rtol=1e-12)


def test_rays_that_start_on_and_beside_a_surface():
    vertices, faces = icosphere(4)
    bvh = lookfrom.Bvh(vertices, faces)
    rng = np.random.default_rng(5)
    directions = rng.normal(size=(5000, 3))
    surface = bvh.closest_hits((0, 0, 0), directions)
    out = surface.normals
    for step in (1e-3, 1e-6, 1e-9, 1e-12, 1e-14):
        outside, inside = surface.points + step * out, surface.points - step * out
        # Away from the surface, outside: nothing. The surface itself is missed, though it is nearer than f32 can tell.
        assert not bvh.closest_hits(outside, out).hit.any(), step
        assert not bvh.occluded(outside, out).any(), step
        assert (bvh.count_hits(outside, out) == 0).all(), step
        # Back to the surface, and from inside out through it.
        for origins, towards in ((outside, -out), (inside, out)):
            hits = bvh.closest_hits(origins, towards)
            np.testing.assert_allclose(hits.t, step, atol=1e-15)
            assert bvh.occluded(origins, towards, t_max=2 * step).all()
            assert not bvh.occluded(origins, towards, t_max=0.4 * step).any()
        # From inside through the whole ball, not counting the surface behind.
        assert (bvh.closest_hits(inside, -out).t > 0.5).all()
        if step > 1e-7:
            assert bvh.contains(inside).all() and not bvh.contains(outside).any(), step


def test_segments_between_points():
    vertices, faces = box(2.0)
    bvh = lookfrom.Bvh(vertices, faces)
    # The direction's end is just before and just beyond the face at x = 1.
    for end, hit in ((1 - 1e-12, False), (1 + 1e-12, True)):
        assert bvh.occluded((0, 0.1, 0.2), (end, 0, 0), t_max=1.0).item() is hit
        assert bvh.closest_hits((0, 0.1, 0.2), (end, 0, 0), t_max=1.0).hit.item() is hit
        assert bvh.count_hits((0, 0.1, 0.2), (end, 0, 0), t_max=1.0).item() == hit
