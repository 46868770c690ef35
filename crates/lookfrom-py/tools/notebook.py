"""Writes docs/guide/python.ipynb: the page docs/guide/python.md as a notebook, run by Jupyter, with what it shows.

python tools/notebook.py          writes the file; needs nbclient and ipykernel
python tools/notebook.py --check  fails where its cells are not those of the page; needs neither

Blocks that are marked `python notebook` are cells of the notebook alone: there a picture shows itself.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).resolve().parents[3]
PAGE = REPOSITORY / "docs/guide/python.md"
TARGET = PAGE.with_suffix(".ipynb")
# Code, with the output that follows it on the page.
BLOCK = re.compile(r"```python(?: notebook)?\n(.*?)```\n(?:\n```console\n.*?```\n)?", re.DOTALL)


def cells() -> list[tuple[str, str]]:
    """The kinds and texts of the cells."""
    text, result, end = PAGE.read_text(encoding="utf-8"), [], 0
    for block in BLOCK.finditer(text):
        result.append(("markdown", text[end : block.start()].strip()))
        result.append(("code", block[1].strip()))
        end = block.end()
    result.append(("markdown", text[end:].strip()))
    return [(kind, cell) for kind, cell in result if cell]


def write() -> None:
    import nbformat
    from nbclient import NotebookClient

    new = nbformat.v4
    kinds = {"markdown": new.new_markdown_cell, "code": new.new_code_cell}
    notebook = new.new_notebook(cells=[kinds[kind](cell) for kind, cell in cells()])
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(REPOSITORY / "scenes/models/knot.obj", folder)
        NotebookClient(notebook, resources={"metadata": {"path": folder}}).execute()
    # What differs from run to run tells nothing.
    for number, cell in enumerate(notebook.cells):
        cell["id"] = f"cell-{number}"
        cell["metadata"] = {}
    notebook["metadata"] = {"language_info": {"name": "python"}}
    TARGET.write_text(nbformat.writes(notebook) + "\n", encoding="utf-8")


def check() -> str | None:
    """What is wrong, or None."""
    notebook: dict[str, Any] = json.loads(TARGET.read_text(encoding="utf-8"))
    kept = [(cell["cell_type"], "".join(cell["source"])) for cell in notebook["cells"]]
    if kept != cells():
        return f"{os.fspath(TARGET.name)} is not the page: run tools/notebook.py"
    failed = [
        output
        for cell in notebook["cells"]
        for output in cell.get("outputs", [])
        if output["output_type"] == "error"
    ]
    return f"a cell failed: {failed[0]}" if failed else None


if __name__ == "__main__":
    sys.exit(check() if "--check" in sys.argv else write())
