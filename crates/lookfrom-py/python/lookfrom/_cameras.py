"""Rays of cameras, one for each pixel, through its middle."""

from __future__ import annotations

import math
import operator
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays
from ._lookfrom import Error

Convention = Literal["opencv", "opengl"]
Rays = tuple[NDArray[np.float64], NDArray[np.float64]]


def look_at(
    eye: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 0.0, 1.0), *, convention: Convention = "opencv"
) -> NDArray[np.float64]:
    """The place of a camera that looks from a point at another one: a matrix, world from camera, shape (4, 4).

    eye, target: points. up: a direction that is upwards in the picture.
    convention: the camera's axes. "opencv": x is to the right, y down, z forward. "opengl": x is to the right, y up, z backward.

    Raises Error where eye and target are one point, or up is in their line.
    """
    e, t, u = (_vector(value, name) for value, name in ((eye, "eye"), (target, "target"), (up, "up")))
    forward = _unit(t - e, "eye and target are one point")
    right = _unit(np.cross(forward, u / (np.abs(u).max() or 1.0)), "up is in the line from eye to target")
    down = np.cross(forward, right)
    matrix = np.eye(4)
    matrix[:3, :3] = _camera_axes(np.column_stack([right, down, forward]), convention)
    matrix[:3, 3] = e
    return matrix


def pinhole_rays(
    width: int,
    height: int,
    *,
    fov: float | None = None,
    intrinsics: ArrayLike | None = None,
    world_from_camera: ArrayLike | None = None,
    convention: Convention = "opencv",
) -> Rays:
    """The rays of a pinhole camera: origins of shape (3,), since they are all one, and directions of shape (height, width, 3).

    width, height: pixels.
    fov: the vertical angle of view in degrees, or instead
    intrinsics: OpenCV's matrix, shape (3, 3): focal lengths and principal point in pixels, where the middle of the first pixel is
        at (0, 0) as in OpenCV; skew is allowed. (That of `Camera.intrinsics` is at (0.5, 0.5), as in COLMAP.)
    world_from_camera: the camera's place, shape (4, 4) or (3, 4), for example of `look_at`; without one, the origin.
    convention: the camera's axes, as of `look_at`.

    Directions end at a distance of 1 along the camera's axis, so t of a hit is its depth. Row 0 is the top of the picture.
    """
    width, height = _size(width, height)
    if (fov is None) == (intrinsics is None):
        raise Error("either fov or intrinsics is expected")
    if intrinsics is not None:
        k = _arrays.numbers(intrinsics, "intrinsics").astype(np.float64)
        if k.shape != (3, 3) or k[2].tolist() != [0.0, 0.0, 1.0] or k[1, 0] != 0.0 or not k[0, 0] * k[1, 1]:
            raise Error(
                f"intrinsics is {k.tolist()}, but [[fx, skew, cx], [0, fy, cy], [0, 0, 1]] is expected"
            )
        y = (np.arange(height) - k[1, 2]) / k[1, 1]
        x = (np.arange(width) - k[0, 2] - k[0, 1] * y[:, None]) / k[0, 0]
    else:
        angle = float(fov if fov is not None else math.nan)
        if not 0.0 < angle < 180.0:
            raise Error(f"fov is {angle}, but an angle between 0 and 180 degrees is expected")
        half = math.tan(math.radians(angle) / 2)
        y = half * _middles(height)
        x = np.broadcast_to(half * width / height * _middles(width), (height, width))
    axes, origin = _place(world_from_camera, convention)
    return origin, x[..., None] * axes[:, 0] + y[:, None, None] * axes[:, 1] + axes[:, 2]


def orthographic_rays(
    width: int,
    height: int,
    *,
    size: float,
    world_from_camera: ArrayLike | None = None,
    convention: Convention = "opencv",
) -> Rays:
    """The rays of an orthographic camera: origins of shape (height, width, 3), in the plane of the camera's origin, and one
    direction, of length 1 where the matrix keeps lengths, of shape (3,).

    size: the height of the picture in units of the world. The other arguments are as of `pinhole_rays`.
    """
    width, height = _size(width, height)
    if not 0.0 < size < math.inf:
        raise Error(f"size is {size}, but a positive height is expected")
    axes, origin = _place(world_from_camera, convention)
    x = 0.5 * size * width / height * _middles(width)
    y = 0.5 * size * _middles(height)
    return origin + x[:, None] * axes[:, 0] + y[:, None, None] * axes[:, 1], axes[:, 2].copy()


def panorama_rays(
    width: int,
    height: int,
    *,
    world_from_camera: ArrayLike | None = None,
    convention: Convention = "opencv",
) -> Rays:
    """The rays of an equirectangular panorama: origins of shape (3,), and unit directions of shape (height, width, 3).

    The middle of the picture is forward, its left and right edges are backward, the top is upward. Arguments are as of
    `pinhole_rays`.
    """
    width, height = _size(width, height)
    axes, origin = _place(world_from_camera, convention)
    longitude = math.pi * _middles(width)
    latitude = math.pi / 2 * _middles(height)[:, None]
    x, z = np.sin(longitude) * np.cos(latitude), np.cos(longitude) * np.cos(latitude)
    y = np.broadcast_to(np.sin(latitude), x.shape)
    return origin, np.stack([x, y, z], axis=-1) @ axes.T


def _middles(count: int) -> NDArray[np.float64]:
    """The middles of pixels, from -1 to 1."""
    return (2.0 * np.arange(count) + 1.0) / count - 1.0


def _size(width: int, height: int) -> tuple[int, int]:
    size = operator.index(width), operator.index(height)
    if min(size) < 1:
        raise Error(f"width and height are {size}, but at least one pixel is expected")
    return size


def _place(
    world_from_camera: ArrayLike | None, convention: Convention
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The images of OpenCV's axes as columns, and the camera's origin."""
    matrix = np.eye(4)
    if world_from_camera is not None:
        matrix = _arrays.numbers(world_from_camera, "world_from_camera").astype(np.float64)
        if matrix.shape not in ((4, 4), (3, 4)):
            raise Error(f"world_from_camera has shape {matrix.shape}, but (4, 4) or (3, 4) is expected")
        _arrays.finite(matrix, "world_from_camera")
    return _camera_axes(matrix[:3, :3], convention), matrix[:3, 3].copy()


def _camera_axes(axes: NDArray[np.float64], convention: Convention) -> NDArray[np.float64]:
    """Columns of one convention as those of OpenCV's, or the other way round."""
    _arrays.one_of(convention, "convention", "opencv", "opengl")
    return axes * (1.0 if convention == "opencv" else np.array([1.0, -1.0, -1.0]))


def _vector(value: ArrayLike, name: str) -> NDArray[np.float64]:
    vector = _arrays.vectors(value, name).astype(np.float64)
    if vector.shape != (3,):
        raise Error(f"{name} has shape {vector.shape}, but (3,) is expected")
    if not np.isfinite(vector).all():
        raise Error(f"{name} is {vector.tolist()}, but all coordinates must be finite")
    return vector


def _unit(vector: NDArray[np.float64], otherwise: str) -> NDArray[np.float64]:
    length = float(np.linalg.norm(vector))
    if not length > 0.0:
        raise Error(f"there is no such camera: {otherwise}")
    return vector / length
