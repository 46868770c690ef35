"""Scenes as plain data: to text and back without loss, arrays as files, meshes of trimesh."""

from __future__ import annotations

import copy
import importlib.util
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lookfrom
from lookfrom import _toml

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float64)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])

numbers = st.one_of(st.integers(-(2**60), 2**60), st.floats(allow_nan=False, allow_infinity=False))
values = st.recursive(
    st.one_of(st.booleans(), numbers, st.text()),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(st.text(), inner, max_size=4)),
    max_leaves=12,
)
tables = st.dictionaries(st.text(), values, max_size=4)


@settings(deadline=None)
@given(
    st.dictionaries(st.sampled_from(["camera", "image", "render", "variables"]), tables, max_size=4),
    st.dictionaries(
        st.sampled_from(["materials", "textures", "media"]), st.dictionaries(st.text(), tables, max_size=3)
    ),
    st.dictionaries(st.sampled_from(["sphere", "light", "mesh"]), st.lists(tables, min_size=1, max_size=3)),
    st.dictionaries(
        st.text(min_size=1),
        st.dictionaries(st.sampled_from(["box", "mesh"]), st.lists(tables, min_size=1)),
        max_size=2,
    ),
    st.lists(st.text(), max_size=2),
)
def test_text_and_back_without_loss(plain: Any, named: Any, listed: Any, objects: Any, imported: Any) -> None:
    data = {**listed, **plain, **named, "import": imported}
    if objects:
        data["objects"] = objects
    scene = lookfrom.Scene(data)
    assert lookfrom.Scene.from_toml(scene.to_toml()) == scene


def mesh_scene(**words: Any) -> lookfrom.Scene:
    scene = lookfrom.Scene()
    scene.material("grey", type="diffuse", reflectance=0.5)
    scene.mesh(VERTICES, FACES, material="grey", **words)
    scene.light(type="environment", color=1)
    scene.camera(lookfrom=[3, 2, 3], lookat=[0.2, 0.3, 0.2], fov=30)
    return scene


def test_arrays_are_the_same_in_memory_on_disk_and_in_text(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    scene = mesh_scene(normals=VERTICES - 0.25, uvs=rng.random((4, 2)), colors=rng.random((4, 3)))
    scene.texture("checks", type="image", file=rng.random((4, 4, 3)).astype(np.float32))
    scene.texture("bytes", type="image", file=rng.integers(0, 256, (4, 4, 3), np.uint8))
    scene.material("grey", type="diffuse", reflectance="checks")
    expected = lookfrom.render(scene, size=32, samples=2).linear
    scene.save(tmp_path / "saved.toml")
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".npy"] * 5 + [".pfm", ".ppm", ".toml"]
    assert (lookfrom.render(tmp_path / "saved.toml", size=32, samples=2).linear == expected).all()
    loaded = lookfrom.Scene.load(tmp_path / "saved.toml")
    assert (lookfrom.render(loaded, size=32, samples=2).linear == expected).all()
    with pytest.raises(lookfrom.Error, match="an image that is an array"):
        scene.to_toml()
    scene.data["textures"] = {}
    scene.material("grey", type="diffuse", reflectance={"type": "vertex_color"})
    written = lookfrom.Scene.from_toml(scene.to_toml())
    assert written == scene
    assert (
        lookfrom.render(written, size=32, samples=2).linear
        == lookfrom.render(scene, size=32, samples=2).linear
    ).all()


class Tensor:
    """An array of others than numpy, such as PyTorch."""

    def __init__(self, numbers: Any) -> None:
        self.numbers = np.array(numbers)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        return self.numbers if dtype is None else self.numbers.astype(dtype)


