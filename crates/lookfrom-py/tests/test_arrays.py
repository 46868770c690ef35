"""Arrays of all kinds: types, strides and shapes give the same results; what makes no sense is said in words, and never a crash."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import lookfrom
from lookfrom import Bvh, Error
from meshes import box, icosphere

VERTICES, FACES = icosphere(2)
BVH = Bvh(VERTICES, FACES)


def strided(array, kind):
    """The same values with other strides, another byte order, or unaligned."""
    if kind == "fortran":
        return np.asfortranarray(array)
    if kind == "reversed":
        return array[::-1].copy()[::-1]
    if kind == "wide":
        wide = np.zeros((*array.shape[:-1], 7), array.dtype)
        wide[..., 1:7:2] = array
        return wide[..., 1:7:2]
    if kind == "skipping":
        twice = np.repeat(array, 2, axis=0)
        return twice[::2]
    if kind == "swapped":
        return array.astype(array.dtype.newbyteorder())
    if kind == "unaligned":
        buffer = np.zeros(array.nbytes + 1, np.uint8)
        view = buffer[1:].view(array.dtype).reshape(array.shape)
        view[...] = array
        return view
    array = array.copy()
    array.flags.writeable = False
    return array


KINDS = ["fortran", "reversed", "wide", "skipping", "swapped", "unaligned", "read-only"]


@settings(max_examples=100, deadline=None)
@given(
    data=st.data(),
    shape=arrays.array_shapes(min_dims=0, max_dims=3, max_side=5),
    dtype=st.sampled_from([np.float32, np.float64, np.float16, np.int8, np.int64, np.uint16]),
    kinds=st.tuples(st.sampled_from(KINDS), st.sampled_from(KINDS)),
)
def test_types_strides_and_shapes_do_not_matter(data, shape, dtype, kinds):
    numbers = st.integers(0, 5) if np.dtype(dtype).kind == "u" else st.integers(-5, 5)
    origins, directions = (data.draw(arrays.arrays(dtype, (*shape, 3), elements=numbers)) for _ in range(2))
    directions[..., 0] += directions[..., 0] == 0
    expected = BVH.closest_hits(
        origins.reshape(-1, 3).astype(np.float64), directions.reshape(-1, 3).astype(np.float64)
    )
    if shape:
        origins, directions = strided(origins, kinds[0]), strided(directions, kinds[1])
    hits = BVH.closest_hits(origins, directions)
    assert hits.t.shape == hits.triangle.shape == shape and hits.points.shape == (*shape, 3)
    assert (hits.t.reshape(-1) == expected.t).all() and (hits.triangle.reshape(-1) == expected.triangle).all()
    assert BVH.occluded(origins, directions).shape == BVH.contains(origins).shape == shape
    assert BVH.closest_points(origins).points.shape == (*shape, 3)
    assert BVH.closest_hits(origins.tolist(), directions.tolist()).t.shape == shape


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_vertices_and_faces_of_all_kinds(kind, dtype):
    rounded = VERTICES.astype(dtype)
    for face_type in (np.int32, np.uint8 if len(VERTICES) < 256 else np.uint16, np.int64, np.uint64):
        bvh = Bvh(strided(rounded, kind), strided(FACES.astype(face_type), kind))
        expected = Bvh(rounded.astype(np.float64), FACES).closest_hits((0, 0, 0), VERTICES + 0.1)
        assert (bvh.closest_hits((0, 0, 0), VERTICES + 0.1).t == expected.t).all()


def test_rows_for_all_rays():
    directions = VERTICES.reshape(2, -1, 3)
    hits = BVH.closest_hits((0, 0, 0), directions)
    assert hits.t.shape == directions.shape[:-1]
    assert (BVH.closest_hits(np.zeros((1, 1, 3)), directions).t == hits.t).all()
    assert (BVH.closest_hits(np.zeros_like(directions), directions).t == hits.t).all()
    assert BVH.closest_hits(VERTICES, (0, 0, 1), t_max=np.linspace(0, 3, len(VERTICES))).t.shape == (
        len(VERTICES),
    )


NAN, INFINITE = np.nan, np.inf
ONE = np.zeros((1, 3))


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (
            lambda: BVH.closest_hits([(0, 0, 0), (0, NAN, 0)], (0, 0, 1)),
            Error,
            r"ray 1: origin is \[0.0, NaN, 0.0\]",
        ),
        (
            lambda: BVH.occluded((0, 0, 0), [(0, 0, INFINITE)]),
            Error,
            r"ray 0: direction is \[0.0, 0.0, inf\]",
        ),
        (lambda: BVH.all_hits((0, 0, 0), (0, 0, 0)), Error, "ray 0: direction is zero"),
        (
            lambda: BVH.count_hits((0, 0, 0), (0, 0, 1), t_max=NAN),
            Error,
            "t_max is NaN, but neither may be NaN",
        ),
        (
            lambda: BVH.closest_hits((0, 0), (0, 0, 1)),
            Error,
            r"origins has shape \(2,\), but \(..., 3\) is expected",
        ),
        (lambda: BVH.closest_hits(np.zeros((4, 3)), np.ones((5, 3))), Error, "do not go together"),
        (lambda: BVH.closest_hits(ONE, ONE + 1, t_min=[0, 0]), Error, r"t_min has shape \(2,\)"),
        (
            lambda: BVH.closest_hits(ONE, ONE + 1j),
            TypeError,
            "directions must be an array of numbers, .* complex128",
        ),
        (lambda: BVH.closest_hits(None, ONE), TypeError, "origins must be an array of numbers, .* object"),
        (lambda: BVH.closest_hits([[1, 2, 3], [4]], ONE), TypeError, "origins must be an array of numbers"),
        (lambda: BVH.closest_hits("abc", ONE), TypeError, "origins must be an array of numbers"),
        (lambda: BVH.closest_hits(ONE, ONE > 1), TypeError, "its type is bool"),
        (lambda: BVH.closest_hits(ONE, ONE + 1, mask=-1), Error, "mask is -1"),
        (lambda: BVH.closest_hits(ONE, ONE + 1, mask=0.5), TypeError, "float"),
        (
            lambda: BVH.closest_hits(ONE, ONE + 1, faces="left"),
            Error,
            "faces is 'left', but one of 'both', 'front'",
        ),
        (lambda: BVH.closest_hits(ONE, ONE + 1, threads=0), Error, "threads is 0"),
        (lambda: BVH.closest_hits(ONE, ONE + 1, threads=1.5), TypeError, "float"),
        (lambda: BVH.closest_points([(0, NAN, 0)]), Error, r"point 0 is \[0.0, NaN, 0.0\]"),
        (lambda: BVH.closest_points(ONE, max_distance=-1), Error, "max_distance is -1"),
        (lambda: BVH.contains([(INFINITE, 0, 0)]), Error, "point 0 is"),
        (lambda: Bvh(VERTICES, FACES - 1), Error, r"faces\[\d+\] is \[.*-1.*\], but there are 162 vertices"),
        (lambda: Bvh(VERTICES, FACES + 1), Error, "but there are 162 vertices, counted from 0"),
        (lambda: Bvh(VERTICES, [(0, 1, 2**40)]), Error, "1099511627776"),
        (
            lambda: Bvh(VERTICES, FACES.astype(float)),
            TypeError,
            "faces must be an array of integers, .* float64",
        ),
        (lambda: Bvh(VERTICES, [(0, 1, 2, 3)]), Error, r"faces has shape \(1, 4\), but \(m, 3\) is expected"),
        (lambda: Bvh(VERTICES[:, :2], FACES), Error, r"vertices has shape \(162, 2\)"),
        (lambda: Bvh([(0, 0, NAN)], []), Error, r"vertices\[0\] is \[0.0, 0.0, nan\]"),
        (lambda: Bvh([(0, 0, 1), (0, -INFINITE, 0)], []), Error, r"vertices\[1\]"),
        (
            lambda: Bvh(VERTICES, FACES, masks=[1, 2]),
            Error,
            r"masks has shape \(2,\), but there are 320 primitives",
        ),
        (lambda: Bvh(VERTICES, [[0, 1, 2], [0, 1]]), TypeError, "faces must be .* rows differ in length"),
        (lambda: Bvh(VERTICES, FACES, masks=2**32), Error, "32 bits"),
        (lambda: Bvh(VERTICES, FACES, quality="good"), Error, "quality is 'good'"),
        (lambda: Bvh.from_geometries([VERTICES]), TypeError, r"geometries\[0\] is ndarray, but Triangles"),
        (lambda: Bvh.from_geometries([lookfrom.Spheres(VERTICES, -1.0)]), Error, r"radii\[0\] is -1.0"),
        (lambda: Bvh.from_geometries([lookfrom.Spheres(VERTICES, [1.0])]), Error, "there are 162 spheres"),
        (lambda: BVH.cast_rays(VERTICES), Error, r"rays has shape \(162, 3\), but \(..., 6\) is expected"),
        (lambda: lookfrom.pinhole_rays(4, 4), Error, "either fov or intrinsics"),
        (lambda: lookfrom.pinhole_rays(0, 4, fov=40), Error, "at least one pixel"),
        (lambda: lookfrom.pinhole_rays(4, 4, fov=180), Error, "between 0 and 180 degrees"),
        (lambda: lookfrom.look_at((1, 1, 1), (1, 1, 1)), Error, "one point"),
        (lambda: lookfrom.look_at((0, 0, 1), (0, 0, 0)), Error, "up is in the line"),
    ],
)
def test_what_makes_no_sense_is_said(call, error, words):
    with pytest.raises(error, match=words):
        call()


def test_rays_that_make_no_sense_may_miss():
    origins = np.array([(0, 0, 0), (NAN, 0, 0), (0, 0, 0), (0, INFINITE, 0), (0, 0, 0)])
    directions = np.array([(0, 0, 1), (0, 0, 1), (0, 0, 0), (0, 0, 1), (0, NAN, 0)])
    hits = BVH.closest_hits(origins, directions, invalid="miss")
    assert hits.hit.tolist() == [True, False, False, False, False]
    assert BVH.occluded(origins, directions, invalid="miss").tolist() == hits.hit.tolist()
    assert BVH.count_hits(origins, directions, invalid="miss", crossings=True).tolist() == [1, 0, 0, 0, 0]


@settings(max_examples=150, deadline=None)
@given(
    origins=arrays.arrays(np.float64, (7, 3), elements=st.floats()),
    directions=arrays.arrays(np.float64, (7, 3), elements=st.floats()),
    limits=st.tuples(st.floats(), st.floats()),
    vertices=arrays.arrays(np.float64, (6, 3), elements=st.floats(allow_nan=False, allow_infinity=False)),
)
def test_no_numbers_crash(origins, directions, limits, vertices):
    bvh = Bvh(vertices, [(0, 1, 2), (3, 4, 5), (0, 3, 5)])
    options = {"t_min": limits[0], "t_max": limits[1], "invalid": "miss"}
    hits = bvh.closest_hits(origins, directions, **options)
    assert not np.isnan(hits.t).any()
    assert ((hits.t > limits[0]) & (hits.t < limits[1]))[hits.hit].all()
    bvh.occluded(origins, directions, **options)
    bvh.count_hits(origins, directions, **options)
    bvh.all_hits(origins, directions, **options)
    _ = hits.points, hits.normals
    finite = np.nan_to_num(origins, nan=0.0, posinf=1.0, neginf=-1.0)
    bvh.closest_points(finite)
    bvh.contains(finite)
    bvh.refit(vertices[::-1])


def test_too_many_rays_are_a_memory_error():
    many = np.broadcast_to(np.ones(3), (10**14, 3))
    with pytest.raises(MemoryError):
        BVH.closest_hits((0, 0, 0), many)
    with pytest.raises(MemoryError):
        BVH.contains(many)


def test_the_compiled_module_checks_types_too():
    from lookfrom import _lookfrom

    vertices, faces = box()
    for items in (
        [(vertices, faces, None)],
        [(vertices[:, :2], faces.astype(np.uint32), None)],
        [()],
        [None],
    ):
        with pytest.raises((TypeError, ValueError)):
            _lookfrom.Tree(items, "balanced", 1)
    with pytest.raises(Error, match="refer to vertex 8"):
        _lookfrom.Tree([(vertices, faces.astype(np.uint32) + 1, None)], "balanced", 1)
    tree = _lookfrom.Tree([(vertices, faces.astype(np.uint32), None)], "balanced", 1)
    with pytest.raises(TypeError):
        tree.closest_hits((vertices, vertices[1:], np.zeros(8), np.zeros(8), None, "both", True, 0, 1))
    wrong = [np.full(1, 99, np.int32), np.zeros(1, np.int32), np.full(1, -1, np.int32)]
    with pytest.raises(Error, match="does not have"):
        tree.points_and_normals((ONE, ONE, [np.zeros(1)] * 3, wrong), 1)


def test_a_broadcast_array_of_more_rows_than_indices():
    vertices = np.broadcast_to(np.zeros(3), (10**14, 3))
    with pytest.raises(lookfrom.Error, match="at most 4294967295 are possible"):
        lookfrom.Bvh(vertices, [[0, 1, 2]])
