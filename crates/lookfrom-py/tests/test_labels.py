"""Labels, cameras as matrices, optical flow: against points of the world."""

from __future__ import annotations

import copy
import os
import pickle
import signal
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_scenes import FACES, VERTICES, mesh_scene

import lookfrom


@pytest.mark.parametrize(
    "words", [{"fov": 30}, {"fov": 75, "up": [1, 2, 0]}, {"projection": "orthographic", "height": 2}]
)
def test_projected_points_are_in_their_pixels(words: dict[str, object]) -> None:
    scene = mesh_scene()
    scene.data["camera"] = {"lookfrom": [3, 2, 3], "lookat": [0.2, 0.3, 0.2], **words}
    session = lookfrom.Session(scene, size=(60, 40))
    labels, camera = session.labels(), session.camera
    rows, columns = np.nonzero(labels.hit)
    assert len(rows) > 30
    pixels, depths = camera.project(labels.position[labels.hit])
    assert np.abs(pixels - np.stack([columns + 0.5, rows + 0.5], axis=-1)).max() < 1e-4
    assert np.allclose(depths, labels.depth[labels.hit])
    assert np.isinf(labels.depth[~labels.hit]).all() and np.isnan(labels.position[~labels.hit]).all()


def test_matrices_are_those_of_opencv_and_opengl() -> None:
    camera = lookfrom.Session(mesh_scene(), size=(64, 48)).camera
    k = camera.intrinsics
    focal = 24 / np.tan(np.radians(15))
    assert np.allclose(k, [[focal, 0, 32], [0, focal, 24], [0, 0, 1]])
    point = np.array([0.1, 0.2, 0.3, 1])
    in_opencv, in_opengl = camera.extrinsics("opencv") @ point, camera.extrinsics("opengl") @ point
    assert np.allclose(in_opencv, in_opengl * [1, -1, -1, 1]) and in_opencv[2] > 0
    for convention in ("opencv", "opengl"):
        matrix = camera.world_from_camera(convention)  # type: ignore[arg-type]
        assert np.allclose(np.linalg.det(matrix), 1) and np.allclose(matrix[:3, 3], [3, 2, 3])
    with pytest.raises(lookfrom.Error, match=r"points has shape \(2,\)"):
        camera.project([1, 2])
    with pytest.raises(lookfrom.Error, match="'opencv' or 'opengl'"):
        camera.extrinsics("blender")  # type: ignore[arg-type]
    around = lookfrom.Session(
        {"camera": {"lookfrom": [0, 0, 0], "lookat": [1, 0, 0], "projection": "equirectangular"}}
    ).camera
    with pytest.raises(lookfrom.Error, match="equirectangular"):
        around.project([1, 2, 3])


K = np.array([[50.0, 0, 21.5], [0, 45, 30.25], [0, 0, 1]])


@pytest.mark.parametrize("convention", ["opencv", "opengl"])
def test_a_camera_of_matrices_sees_what_its_rays_meet(convention: Any) -> None:
    pose = lookfrom.look_at([3, 2, 2.5], [0.2, 0.3, 0.2], [0.3, 1, 0], convention=convention)
    session = lookfrom.Session(mesh_scene(), size=(60, 40), samples=1)
    session.set_camera(pose, intrinsics=K, convention=convention)
    camera, labels = session.camera, session.labels()
    assert np.allclose(camera.intrinsics, K) and np.allclose(camera.world_from_camera(convention), pose)
    tree = lookfrom.Bvh(VERTICES, FACES)
    half = np.array([[0, 0, 0.5], [0, 0, 0.5], [0, 0, 0]])
    of_opencv = lookfrom.pinhole_rays(
        60, 40, intrinsics=K - half, world_from_camera=pose, convention=convention
    )
    for rays in (camera.rays(), of_opencv):
        hits = tree.closest_hits(*rays)
        assert hits.hit.sum() > 50 and np.array_equal(hits.primitive, labels.primitive)
        assert np.allclose(hits.t[hits.hit], labels.depth[labels.hit], atol=1e-5)
    # Other poses keep what it sees, and copies and other processes have it.
    pose[:3, 3] += 0.1
    session.set_camera(pose, convention=convention)
    session.set(size=(30, 20))
    for other in (session, copy.copy(session), pickle.loads(pickle.dumps(session))):
        assert np.allclose(other.camera.intrinsics, np.diag([0.5, 0.5, 1]) @ K)
        assert np.allclose(other.camera.world_from_camera(convention), pose)
    # A view replaces it.
    session.set(view="front")
    assert session.camera.projection == "orthographic"
    hits = tree.closest_hits(*session.camera.rays())
    assert (hits.hit == session.labels().hit).all() and hits.hit.any()


@pytest.mark.parametrize(
    ("pose", "intrinsics", "message"),
    [
        (np.eye(3), None, r"but a finite affine matrix"),
        (2 * np.eye(4), None, "but a finite affine matrix"),
        (np.diag([1, 1, -1, 1]), None, "but a rotation"),
        (np.diag([2, 2, 2, 1]), None, "but a rotation"),
        (np.full((4, 4), np.nan), None, "finite"),
        (np.eye(4), np.eye(4), "intrinsics is .* but"),
        (np.eye(4), np.add(K, [[0, 1, 0], [0, 0, 0], [0, 0, 0]]), "intrinsics is .* but"),
        (np.eye(4), -K, "intrinsics is .* but"),
    ],
)
def test_matrices_of_no_camera(pose: Any, intrinsics: Any, message: str) -> None:
    session = lookfrom.Session(mesh_scene(), size=8)
    with pytest.raises(lookfrom.Error, match=message):
        session.set_camera(pose, intrinsics=intrinsics)


