"""Cameras as matrices: where points of the world are in a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from . import _arrays
from ._lookfrom import Error

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Convention = Literal["opencv", "opengl"]


@dataclass(frozen=True)
class Camera:
    """The camera of a session, as others need it.

    projection: "perspective", "orthographic", "equirectangular", "octahedral" or "irradiance". A lens system is
        "perspective": the pinhole that sees its plane of focus as large.
    width, height: of the picture in pixels. The middle of the upper left pixel is at (0.5, 0.5).
    lookfrom: its position in the world, shape (3,).
    right, up, forward: its axes in the world; unit vectors, but for cameras of pbrt's scenes that scale or mirror.
    lens_radius, focus_distance: of a thin lens; None for a pinhole.
    """

    projection: str
    width: int
    height: int
    lookfrom: NDArray[np.float64]
    right: NDArray[np.float64]
    up: NDArray[np.float64]
    forward: NDArray[np.float64]
    lens_radius: float | None
    focus_distance: float | None
    _plane_from_pixel: NDArray[np.float64]

    @property
    def intrinsics(self) -> NDArray[np.float64]:
        """K, shape (3, 3), from (x/z, y/z, 1) in OpenCV's axes (x right, y down, z forward) to pixels, of which the first has its
        middle at (0.5, 0.5); of an orthographic camera from (x, y, 1). `pinhole_rays` has that middle at (0, 0), as OpenCV does:
        for its intrinsics subtract 0.5 from the principal point, or take `rays`. Raises Error for panoramas, which have none."""
        self._is_flat()
        return np.asarray(np.linalg.inv(self._plane_from_pixel), np.float64)

    def extrinsics(self, convention: Convention = "opencv") -> NDArray[np.float64]:
        """From the world to the camera, shape (4, 4): "opencv" has x right, y down, z forward; "opengl" (and Blender, NeRF) x
        right, y up, z backward."""
        return np.asarray(np.linalg.inv(self.world_from_camera(convention)), np.float64)

    def world_from_camera(self, convention: Convention = "opencv") -> NDArray[np.float64]:
        """From the camera to the world, shape (4, 4): NeRF's `transform_matrix` is that of "opengl"."""
        if convention not in ("opencv", "opengl"):
            raise Error(f"convention is {convention!r}, but 'opencv' or 'opengl' is expected")
        sign = -1.0 if convention == "opencv" else 1.0
        matrix = np.eye(4)
        matrix[:3, 0], matrix[:3, 1], matrix[:3, 2] = self.right, sign * self.up, -sign * self.forward
        matrix[:3, 3] = self.lookfrom
        return matrix

    def project(self, points: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Where points of the world are in the picture.

        points: shape (..., 3).
        Returns pixels, shape (..., 2): x to the right and y down from the upper left corner, and depths, shape (...): the
        distance along the view axis, negative behind the camera. Raises Error for panoramas.
        """
        self._is_flat()
        world = _arrays.vectors(points, "points").astype(np.float64)
        matrix = self.extrinsics("opencv")
        camera = world @ matrix[:3, :3].T + matrix[:3, 3]
        depth = camera[..., 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            plane = (
                camera[..., :2] / depth[..., None] if self.projection == "perspective" else camera[..., :2]
            )
        k = self.intrinsics
        return plane @ k[:2, :2].T + k[:2, 2], depth

    def rays(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The rays through the middles of all pixels, for `Bvh.closest_hits`: origins of shape (3,), since they are all one, or of
        an orthographic camera (height, width, 3); directions of shape (height, width, 3), or of an orthographic camera (3,).

        Directions end at a distance of 1 along the camera's axis, so t of a hit is its depth. Raises Error for panoramas.
        """
        self._is_flat()
        x, y = np.meshgrid(np.arange(self.width) + 0.5, np.arange(self.height) + 0.5)
        plane = np.stack([x, y, np.ones_like(x)], axis=-1) @ self._plane_from_pixel.T
        axes = self.world_from_camera()[:3, :3]
        if self.projection == "perspective":
            return self.lookfrom, plane @ axes.T
        return self.lookfrom + plane[..., :2] @ axes[:, :2].T, axes[:, 2]

    def _is_flat(self) -> None:
        if self.projection not in ("perspective", "orthographic"):
            raise Error(
                f"this camera is {self.projection}: only perspective and orthographic ones have a matrix"
            )
