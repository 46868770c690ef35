"""TOML from plain data: what a scene in our format is made of."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ._arrays import is_array

# Tables that have no values of their own, but tables by name.
_NAMED = ("materials", "textures", "objects", "media")

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def document(data: Mapping[str, Any]) -> str:
    """A document. Values of its top level are written first, tables `[name]` and lists of tables `[[name]]` after them."""
    lines: list[str] = []
    _tables(data, "", lines)
    return "\n".join(lines).strip("\n") + "\n"


def value(item: Any) -> str:
    """A value on one line. Raises TypeError for what TOML cannot say."""
    if isinstance(item, str):
        # JSON's escapes are TOML's; but TOML has no raw DEL.
        return json.dumps(item, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(item, bool | np.bool_):
        return "true" if item else "false"
    if isinstance(item, int | np.integer):
        return str(int(item))
    if isinstance(item, float | np.floating):
        number = float(item)
        return (
            repr(number) if math.isfinite(number) else {math.inf: "inf", -math.inf: "-inf"}.get(number, "nan")
        )
    if is_array(item):
        return value(np.asarray(item).tolist())
    if isinstance(item, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {value(part)}" for key, part in item.items()) + " }"
    if isinstance(item, Sequence):
        return "[" + ", ".join(map(value, item)) + "]"
    raise TypeError(f"{type(item).__name__} is nothing that a scene can have: {item!r}")


def _key(name: Any) -> str:
    if not isinstance(name, str):
        raise TypeError(f"{name!r} is no name: a key is a str")
    return name if _BARE.fullmatch(name) else value(name)


def _is_tables(item: Any) -> bool:
    return (
        isinstance(item, list | tuple) and len(item) > 0 and all(isinstance(part, Mapping) for part in item)
    )


def _tables(data: Mapping[str, Any], prefix: str, lines: list[str]) -> None:
    """Writes values, then the tables and lists of tables after them, whose names begin with `prefix`."""
    given = {key: item for key, item in data.items() if item is not None}
    after = {key: item for key, item in given.items() if isinstance(item, Mapping) or _is_tables(item)}
    if prefix:
        # Tables of an object's own attributes are values.
        after = {key: item for key, item in after.items() if _is_tables(item)}
    _values({key: item for key, item in given.items() if key not in after}, lines)
    for key, item in after.items():
        name = prefix + _key(key)
        if not isinstance(item, Mapping):
            for table in item:
                lines.extend(["", f"[[{name}]]"])
                _values(table, lines)
        elif key in _NAMED and item:
            for entry, table in item.items():
                lines.extend(["", f"[{name}.{_key(entry)}]"])
                if key == "objects":
                    _tables(table, f"{name}.{_key(entry)}.", lines)
                else:
                    _values(table, lines)
        else:
            lines.extend(["", f"[{name}]"])
            _values(item, lines)


def _values(table: Mapping[str, Any], lines: list[str]) -> None:
    lines.extend(f"{_key(key)} = {value(item)}" for key, item in table.items() if item is not None)
