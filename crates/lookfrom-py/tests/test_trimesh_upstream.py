"""trimesh's own tests of rays, with our intersector in the place of its two.

The tests come from trimesh's source distribution, which pip downloads; models and data from the folder that LOOKFROM_SHARED names.
None of them is in this repository. Without the folder, without trimesh or without a network this is skipped.
"""

import os
import re
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

trimesh = pytest.importorskip("trimesh")
pytest.importorskip("embreex")
pytest.importorskip("manifold3d")

pytestmark = pytest.mark.slow

# What the tests take from the module `generic`, which the source distribution does not have.
GENERIC = """
import json, os, time
from pathlib import Path
import numpy as np
import trimesh
from trimesh.constants import log

_shared = Path(os.environ["LOOKFROM_SHARED"]) / "trimesh"
data = {"ray_data": json.loads((_shared / "data" / "ray_data.json").read_text())}
random = np.random.default_rng(0).random

def get_mesh(file_name, **kwargs):
    mesh = trimesh.load_mesh(_shared / "models" / file_name, **kwargs)
    mesh.source.file_path = file_name
    return mesh
"""

CONFTEST = """
import lookfrom.trimesh
import trimesh.ray
for name in {modules}:
    getattr(trimesh.ray, name).RayMeshIntersector = lookfrom.trimesh.RayMeshIntersector
"""


@pytest.fixture(scope="module")
def tests_of_trimesh(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if "LOOKFROM_SHARED" not in os.environ:
        pytest.skip("LOOKFROM_SHARED does not name the folder with trimesh's models")
    folder = tmp_path_factory.mktemp("trimesh")
    download = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps"]
    package = f"trimesh=={trimesh.__version__}"
    done = subprocess.run(
        [*download, "--no-binary", ":all:", package, "-d", folder], capture_output=True, text=True
    )
    archives = list(folder.glob("trimesh-*.tar.gz"))
    if not archives:
        pytest.skip(f"the source distribution of trimesh cannot be had: {done.stderr[-300:]}")
    with tarfile.open(archives[0]) as archive:
        for name in ("test_ray.py", "test_ray_upstream.py"):
            member = next(m for m in archive.getmembers() if m.name.endswith(f"/tests/{name}"))
            content = archive.extractfile(member)
            assert content is not None
            (folder / name).write_bytes(content.read())
    (folder / "generic.py").write_text(GENERIC)
    return folder


# With the slow engine left as it is, the tests that compare the two compare ours with it.
@pytest.mark.parametrize("modules", [["ray_pyembree", "ray_triangle"], ["ray_pyembree"]])
def test_upstream(tests_of_trimesh: Path, modules: list[str]) -> None:
    (tests_of_trimesh / "conftest.py").write_text(CONFTEST.format(modules=modules))
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--rootdir", ".", "."]
    done = subprocess.run(command, cwd=tests_of_trimesh, capture_output=True, text=True)
    print(done.stdout[-3000:])
    assert done.returncode == 0, done.stdout
    assert re.search(r"^\d+ passed", done.stdout, re.MULTILINE)
