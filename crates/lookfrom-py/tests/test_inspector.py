"""The inspector: dataclasses of the schema, sums bit for bit, text, drawing and tables."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
from test_scenes import mesh_scene

import lookfrom
from lookfrom import _inspection

SCHEMA = Path(__file__).parents[3] / "docs/guide/inspect.schema.json"


@pytest.mark.parametrize("integrator", ["path", "whitted", "raycast", "normals"])
def test_sums_are_the_films_bit_for_bit(integrator: str) -> None:
    session = lookfrom.Session(mesh_scene(), size=32, samples=4, integrator=integrator)
    for x, y in [(16, 16), (12, 18), (0, 0)]:
        for sample in range(4):
            inspection = session.inspect(x, y, sample)
            total = np.zeros(len(inspection.radiance.lanes), np.float32)
            for addition in inspection.additions:
                total += np.array(addition.value.lanes, np.float32)
            assert (total == np.array(inspection.radiance.lanes, np.float32)).all()
            assert inspection.adds_up


def test_fields_have_their_types() -> None:
    session = lookfrom.Session(mesh_scene(), size=32, samples=2)
    inspection = session.inspect(16, 16)
    assert inspection.pixel == (16, 16) and inspection.integrator == "path"
    ray = inspection.ray(1)
    assert isinstance(ray, _inspection.Ray) and ray.met is not None and ray.met.material == "grey"
    assert isinstance(ray.candidates[0].test["Triangle"].numbers[0][1], _inspection.Twice)
    assert [step.name for step in inspection.camera.steps] == ["T1", "S2", "R3", "T4"]
    matrix = np.array(inspection.camera.steps[-1].product)
    assert matrix.shape == (4, 4)
    # T4 · R3 · S2 · T1 · P_k
    assert np.allclose(matrix @ inspection.camera.p_k, [*inspection.camera.p_world, 1])
    with pytest.raises(KeyError, match="there is no ray 99"):
        inspection.ray(99)
    with pytest.raises(IndexError, match="outside of the picture"):
        session.inspect(32, 0)
    with pytest.raises(IndexError, match="there is no sample 2"):
        session.inspect(0, 0, 2)
    for place in [(-1, 0), (0, -1), (0, 0, -1), (1 << 40, 0), (0, 1 << 80)]:
        with pytest.raises(IndexError, match="counted from 0"):
            session.inspect(*place)
    with pytest.raises(IndexError, match=r"there is no pixel \(-1, 0\)"):
        session.inspect_pixel(-1, 0)


def test_the_whole_pixel_is_the_picture() -> None:
    session = lookfrom.Session(mesh_scene(), size=32, samples=8, filter="box")
    pixel = session.inspect_pixel(16, 16)
    assert pixel.samples == 8 and len(pixel.all) == 8
    assert (np.array(pixel.mean, np.float32) == session.render().linear[16, 16]).all()


def test_text_drawing_and_tables() -> None:
    session = lookfrom.Session(mesh_scene(), size=32, samples=2)
    inspection = session.inspect(16, 16)
    assert "bit for bit" in inspection.text and str(inspection) == inspection.text
    assert inspection.svg.startswith("<svg") and inspection._repr_svg_() == inspection.svg
    again = pickle.loads(pickle.dumps(inspection))
    assert again == inspection and again.text == inspection.text
    pandas = pytest.importorskip("pandas")
    table = inspection.to_dataframe()
    assert isinstance(table, pandas.DataFrame) and table.loc[1, "material"] == "grey"
    assert len(session.inspect_pixel(16, 16).to_dataframe()) == 2


def test_inspections_stay_those_of_their_session() -> None:
    session = lookfrom.Session(mesh_scene(), size=32, samples=2, keep=True)
    expected = session.inspect(16, 16, 1)
    text, svg = expected.text, expected.svg
    for change in (
        lambda: session.set_material("grey", type="diffuse", reflectance=0.1),
        lambda: session.set(lookfrom=(0, 0, 9), lookat=(0, 0, 0)),
        lambda: session.set(size=8, samples=1),
    ):
        inspection = session.inspect(4, 4)
        before = session.inspect(4, 4).text
        change()
        assert inspection.text == before
        # The one of before all changes, with whose pixel and sample there is none in the end.
        assert expected.text == text and expected.svg == svg


def test_json_is_that_of_the_schema() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    if not SCHEMA.exists():
        pytest.skip("this is not a clone of the repository")
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    session = lookfrom.Session(mesh_scene(), size=32, samples=2)
    for kind, sample in (("sample", 0), ("pixel", None)):
        told = json.loads(session._native.inspect(16, 16, sample))
        jsonschema.validate(told, {**schema["$defs"][kind], "$defs": schema["$defs"]})
