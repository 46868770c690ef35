"""Meshes for the tests, and the slow, obviously right twin of the queries: every ray against every triangle, in numpy."""

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


def icosphere(subdivisions: int) -> tuple[Array, Array]:
    """A closed mesh on the unit sphere, fronts outside: 20 * 4**subdivisions triangles."""
    golden = (1 + 5**0.5) / 2
    points = [
        p for a, b in itertools.product((-1, 1), (-golden, golden)) for p in ((0, a, b), (a, b, 0), (b, 0, a))
    ]
    vertices = np.array(points, float)
    near = np.isclose(np.linalg.norm(vertices[:, None] - vertices, axis=2), 2)
    faces = [
        t
        for t in itertools.combinations(range(12), 3)
        if near[t[0], t[1]] and near[t[1], t[2]] and near[t[2], t[0]]
    ]
    faces = np.array([t if np.linalg.det(vertices[list(t)]) > 0 else t[::-1] for t in faces])
    for _ in range(subdivisions):
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, inverse = np.unique(edges, axis=0, return_inverse=True)
        middles = len(vertices) + inverse.reshape(-1, 3)
        vertices = np.vstack([vertices, vertices[unique].mean(axis=1)])
        (a, b, c), (d, e, f) = faces.T, middles.T
        faces = np.vstack([np.stack(t, axis=1) for t in ((a, d, f), (d, b, e), (f, e, c), (d, e, f))])
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces


def box(size: float = 1.0) -> tuple[Array, Array]:
    """A cube around the origin, of twelve triangles, fronts outside."""
    vertices = size * (np.array(list(itertools.product((0, 1), repeat=3)), float) - 0.5)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def soup(rng: np.random.Generator, count: int) -> tuple[Array, Array]:
    """Triangles that share no vertices, of different sizes, in a unit cube."""
    sizes = 10 ** rng.uniform(-2, -0.3, (count, 1, 1))
    corners = rng.uniform(-0.5, 0.5, (count, 1, 3)) + sizes * rng.uniform(-1, 1, (count, 3, 3))
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def every_triangle(
    vertices: Array, faces: Array, origins: Array, directions: Array
) -> tuple[Array, Array, Array]:
    """t, u, v of each ray with the plane of each triangle, shape (rays, triangles): Cramer's rule in float64."""
    a, b, c = vertices[faces].swapaxes(0, 1)
    e1, e2, f = b - a, c - a, a - origins[:, None]
    n = np.cross(e1, e2)
    r = np.cross(f, directions[:, None])
    with np.errstate(all="ignore"):
        inverse = 1 / np.einsum("ti,ri->rt", n, directions)
        return (
            np.einsum("ti,rti->rt", n, f) * inverse,
            np.einsum("ti,rti->rt", e2, r) * inverse,
            -np.einsum("ti,rti->rt", e1, r) * inverse,
        )


def brute_force(
    vertices: Array,
    faces: Array,
    origins: Array,
    directions: Array,
    t_min: float = 0.0,
    t_max: float = np.inf,
) -> Array:
    """t of each ray with each triangle that it hits, shape (rays, triangles), infinite elsewhere."""
    t, u, v = every_triangle(vertices, faces, origins, directions)
    return np.where((u >= 0) & (v >= 0) & (u + v <= 1) & (t > t_min) & (t < t_max), t, np.inf)


def clear_of_edges(
    vertices: Array, faces: Array, origins: Array, directions: Array, room: float = 1e-4
) -> Array:
    """The rays that pass no edge of a triangle by less than `room` of its weights, so that rounding cannot matter."""
    _, u, v = every_triangle(vertices, faces, origins, directions)
    weights = np.stack([u, v, 1 - u - v])
    return ~((np.abs(weights) < room).any(axis=0) & (weights > -room).all(axis=0)).any(axis=1)
