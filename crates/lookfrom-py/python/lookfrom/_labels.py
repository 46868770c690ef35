"""Which object each pixel shows, and where it is: for data sets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ._lookfrom import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._camera import Camera


@dataclass(frozen=True)
class Labels:
    """What is seen at the middle of each pixel, through the middle of the lens. Arrays have the shape (h, w), with rows from
    the top.

    object: indices into `object_names`; -1 where nothing is seen. Objects are those of Cryptomattes: an instance, an object of an
        OBJ file, a node of a glTF file, or else a shape; all of one name are one.
    shape, material: indices into `shape_names` and `material_names`; -1 where nothing is seen.
    instance: the instance that the shape is in; -1 outside of instances.
    primitive: the primitive within its shape: of a mesh, the triangle; -1 where nothing is seen.
    depth: the distance along the view axis; ∞ where nothing is seen.
    position: shape (h, w, 3), in the world, float64; NaN where nothing is seen.
    normal: the shading normal, shape (h, w, 3), in the world, on the viewer's side; NaN where nothing is seen.
    """

    object: NDArray[np.int32]
    shape: NDArray[np.int32]
    instance: NDArray[np.int32]
    material: NDArray[np.int32]
    primitive: NDArray[np.int32]
    depth: NDArray[np.float64]
    position: NDArray[np.float64]
    normal: NDArray[np.float32]
    object_names: list[str]
    shape_names: list[str]
    material_names: list[str]
    camera: Camera

    @property
    def hit(self) -> NDArray[np.bool_]:
        """Where anything is seen."""
        return self.shape >= 0

    def mask(
        self, *, object: str | None = None, shape: str | None = None, material: str | None = None
    ) -> NDArray[np.bool_]:
        """Where an object, shape or material of this name is seen; several shapes may have it. Raises Error for a name that
        none has."""
        mask = self.hit
        for kind, name, names, ids in (
            ("object", object, self.object_names, self.object),
            ("shape", shape, self.shape_names, self.shape),
            ("material", material, self.material_names, self.material),
        ):
            if name is None:
                continue
            chosen = [index for index, other in enumerate(names) if other == name]
            if not chosen:
                raise Error(
                    f"there is no {kind} {name!r}; there are {', '.join(map(repr, dict.fromkeys(names)))}"
                )
            mask = mask & np.isin(ids, chosen)
        return mask

    def flow_to(self, camera: Camera) -> NDArray[np.float32]:
        """Optical flow: how far what each pixel shows is from there in the picture of another camera, shape (h, w, 2), in
        pixels to the right and down; NaN where nothing is seen or it would be behind the other camera. It is that of a scene
        that stands still, whether or not the other camera sees it."""
        there, depth = camera.project(self.position)
        here = np.stack(
            np.meshgrid(np.arange(self.camera.width) + 0.5, np.arange(self.camera.height) + 0.5), axis=-1
        )
        flow: NDArray[np.float32] = (there - here).astype(np.float32)
        if camera.projection == "perspective":
            flow[~(depth > 0)] = np.nan
        return flow
