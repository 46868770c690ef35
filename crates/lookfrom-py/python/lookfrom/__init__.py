"""Rays against meshes: exact, watertight, on all cores."""

from ._bvh import Bvh
from ._cameras import look_at, orthographic_rays, panorama_rays, pinhole_rays
from ._geometry import Instance, Spheres, Triangles
from ._hits import AllHits, ClosestPoints, Hits, Statistics
from ._lookfrom import Error

__all__ = [
    "AllHits",
    "Bvh",
    "ClosestPoints",
    "Error",
    "Hits",
    "Instance",
    "Spheres",
    "Statistics",
    "Triangles",
    "look_at",
    "orthographic_rays",
    "panorama_rays",
    "pinhole_rays",
]
