"""The guide: its Python runs, and prints and draws what the page shows.

python tests/test_guide.py writes what is printed, and the pictures, into the page.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

REPOSITORY = Path(__file__).parents[3]
GUIDE = REPOSITORY / "docs/guide/python.md"
# Pictures that the page shows, by the names of the files that its code writes.
PICTURES = {"knot.png": "img/python-knot.png", "surface.png": "img/python-surface.png"}
BLOCK = re.compile(r"```python\n(.*?)```\n(?:\n```console\n(.*?)```\n)?", re.DOTALL)


def run(folder: Path) -> list[tuple[re.Match[str], str]]:
    """The blocks of the page, and what each prints."""
    shutil.copy(REPOSITORY / "scenes/models/knot.obj", folder)
    before = Path.cwd()
    names: dict[str, Any] = {}
    printed = []
    os.chdir(folder)
    try:
        for block in BLOCK.finditer(GUIDE.read_text(encoding="utf-8")):
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(compile(block[1], str(GUIDE), "exec"), names)
            printed.append((block, out.getvalue()))
    finally:
        os.chdir(before)
    return printed


def test_the_page_shows_what_its_code_prints_and_draws(tmp_path: Path) -> None:
    if not GUIDE.exists():
        pytest.skip("this is not a clone of the repository")
    for block, printed in run(tmp_path):
        assert (block[2] or "") == printed, block[1]
    for made, shown in PICTURES.items():
        assert (tmp_path / made).read_bytes() == (GUIDE.parent / shown).read_bytes(), shown


@pytest.mark.parametrize("tool", ["reference.py", "inspection.py", "notebook.py"])
def test_what_is_made_from_the_package_is_up_to_date(tool: str) -> None:
    if not GUIDE.exists():
        pytest.skip("this is not a clone of the repository")
    command = [sys.executable, str(REPOSITORY / "crates/lookfrom-py/tools" / tool), "--check"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_example_makes_a_data_set(tmp_path: Path) -> None:
    example = Path(__file__).parents[1] / "examples/nerf_dataset.py"
    model = REPOSITORY / "scenes/models/knot.obj"
    if not model.exists():
        pytest.skip("this is not a clone of the repository")
    arguments = [str(model), str(tmp_path), "--views=3", "--size=32", "--samples=2"]
    subprocess.run([sys.executable, str(example), *arguments], check=True)
    transforms = json.loads((tmp_path / "transforms.json").read_text())
    assert len(transforms["frames"]) == 3
    for index, frame in enumerate(transforms["frames"]):
        assert (tmp_path / frame["file_path"]).read_bytes().startswith(b"\x89PNG")
        # The points of the depths, by the matrices alone, are on the model.
        depth = np.load(tmp_path / f"{index:04}-depth.npy")
        rows, columns = np.nonzero(depth)
        z = depth[rows, columns]
        x = (columns + 0.5 - transforms["cx"]) / transforms["fl_x"] * z
        y = (rows + 0.5 - transforms["cy"]) / transforms["fl_y"] * z
        points = np.stack([x, -y, -z, np.ones_like(z)], axis=1) @ np.array(frame["transform_matrix"]).T
        assert len(z) > 50 and (np.abs(points[:, :3]) < 1.2).all()


def write() -> None:
    """Writes outputs and pictures into the page."""
    with tempfile.TemporaryDirectory() as folder:
        text = GUIDE.read_text(encoding="utf-8")
        for block, printed in reversed(run(Path(folder))):
            shown = f"\n```console\n{printed}```\n" if printed else ""
            text = text[: block.start()] + f"```python\n{block[1]}```\n" + shown + text[block.end() :]
        GUIDE.write_text(text, encoding="utf-8")
        for made, shown in PICTURES.items():
            shutil.copy(Path(folder) / made, GUIDE.parent / shown)


if __name__ == "__main__":
    sys.exit(write())