def test_arrays_of_others_are_arrays(tmp_path: Path) -> None:
    scenes = []
    for made in (np.array, Tensor):
        scene = lookfrom.Scene()
        scene.material("grey", type="diffuse", reflectance=made([0.1, 0.2, 0.3]))
        scene.mesh(made(VERTICES), made(FACES), material="grey", translate=made([0.1, 0, 0]))
        scene.light(type="environment", image=made(np.full((2, 4, 3), 0.5)))
        scene.camera(lookfrom=made([3, 2, 3]), lookat=[0.2, 0.3, 0.2])
        scenes.append(scene)
    assert scenes[0] == scenes[1]
    sky = np.ones((2, 4, 3))
    expected = lookfrom.render(scenes[0], size=16, samples=2, fov=30, environment=sky).linear
    options: Any = {"fov": Tensor(30.0), "environment": Tensor(sky)}
    assert (lookfrom.render(scenes[1], size=16, samples=2, **options).linear == expected).all()
    session = lookfrom.Session(scenes[1], size=16, samples=2, keep=True)
    session.set(**options)
    session.set_material("grey", type="diffuse", reflectance=Tensor([0.1, 0.2, 0.3]))
    assert (session.render().linear == expected).all()


def test_pictures_of_pillow_are_images() -> None:
    image = pytest.importorskip("PIL.Image")
    pixels = np.arange(48, dtype=np.uint8).reshape(4, 4, 3)
    scenes = [lookfrom.Scene(), lookfrom.Scene()]
    for scene, file in zip(scenes, (pixels, image.fromarray(pixels)), strict=True):
        scene.texture("map", type="image", file=file)
    assert scenes[0]._in_memory() == scenes[1]._in_memory()


def test_images_of_lights_and_matrices_may_be_arrays(tmp_path: Path) -> None:
    pose = np.array([[0, -1, 0, 0.5], [1, 0, 0, 0], [0, 0, 1, 0.2], [0, 0, 0, 1.0]])
    scene, plain = lookfrom.Scene(), lookfrom.Scene()
    for other, turned in ((scene, pose), (plain, [{"matrix": pose.ravel().tolist()}])):
        other.mesh(VERTICES, FACES, transform=turned)
        other.light(type="environment", image=np.linspace(0, 1, 24).reshape(2, 4, 3))
    camera = np.diag([-1.0, 1, -1, 1])
    camera[:3, 3] = 0, 0, 5
    scene.camera(matrix=camera, lookat=[0, 0, 0])
    plain.camera(matrix=camera.ravel().tolist(), lookat=[0, 0, 0])
    assert scene == plain
    expected = lookfrom.render(plain, size=16, samples=2).linear
    assert (lookfrom.render(scene, size=16, samples=2).linear == expected).all() and expected.max() > 0
    scene.save(tmp_path / "a.toml")
    assert (lookfrom.render(tmp_path / "a.toml", size=16, samples=2).linear == expected).all()