def test_films_of_other_windows_do_not_go_together() -> None:
    films = []
    for samples, shift in ((range(0, 1), 0.0), (range(1, 2), 0.5)):
        session = lookfrom.Session(mesh_scene(), size=(60, 40), samples=samples, film=True)
        k = K.copy()
        k[0, 2] += shift
        session.set_camera(lookfrom.look_at([3, 2, 3], [0, 0, 0], [0, 1, 0]), intrinsics=k)
        film = session.render().film
        assert film is not None
        films.append(film)
    with pytest.raises(lookfrom.SceneError, match=r"camera\.window"):
        lookfrom.Film.merge(films)


def test_masks_and_names() -> None:
    scene = mesh_scene()
    scene.material("red", type="diffuse", reflectance=[0.8, 0.1, 0.1])
    scene.add("sphere", name="ball", center=[0.8, 0.8, 0.8], radius=0.2, material="red")
    labels = lookfrom.Session(scene, size=48).labels()
    ball, red = labels.mask(shape="ball"), labels.mask(material="red")
    assert ball.sum() > 20 and (ball == red).all()
    assert (labels.mask(material="grey") == (labels.hit & ~ball)).all()
    with pytest.raises(lookfrom.Error, match="there is no shape 'cube'; there are"):
        labels.mask(shape="cube")
    assert set(np.unique(labels.primitive[labels.mask(material="grey")])) <= set(range(len(FACES)))


def test_flow_takes_pixels_to_where_their_points_are() -> None:
    session = lookfrom.Session(mesh_scene(), size=(80, 60))
    before = session.labels()
    session.set(lookfrom=[2.9, 2.2, 3.1])
    after = session.labels()
    flow = before.flow_to(after.camera)
    assert flow.shape == (60, 80, 2) and np.isnan(flow[~before.hit]).all()
    checked = 0
    for row, column in np.argwhere(before.hit):
        x, y = np.array([column + 0.5, row + 0.5]) + flow[row, column]
        there = after.position[int(y), int(x)] if 0 <= x < 80 and 0 <= y < 60 else np.full(3, np.nan)
        # Unless an edge is near, or another surface is in front, the same place is seen there.
        if np.linalg.norm(there - before.position[row, column]) < 0.05:
            checked += 1
    assert checked > 0.9 * before.hit.sum()


def test_instances_are_told_apart() -> None:
    scene = mesh_scene()
    scene.data["objects"] = {
        "post": {"box": [{"min": [0, 0, 0], "max": [0.2, 0.2, 0.2], "material": "grey"}]}
    }
    for x in (-0.5, 1.0):
        scene.add("instance", object="post", translate=[x, 0.5, 0.5])
    labels = lookfrom.Session(scene, size=64).labels()
    assert set(np.unique(labels.instance)) == {-1, 0, 1}


def test_labels_use_as_many_threads_as_the_session() -> None:
    tasks = Path("/proc/self/task")
    if not tasks.exists():
        pytest.skip("no /proc here")
    session = lookfrom.Session(mesh_scene(), size=1000, threads=1)
    before, most, done = len(list(tasks.iterdir())), 0, threading.Event()

    def work() -> None:
        session.labels()
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        most = max(most, len(list(tasks.iterdir())))
    thread.join()
    assert most <= before + 1


def test_ctrl_c_stops_labels() -> None:
    session = lookfrom.Session(mesh_scene(), size=8000)
    timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        session.labels()
    assert time.monotonic() - started < 3
    timer.join()


def test_vertices_are_where_they_are() -> None:
    """The corners of the mesh, and not only what is seen: against the matrices by hand."""
    camera = lookfrom.Session(mesh_scene(), size=(64, 48)).camera
    pixels, depths = camera.project(VERTICES)
    homogeneous = np.hstack([VERTICES, np.ones((4, 1))]) @ camera.extrinsics().T
    by_hand = homogeneous[:, :3] @ camera.intrinsics.T
    assert np.allclose(pixels, by_hand[:, :2] / by_hand[:, 2:]) and np.allclose(depths, homogeneous[:, 2])


def test_objects_are_those_of_obj_files_and_instances(tmp_path: Path) -> None:
    squares = "\n".join(
        f"v {x} 0 0\nv {x + 1} 0 0\nv {x + 1} 1 0\nv {x} 1 0\no {name}\nf -4 -3 -2 -1"
        for x, name in enumerate(["Chair", "Table top"])
    )
    (tmp_path / "a.obj").write_text(squares)
    camera = {"lookfrom": [1, 0, 5], "lookat": [1, 0, 0], "projection": "orthographic", "height": 2}
    tile = {"quad": [{"corner": [0, -1, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}]}
    instances = [{"object": "tile"}, {"object": "tile", "name": "mine", "translate": [1, 0, 0]}]
    scene = {
        "camera": camera,
        "mesh": [{"file": str(tmp_path / "a.obj")}],
        "objects": {"tile": tile},
        "instance": instances,
    }
    labels = lookfrom.Session(scene, size=(2, 2)).labels()
    names = [[labels.object_names[index] for index in row] for row in labels.object]
    assert names == [["Chair", "Table top"], ["tile 1", "mine"]]
    assert labels.mask(object="Table top").tolist() == [[False, True], [False, False]]
    with pytest.raises(lookfrom.Error, match="there is no object 'Sofa'; there are 'Chair', 'Table top'"):
        labels.mask(object="Sofa")
