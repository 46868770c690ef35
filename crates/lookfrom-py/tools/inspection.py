"""Writes python/lookfrom/_inspection.py: the dataclasses of inspections, from docs/guide/inspect.schema.json.

python tools/inspection.py          writes the file
python tools/inspection.py --check  fails where the file is not what the schema says
"""

from __future__ import annotations

import json
import keyword
import sys
import textwrap
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
SCHEMA = HERE / "../../../docs/guide/inspect.schema.json"
TARGET = HERE / "../python/lookfrom/_inspection.py"
WIDTH = 110

HEAD = '''"""What an inspection tells: one class for each object of docs/guide/inspect.schema.json.

Made from it by tools/inspection.py.
"""

from __future__ import annotations

from dataclasses import dataclass
'''


class Types:
    """The types of the schema in Python's words."""

    def __init__(self, definitions: dict[str, Any]) -> None:
        self.definitions = definitions

    def is_class(self, name: str) -> bool:
        """Whether a definition is an object with keys of its own, all of which it has."""
        definition = self.definitions[name]
        return "properties" in definition and "required" in definition

    def of(self, schema: dict[str, Any]) -> str:
        """The annotation of a value."""
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[1]
            return class_name(name) if self.is_class(name) else self.of(self.definitions[name])
        if "anyOf" in schema:
            # Numbers that are not finite are strings in JSON, and numbers here.
            parts = [self.of(part) for part in schema["anyOf"] if "NaN" not in part.get("enum", ())]
            return " | ".join(dict.fromkeys(parts))
        if "enum" in schema or "const" in schema:
            return "str"
        if "prefixItems" in schema:
            return f"tuple[{', '.join(self.of(part) for part in schema['prefixItems'])}]"
        kind = schema.get("type")
        if isinstance(kind, list):
            return " | ".join(self.of({**schema, "type": one}) for one in kind)
        match kind:
            case "array":
                item = self.of(schema["items"])
                # Numbers, and rows of numbers, are values; anything else is a list of things.
                is_value = item in ("float", "int") or item.startswith("tuple[float")
                count, most = schema.get("minItems"), schema.get("maxItems")
                if not is_value:
                    return f"list[{item}]"
                return (
                    f"tuple[{', '.join([item] * count)}]"
                    if count is not None and count == most
                    else f"tuple[{item}, ...]"
                )
            case "object":
                return f"dict[str, {self.of(next(iter(schema['properties'].values())))}]"
            case "null":
                return "None"
            case name:
                return {"string": "str", "number": "float", "integer": "int", "boolean": "bool"}[name]


def class_name(name: str) -> str:
    return "".join(word.capitalize() for word in name.split("_"))


def field_name(name: str) -> str:
    return f"{name}_" if keyword.iskeyword(name) else name


def written() -> str:
    """The text of the file."""
    definitions = json.loads(SCHEMA.read_text(encoding="utf-8"))["$defs"]
    types = Types(definitions)
    lines = [HEAD]
    for name, definition in definitions.items():
        if not types.is_class(name):
            continue
        lines.append("\n@dataclass(frozen=True)")
        lines.append(f"class {class_name(name)}:")
        lines.extend(docstring(definition))
        lines.append("")
        for key, schema in definition["properties"].items():
            lines.append(f"    {field_name(key)}: {types.of(schema)}")
        lines.append("")
    return "\n".join(lines)


def docstring(definition: dict[str, Any]) -> list[str]:
    told = definition.get("description", "An inspection's part.")
    lines = textwrap.wrap(f'"""{told}', WIDTH, initial_indent="    ", subsequent_indent="    ")
    lines.append("")
    for key, schema in definition["properties"].items():
        if about := schema.get("description"):
            text = f"{field_name(key)}: {about}"
            lines.extend(textwrap.wrap(text, WIDTH, initial_indent="    ", subsequent_indent="        "))
    return [line.replace("\\", "\\\\") for line in lines] + ['    """']


if __name__ == "__main__":
    text = written()
    if "--check" not in sys.argv:
        TARGET.write_text(text, encoding="utf-8")
    elif TARGET.read_text(encoding="utf-8") != text:
        sys.exit("_inspection.py is not what the schema says: run tools/inspection.py")
