"""The type checkers, where they are installed: of the package, of uses of it, and of the stubs beside the compiled module."""

import subprocess
import sys
from pathlib import Path

import pytest

CRATE = Path(__file__).parent.parent


@pytest.mark.parametrize(
    ("package", "command"),
    [
        ("mypy", ["mypy"]),
        ("pyright", ["pyright", "--pythonpath", sys.executable]),
        ("mypy", ["mypy.stubtest", "lookfrom._lookfrom"]),
    ],
)
def test_types(package: str, command: list[str]) -> None:
    pytest.importorskip(package)
    done = subprocess.run([sys.executable, "-m", *command], cwd=CRATE, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