def test_arrays_of_a_loaded_scene_stay(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    mesh_scene().save(path)
    scene = lookfrom.Scene.load(path)
    scene.mesh(0.5 * VERTICES, FACES, translate=[1, 0, 0])
    fresh = mesh_scene()
    fresh.mesh(0.5 * VERTICES, FACES, translate=[1, 0, 0])
    expected = lookfrom.Session(fresh, size=32).labels().position
    assert np.array_equal(lookfrom.Session(scene, size=32).labels().position, expected, equal_nan=True)
    scene.save(path)
    assert np.array_equal(lookfrom.Session(path, size=32).labels().position, expected, equal_nan=True)


def test_names_of_files_follow_a_scene_to_another_folder(tmp_path: Path) -> None:
    for folder in ("here/maps", "there/deeper"):
        (tmp_path / folder).mkdir(parents=True)
    lookfrom.render(mesh_scene(), size=8, samples=1).save(tmp_path / "here/maps/a.png")
    mesh_scene().save(tmp_path / "here/part.toml")
    scene = lookfrom.Scene({"import": ["part.toml"]}, folder=tmp_path / "here")
    scene.data["variables"] = {"picture": "maps/a.png"}
    scene.texture("maps/a.png", type="image", file="= picture")
    scene.material("map", type="diffuse", reflectance="maps/a.png", normal_map="maps/a.png")
    scene.add("sphere", center=[0, 0, 0], radius=0.3, material="map", name="part.toml")
    scene.save(tmp_path / "there/deeper/scene.toml")
    saved = lookfrom.Scene.load(tmp_path / "there/deeper/scene.toml")
    assert saved.data["import"] == ["../../here/part.toml"]
    assert saved.data["variables"]["picture"] == "../../here/maps/a.png"
    assert saved.data["materials"]["map"]["normal_map"] == "../../here/maps/a.png"
    assert saved.data["materials"]["map"]["reflectance"] == "maps/a.png"
    assert saved.data["sphere"][0]["name"] == "part.toml"
    pictures = [lookfrom.render(one, size=16, samples=2).linear for one in (scene, saved)]
    assert (pictures[0] == pictures[1]).all()
    # To its own folder, nothing changes.
    scene.save(tmp_path / "here/scene.toml")
    assert lookfrom.Scene.load(tmp_path / "here/scene.toml") == scene
    with pytest.raises(lookfrom.Error, match=r"written as \.toml"):
        scene.save(tmp_path / "scene.png")


def test_scenes_are_copied_and_pickled() -> None:
    scene = mesh_scene()
    for other in (copy.copy(scene), copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))):
        assert other == scene
    other = copy.deepcopy(scene)
    other.data["mesh"][0]["positions"][0] = 9
    assert other != scene and scene != 3
    assert repr(scene) == "Scene(materials: 1, mesh: 1, light: 1, camera: 3)"


def test_a_mesh_far_away_keeps_its_details() -> None:
    far = np.array([4.1e6, 5.2e6, 100.0])
    near = mesh_scene()
    scene = lookfrom.Scene({"materials": near.data["materials"], "light": near.data["light"]})
    scene.mesh(1e-3 * VERTICES + far, FACES, material="grey")
    scene.camera(
        lookfrom=(far + 1e-3 * np.array([3, 2, 3])).tolist(),
        lookat=(far + 1e-3 * np.array([0.2, 0.3, 0.2])).tolist(),
        fov=30,
    )
    small = lookfrom.Session(scene, size=48, samples=64).labels()
    big = lookfrom.Session(near, size=48, samples=64).labels()
    assert (small.hit == big.hit).mean() > 0.995
    assert np.allclose(
        (small.position - far)[small.hit & big.hit], 1e-3 * big.position[small.hit & big.hit], atol=2e-8
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"vertices": VERTICES[:, :2]}, r"vertices has shape \(4, 2\)"),
        ({"vertices": np.zeros((6, 2))}, r"vertices has shape \(6, 2\)"),
        ({"colors": np.full((4, 3), 200)}, "colors is an array of int64 with numbers up to 200"),
        ({"faces": FACES.astype(float)}, "triangles must be integers"),
        ({"faces": -FACES}, "triangles must be integers"),
        ({"faces": FACES[:, :2]}, r"triangles is an array of int64 of shape \(4, 2\)"),
        ({"uvs": VERTICES}, "uvs is an array"),
        ({"normals": [["a"] * 3] * 4}, "normals is an array of <U1"),
    ],
)
def test_arrays_that_make_no_mesh(words: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        lookfrom.Scene().mesh(**{"vertices": VERTICES, "faces": FACES, **words})


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        (VERTICES, FACES + 1, "there is no vertex 4"),
        (np.full((4, 3), np.nan), FACES, "not finite"),
        (1e300 * VERTICES, FACES, "not finite"),
        (VERTICES, FACES[:0], "`triangles` is empty"),
    ],
)
def test_meshes_that_make_no_scene(vertices: Any, faces: Any, message: str) -> None:
    scene = lookfrom.Scene()
    with np.errstate(over="ignore"):
        scene.mesh(vertices, faces)
        with pytest.raises(lookfrom.SceneError, match=message):
            lookfrom.Session(scene)


