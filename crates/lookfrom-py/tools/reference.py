"""Writes docs/guide/python-reference.md: all public names with their signatures and docstrings.

python tools/reference.py          writes the file
python tools/reference.py --check  fails where the file is not what the package says
"""

from __future__ import annotations

import inspect
import sys
from functools import cached_property
from pathlib import Path
from typing import Any

import lookfrom
import lookfrom.trimesh
from lookfrom import _inspection

TARGET = Path(__file__).resolve().parents[3] / "docs/guide/python-reference.md"

HEAD = """# Python: reference

Made from the docstrings by `crates/lookfrom-py/tools/reference.py`. Examples are in [Python](python.md).
"""

# Names by what people want of them.
SECTIONS = {
    "Pictures": ["render", "Session", "Picture", "Film", "show", "Page", "options", "Options"],
    "Scenes": ["Scene", "linear"],
    "Data sets": ["Labels", "Camera"],
    "The inspector": ["Inspection", "PixelInspection"],
    "Rays": [
        "Bvh",
        "Triangles",
        "Spheres",
        "Instance",
        "Hits",
        "AllHits",
        "ClosestPoints",
        "Statistics",
        "look_at",
        "pinhole_rays",
        "orthographic_rays",
        "panorama_rays",
    ],
    "Errors": ["Error", "SceneError", "SceneWarning"],
}


def signature(name: str, item: Any) -> str:
    """A call as one would write it, on as few lines as its length allows."""
    try:
        parameters = inspect.signature(item)
    except (TypeError, ValueError):
        return name
    parts: list[str] = []
    for part in parameters.parameters.values():
        if part.name in ("self", "cls"):
            continue
        if part.kind is part.KEYWORD_ONLY and not any(text.startswith("*") for text in parts):
            parts.append("*")
        stars = {part.VAR_POSITIONAL: "*", part.VAR_KEYWORD: "**"}.get(part.kind, "")
        default = "" if part.default is part.empty else f" = {part.default!r}"
        parts.append(f"{stars}{part.name}: {part.annotation}{default}")
    result = parameters.return_annotation
    returned = "" if result in (parameters.empty, "None") else f" -> {result}"
    line = f"{name}({', '.join(parts)}){returned}"
    if len(line) <= 110:
        return line
    return f"{name}(\n    " + ",\n    ".join(parts) + f",\n){returned}"


def entry(name: str, item: Any, level: str) -> list[str]:
    text = inspect.getdoc(item) or ""
    is_call = callable(item) and not (inspect.isclass(item) and issubclass(item, BaseException | dict))
    shown = signature(name, item) if is_call else name
    return [f"{level} {name.rpartition('.')[2]}", "", "```", shown, "", text, "```", ""]


def members(owner: Any) -> list[tuple[str, Any]]:
    """Public methods and properties of a class, in the order in which they are written, with those of its own bases."""
    found: dict[str, Any] = {}
    for base in reversed(owner.mro()):
        if base.__module__.startswith("lookfrom"):
            found.update((name, item) for name, item in vars(base).items() if not name.startswith("_"))
    kinds = (property, staticmethod, classmethod)
    return [
        (name, item)
        for name, item in found.items()
        if (isinstance(item, kinds) or callable(item) or hasattr(item, "func")) and inspect.getdoc(item)
    ]


def written() -> str:
    """The text of the file."""
    lines = [HEAD]
    for title, names in SECTIONS.items():
        lines.extend([f"## {title}", ""])
        for name in names:
            item = getattr(lookfrom, name)
            lines.extend(entry(f"lookfrom.{name}", item, "###"))
            if not inspect.isclass(item) or issubclass(item, BaseException | dict):
                continue
            for member, value in members(item):
                if isinstance(value, cached_property):
                    value = property(value.func)
                value = value.__func__ if isinstance(value, staticmethod | classmethod) else value
                lines.extend(entry(f"{name}.{member}", value, "####"))
    lines.extend(["## Parts of inspections", ""])
    for name, item in vars(_inspection).items():
        if inspect.isclass(item) and item.__module__ == _inspection.__name__:
            lines.extend([f"### {name}", "", "```", inspect.getdoc(item) or "", "```", ""])
    lines.extend(["## lookfrom.trimesh", ""])
    intersector = lookfrom.trimesh.RayMeshIntersector
    lines.extend(entry("lookfrom.trimesh.RayMeshIntersector", intersector, "###"))
    for member, value in members(intersector):
        lines.extend(entry(f"RayMeshIntersector.{member}", value, "####"))
    return "\n".join(line.rstrip() for line in "\n".join(lines).split("\n")).rstrip("\n") + "\n"


if __name__ == "__main__":
    listed = {name for names in SECTIONS.values() for name in names}
    if listed != set(lookfrom.__all__):
        sys.exit(f"the sections lack or have too much: {listed ^ set(lookfrom.__all__)}")
    text = written()
    if "--check" not in sys.argv:
        TARGET.write_text(text, encoding="utf-8")
    elif TARGET.read_text(encoding="utf-8") != text:
        sys.exit("python-reference.md is not what the package says: run tools/reference.py")
