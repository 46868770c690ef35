"""Ray tracing: rays against meshes, pictures, and why every pixel is as it is."""

from ._bvh import Bvh
from ._camera import Camera
from ._cameras import look_at, orthographic_rays, panorama_rays, pinhole_rays
from ._colors import linear
from ._geometry import Instance, Spheres, Triangles
from ._hits import AllHits, ClosestPoints, Hits, Statistics
from ._inspect import Inspection, PixelInspection
from ._labels import Labels
from ._lookfrom import Error, SceneError
from ._picture import Film, Picture
from ._scene import Scene
from ._session import SceneWarning, Session, render
from ._show import Page, show
from ._words import Options, options

__all__ = [
    "AllHits",
    "Bvh",
    "Camera",
    "ClosestPoints",
    "Error",
    "Film",
    "Hits",
    "Inspection",
    "Instance",
    "Labels",
    "Options",
    "Page",
    "Picture",
    "PixelInspection",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Session",
    "Spheres",
    "Statistics",
    "Triangles",
    "linear",
    "look_at",
    "options",
    "orthographic_rays",
    "panorama_rays",
    "pinhole_rays",
    "render",
    "show",
]
