"""Rays against meshes: exact, watertight, on all cores."""

from ._lookfrom import Error

__all__ = ["Error"]