def test_colours_of_vertices_paint() -> None:
    scene = lookfrom.Scene()
    scene.mesh(VERTICES, FACES, colors=[[0.8, 0, 0]] * 4)
    scene.light(type="environment", color=1)
    picture = lookfrom.render(scene, size=33, samples=16, view="iso")
    middle = picture.linear[16, 16]
    assert middle[0] > 0.3 and middle[1] == 0


def test_colours_of_bytes_are_those_of_screens() -> None:
    shown = np.array([[200, 100, 50], [0, 255, 10], [1, 2, 3], [128, 128, 128]], np.uint8)
    light = lookfrom.linear(shown)
    scene, expected = lookfrom.Scene(), lookfrom.Scene()
    scene.mesh(VERTICES, FACES, colors=shown)
    expected.mesh(VERTICES, FACES, colors=light)
    assert scene == expected and (scene.data["mesh"][0]["colors"] == light).all()
    # Also in a dictionary, as a file and as text.
    plain = copy.deepcopy(expected.data)
    plain["mesh"][0]["colors"] = shown
    assert lookfrom.Scene(plain) == expected
    assert lookfrom.Scene(plain)._in_memory() == expected._in_memory()
    assert lookfrom.Scene.from_toml(lookfrom.Scene(plain).to_toml()) == expected
    scene.points(VERTICES, 0.1, colors=shown)
    expected.points(VERTICES, 0.1, colors=light)
    assert scene == expected
    scene.light(type="environment", color=1)
    assert lookfrom.render(scene, size=16, samples=1).linear.max() < 1.1


def test_colours_of_screens_become_light() -> None:
    expected = [1, 0.21404114, 0]
    for color in ("#ff8000", [255, 128, 0, 9], [1, 128 / 255, 0], [1, 128 / 255, 0, 0.5]):
        array = np.array(color, np.uint8) if isinstance(color, list) and max(color) > 1 else color
        assert np.allclose(lookfrom.linear(array)[..., :3], [1, 0.2158605, 0], atol=1e-6)
    assert np.allclose(lookfrom.linear([[1, 0.5, 0]]), [expected], atol=1e-6)
    for color, message in [
        ("#12345", "no colour|not installed"),
        ([1, 2, 3], "from 0 to 1"),
        ([1, 1], "shape"),
        ("#gggggg", "hex"),
    ]:
        with pytest.raises(lookfrom.Error, match=message):
            lookfrom.linear(color)
    if importlib.util.find_spec("matplotlib"):
        assert np.allclose(lookfrom.linear("tab:orange"), lookfrom.linear("#ff7f0e"))


def test_points_are_spheres() -> None:
    scene = lookfrom.Scene()
    scene.points(np.eye(3), 0.1, colors=np.eye(3))
    assert [sphere["radius"] for sphere in scene.data["sphere"]] == [0.1] * 3
    session = lookfrom.Session(scene, size=64)
    labels = session.labels()
    assert (
        len(np.unique(labels.shape[labels.hit])) == 3
        and len(labels.mask(material="point 1 0 0").nonzero()[0]) > 9
    )
    with pytest.raises(lookfrom.Error, match=r"points has shape \(3, 2\)"):
        scene.points(np.eye(3)[:, :2], 0.1)
    with pytest.raises(lookfrom.Error, match="colors has 2 rows"):
        scene.points(np.eye(3), 0.1, colors=np.eye(3)[:2])


def test_meshes_of_trimesh() -> None:
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere()
    ball.visual.vertex_colors = [255, 0, 0, 255]
    picture = lookfrom.render(ball, size=32, samples=8)
    middle = picture.linear[16, 16]
    assert middle[0] > 0.2 and middle[1] < 0.1 * middle[0]


def test_what_toml_cannot_say() -> None:
    with pytest.raises(TypeError, match="object is nothing that a scene can have"):
        lookfrom.Scene({"a": object()}).to_toml()
    with pytest.raises(TypeError, match="is no name"):
        _toml.value({3: 4})
    with pytest.raises(lookfrom.Error, match="no TOML"):
        lookfrom.Scene.from_toml("= 3")
