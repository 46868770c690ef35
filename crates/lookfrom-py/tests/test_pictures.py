"""Pictures: sessions, their options, what changes them, films; the same bits as the command's."""

from __future__ import annotations

import contextlib
import copy
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lookfrom

BALL = {
    "camera": {"lookfrom": [0, 1, 5], "lookat": [0, 0.5, 0], "fov": 40},
    "image": {"width": 48, "height": 32},
    "render": {"integrator": "path", "samples": 4},
    "materials": {"red": {"type": "diffuse", "reflectance": [0.8, 0.1, 0.1]}},
    "sphere": [{"center": [0, 0.5, 0], "radius": 0.5, "material": "red"}],
    "light": [{"type": "point", "position": [2, 4, 4], "intensity": 20}],
}


@pytest.fixture
def ball(tmp_path: Path) -> Path:
    path = tmp_path / "ball.toml"
    lookfrom.Scene(BALL).save(path)
    return path


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "lookfrom", *arguments], cwd=cwd, capture_output=True, text=True
    )


def test_a_picture_has_its_arrays() -> None:
    picture = lookfrom.render(BALL, layers="geometry", background="transparent")
    assert picture.size == (48, 32) and picture.samples == 4 and picture.reason == "samples"
    assert picture.linear.shape == (32, 48, 3) and picture.linear.dtype == np.float32
    assert picture.srgb.shape == (32, 48, 4) and picture.srgb.dtype == np.uint8
    assert picture.alpha is not None and picture.alpha[16, 24] == 1 and picture.alpha[0, 0] == 0
    # Red in the middle, and nearer than the centre.
    red, green, _ = picture.linear[18, 24]
    assert red > 4 * green > 0
    assert 4.4 < picture["depth"][18, 24] < 5.1
    assert np.allclose(np.linalg.norm(picture["normal"][18, 24]), 1, atol=1e-3)
    assert np.allclose(picture["albedo"][18, 24], [0.8, 0.1, 0.1], atol=1e-3)
    assert set(picture) == {"albedo", "geometric_normal", "normal", "position", "depth", "uv", "variance"}
    with pytest.raises(KeyError, match="there is no layer 'z'; there are albedo"):
        picture["z"]
    assert np.asarray(picture).shape == (32, 48, 3)
    assert picture._repr_png_().startswith(b"\x89PNG")
    assert picture.header["integrator"] == "path"


def test_light_by_wavelength_and_in_bands() -> None:
    bands = {"red": {"curve": [[600, 0], [650, 1], [700, 0]]}, "all": {"constant": 1}}
    image = {"width": 6, "height": 4, "filter": "box", "bands": bands, "spectral_buckets": 3}
    sky = {"type": "environment", "color": {"constant": 1}}
    picture = lookfrom.render(
        {"image": image, "light": [sky]}, integrator="path", color="spectral", samples=16
    )
    assert set(picture) == {"spectrum", "band.red", "band.all"}
    assert picture["spectrum"].shape == (4, 6, 3) and picture["band.red"].shape == (4, 6)
    # The same radiance everywhere: its integral over all wavelengths, and times the response.
    radiance = picture["spectrum"].mean()
    assert np.allclose(picture["band.all"], 470 * radiance, rtol=1e-3)
    assert np.isclose(picture["band.red"].mean(), 50 * radiance, rtol=0.3)


def test_the_command_is_there_and_has_the_same_bytes(ball: Path) -> None:
    done = run("render", "ball.toml", "--size=40x30", "--samples=3", "-o", "a.exr", cwd=ball.parent)
    assert done.returncode == 0, done.stderr
    lookfrom.render(ball, size=(40, 30), samples=3).save(ball.parent / "b.exr")
    assert (ball.parent / "a.exr").read_bytes() == (ball.parent / "b.exr").read_bytes()
    wrong = run("render", "none.toml", cwd=ball.parent)
    assert wrong.returncode == 1 and "no such file" in wrong.stderr
    assert run("--version", cwd=ball.parent).stdout.startswith("lookfrom ")


def test_sources_are_the_same_scene(ball: Path) -> None:
    pictures = [
        lookfrom.render(ball),
        lookfrom.render(str(ball)),
        lookfrom.render(BALL),
        lookfrom.render(lookfrom.Scene(BALL)),
        lookfrom.render(ball.read_bytes(), name="ball.toml"),
        lookfrom.Session(ball).render(),
    ]
    assert all((picture.linear == pictures[0].linear).all() for picture in pictures)
    with pytest.raises(lookfrom.Error, match="name is '', but"):
        lookfrom.render(b"x")
    with pytest.raises(TypeError, match="a scene is a name"):
        lookfrom.render(3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"sampels": 3}, "there is no option sampels: did you mean samples"),
        ({"samples": 0}, "samples is"),
        ({"samples": "many"}, 'samples is "many"; expected a whole number'),
        ({"integrator": "paths"}, 'integrator is "paths"; expected one of'),
        ({"lookfrom": [0, 1]}, "lookfrom is"),
        ({"lookfrom": [0, 1, float("nan")]}, "lookfrom is"),
        ({"size": 32, "width": 32}, "exclude each other"),
        ({"samples": range(0, 8, 2)}, "the step 1"),
        ({"background": (2, 0, 0)}, "three numbers from 0 to 1"),
        ({"environment": np.zeros((3, 3, 4))}, "floats or uint8 of shape"),
        ({"output": "a.png"}, "there is no option output"),
        ({"turn": "north"}, "turn is"),
        ({"memory": "much"}, "memory is"),
    ],
)
def test_options_that_make_no_sense_are_told(options: dict[str, Any], message: str) -> None:
    with pytest.raises(lookfrom.Error, match=message):
        lookfrom.render(BALL, **options)


def test_options_of_no_possible_type() -> None:
    with pytest.raises(TypeError, match="seed is object"):
        lookfrom.render(BALL, seed=object())  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="define must be a dictionary"):
        lookfrom.render(BALL, define=["a"])  # type: ignore[arg-type]


def test_every_option_is_described_and_typed() -> None:
    described = lookfrom.options()
    assert set(described) == set(lookfrom.Options.__annotations__)
    assert all(described.values())


def test_errors_have_their_place(ball: Path) -> None:
    ball.write_text(ball.read_text().replace("radius =", "radiuss ="))
    with pytest.raises(lookfrom.SceneError, match="unknown key `radiuss`") as caught:
        lookfrom.render(ball)
    error = caught.value
    assert (Path(error.file), error.kind, error.column) == (ball, "invalid", 1)
    assert ball.read_text().splitlines()[error.line - 1].startswith("radiuss")
    assert error.hint is not None and "radius" in error.hint
    assert "^^^^^^^" in str(error)
    with pytest.raises(lookfrom.SceneError) as caught:
        lookfrom.render("nowhere.glb")
    assert caught.value.kind == "io" and caught.value.file == "nowhere.glb"
    with pytest.raises(lookfrom.SceneError, match="field of view") as caught:
        camera = {"lookfrom": [0, 1, 5], "lookat": [0, 0, 0], "projection": "orthographic", "height": 3}
        lookfrom.render({**BALL, "camera": camera}, fov=30)
    assert caught.value.kind == "request"


def test_changes_need_no_reading_where_they_can_do_without(ball: Path) -> None:
    session = lookfrom.Session(ball)
    text = ball.read_text()
    ball.write_text("it is not read again")
    session.set(size=20, samples=2, exposure=1, seed=3, depth=2, integrator="whitted")
    changed = session.render()
    ball.write_text(text)
    anew = lookfrom.render(ball, size=20, samples=2, exposure=1, seed=3, depth=2, integrator="whitted")
    assert (changed.linear == anew.linear).all() and (changed.srgb == anew.srgb).all()
    # For a view the scene is read again, with all that was asked for before.
    session.set(view="front")
    anew = lookfrom.render(
        ball, size=20, samples=2, seed=3, depth=2, integrator="whitted", view="front", exposure=1
    )
    assert (session.render().linear == anew.linear).all()
    session.set(view=None, width=30, height=20)
    assert session.size == (30, 20) and np.allclose(session.camera.lookfrom, [0, 1, 5])
    # Parts and filters that follow others are as if asked for from the start.
    session.set(samples=4, part=(1, 2))
    session.set(part=(2, 2))
    session.set(fireflies="median", light_path={"sky": "C<L.>"})
    session.set(fireflies="off", light_path={"direct": "C<RD>L"})
    anew = lookfrom.render(
        ball, width=30, height=20, samples=4, part=(2, 2), seed=3, depth=2, integrator="whitted", exposure=1
    )
    picture = session.render()
    assert (picture.linear == anew.linear).all() and list(picture) == ["direct"]
    # A limit of time does not replace a number of samples that was asked for.
    session.set(part=None, time=60)
    assert session.samples == 4
    with pytest.raises(lookfrom.Error):
        session.set(samples="x")  # type: ignore[typeddict-item]


def test_a_camera_that_moves_sees_what_it_should() -> None:
    session = lookfrom.Session(BALL, samples=16)
    session.set(lookfrom=(3, 1, 0), lookat=(0, 0.5, 0))
    assert np.allclose(session.camera.lookfrom, [3, 1, 0])
    anew = lookfrom.render(BALL, samples=16, lookfrom=(3, 1, 0), lookat=(0, 0.5, 0))
    assert np.allclose(session.render().linear.mean(), anew.linear.mean(), rtol=0.02)


def test_materials_and_lights_change_on_the_same_trees() -> None:
    session = lookfrom.Session(BALL, keep=True)
    session.set_material("red", type="diffuse", reflectance=[0.1, 0.1, 0.8])
    session.set_lights([{"type": "point", "position": [2, 4, 4], "intensity": 40}])
    other = copy.deepcopy(BALL)
    other["materials"]["red"]["reflectance"] = [0.1, 0.1, 0.8]  # type: ignore[index]
    other["light"][0]["intensity"] = 40  # type: ignore[index]
    assert (session.render().linear == lookfrom.render(other).linear).all()
    # Also where the scene is read again, and in copies.
    session.set(view="front")
    assert (session.render().linear == lookfrom.render(other, view="front").linear).all()
    assert (copy.deepcopy(session).render().linear == session.render().linear).all()
    with pytest.raises(lookfrom.Error, match='there is no material "blue"; the scene has "red"'):
        session.set_material("blue", type="diffuse")
    with pytest.raises(lookfrom.SceneError, match="reflektance"):
        session.set_material("red", type="diffuse", reflektance=1)
    with pytest.raises(lookfrom.Error, match="keep=True"):
        lookfrom.Session(BALL).set_material("red", type="diffuse", reflectance=1)


def test_instances_move_on_the_trees_of_their_objects() -> None:
    scene = lookfrom.Scene({**BALL, "sphere": []})
    scene.data["objects"] = {"ball": {"sphere": [{"center": [0, 0, 0], "radius": 0.5, "material": "red"}]}}
    for x in (-1.0, 1.0):
        scene.add("instance", object="ball", translate=[x, 0.5, 0])
    session = lookfrom.Session(scene, keep=True)
    pose = np.eye(4)
    pose[:3, 3] = [0.25, 0.75, 0]
    session.set_poses({1: pose})
    scene.data["instance"][1]["translate"] = [0.25, 0.75, 0]
    assert (session.render().linear == lookfrom.render(scene).linear).all()
    # Also where the scene is read again.
    session.set(light_sampler="power")
    assert (session.render().linear == lookfrom.render(scene, light_sampler="power").linear).all()
    with pytest.raises(lookfrom.SceneError, match="there is no instance 2"):
        session.set_poses({2: pose})
    with pytest.raises(lookfrom.Error, match="pose 0 is not a finite affine matrix"):
        session.set_poses({0: np.ones((4, 4))})
    with pytest.raises(lookfrom.SceneError):
        session.set_poses({0: np.diag([1, 0, 1, 1])})


def test_an_environment_may_be_an_array() -> None:
    white = np.ones((4, 8, 3), np.float32)
    scene = {key: value for key, value in BALL.items() if key != "light"}
    lit = lookfrom.render(scene, environment=white, samples=64).linear
    assert np.allclose(lit[0, 0], 1, atol=1e-3)
    # Half of the light that a white ball would reflect, at most: the albedo.
    assert 0.7 < lit[18, 24, 0] < 0.85 and 0.05 < lit[18, 24, 1] < 0.15
    white[0, 0] = np.nan
    with pytest.warns(lookfrom.SceneWarning, match="3 values are not finite"):
        session = lookfrom.Session(scene, environment=white)
    session.set(environment=np.ones((4, 8, 3)))
    assert not any("finite" in text for text in session.warnings)
    with pytest.warns(lookfrom.SceneWarning, match="3 values are not finite"):
        session.set(environment=white)


def test_films_add_up_bit_for_bit(ball: Path) -> None:
    whole = lookfrom.render(ball, samples=8, film=True)
    parts = [lookfrom.render(ball, samples=8, film=True, part=(index, 3)).film for index in (2, 1, 3)]
    merged = lookfrom.Film.merge(part for part in parts if part is not None)
    assert merged.is_complete and merged.samples == 8 * 48 * 32
    assert (merged.develop().linear == whole.linear).all()
    assert (pickle.loads(pickle.dumps(merged)).develop().linear == whole.linear).all()
    # On disk, developed otherwise, and gone on with, also by the command.
    half = lookfrom.render(ball, samples=(0, 4), film=True).film
    assert half is not None
    half.save(ball.parent / "half.exr")
    read = lookfrom.Film.read(ball.parent / "half.exr")
    assert (read.resume(samples=8).linear == whole.linear).all()
    assert (lookfrom.Session(ball, samples=8, film=True).render(film=read).linear == whole.linear).all()
    assert run("resume", "half.exr", "--samples=8", "-o", "all.exr", cwd=ball.parent).returncode == 0
    assert (lookfrom.Film.read(ball.parent / "all.exr").develop().linear == whole.linear).all()
    assert (read.develop(exposure=1).srgb > read.develop().srgb).any()
    with pytest.raises(lookfrom.SceneError):
        lookfrom.Film.merge([read, read])
    with pytest.raises(lookfrom.SceneError, match="film=True"):
        lookfrom.render(ball).save(ball.parent / "no.exr")
        lookfrom.Film.read(ball.parent / "no.exr")
    with pytest.raises(ValueError, match="no films"):
        lookfrom.Film.merge([])


def test_films_are_developed_otherwise_or_say_why_not() -> None:
    film = lookfrom.render(BALL, film=True, fireflies="median", samples=8).film
    plain = lookfrom.render(BALL, film=True, samples=8).film
    transparent = lookfrom.render(BALL, film=True, background="transparent").film
    assert film is not None and plain is not None and transparent is not None
    assert film.develop().header["fireflies"] == "median"
    off = film.develop(fireflies="off")
    assert "fireflies" not in off.header and off.header == plain.develop().header
    assert (off.linear == plain.develop().linear).all()
    assert plain.develop(fireflies="median").header["fireflies"] == "median"
    assert (transparent.develop(background="white").srgb[0, 0, :3] == 255).all()
    assert (film.develop(background="environment").linear == film.develop().linear).all()
    exposed = film.develop(exposure="auto")
    assert exposed.header["exposure"] != film.develop().header["exposure"]
    assert (film.develop(exposure=float(exposed.header["exposure"])).srgb == exposed.srgb).all()
    assert film.develop(samples=None, exposure=1, tonemap="filmic", denoise=True).size == (48, 32)  # type: ignore[typeddict-item]
    for options, message in [
        ({"size": 16}, "size needs another render; the development of a film has background, denoise"),
        ({"samples": 16}, "samples needs another render"),
        ({"exposure": 1, "lookfrom": (1, 2, 3)}, "lookfrom needs another render"),
        ({"time": 3}, "time needs another render"),
        ({"threads": 1}, "threads needs another render"),
        ({"background": "white"}, "background cannot become #ffffff: the film has no alpha"),
        ({"background": "transparent"}, "background cannot become transparent: the film has no alpha"),
        ({"exposed": 1}, "there is no option exposed"),
        ({"tonemap": "none"}, "tonemap is"),
    ]:
        with pytest.raises(lookfrom.Error, match=message):
            film.develop(**options)  # type: ignore[arg-type]
    with pytest.raises(lookfrom.Error, match="background cannot become environment: the film has no env"):
        transparent.develop(background="environment")


@contextlib.contextmanager
def _full_disk() -> Iterator[None]:
    """What is written fails after 64 bytes of a file."""
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    # Otherwise it is a signal that ends the process.
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (64, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_pictures_of_16_bits(tmp_path: Path) -> None:
    picture = lookfrom.render(BALL)
    picture.save(tmp_path / "whole.exr", bits=32)
    assert (tmp_path / "whole.exr").read_bytes() == picture.encode(".exr")
    assert len(picture.encode("exr", bits=16)) < len(picture.encode("exr"))
    assert len(picture.encode("png", bits=16)) > len(picture.encode("png"))
    with pytest.raises(lookfrom.SceneError, match="JPEG pictures have no channels of 16 bits"):
        picture.encode("jpg", bits=16)


def test_files_that_cannot_be_written_stay_as_they_were(tmp_path: Path) -> None:
    picture = lookfrom.render(BALL, film=True)
    film = picture.film
    assert film is not None
    scene = lookfrom.Scene(BALL)
    scene.mesh(np.eye(3), [[0, 1, 2]])
    picture.save(tmp_path / "a.png")
    film.save(tmp_path / "film.exr")
    scene.save(tmp_path / "scene.toml")
    before = _contents(tmp_path)
    assert sorted(before) == ["a.png", "film.exr", "scene-0.npy", "scene-1.npy", "scene.toml"]
    scene.data["sphere"] = [{**scene.data["sphere"][0], "radius": 0.25}]
    scene.data["mesh"][0]["positions"] = 2 * scene.data["mesh"][0]["positions"]
    with _full_disk():
        with pytest.raises(OSError, match=r"a\.png"):
            picture.save(tmp_path / "a.png")
        with pytest.raises(lookfrom.SceneError, match=r"film\.exr"):
            film.save(tmp_path / "film.exr")
        with pytest.raises(OSError, match="scene"):
            scene.save(tmp_path / "scene.toml")
    assert _contents(tmp_path) == before
    for name in ("none/a.png", "a.png/b.png"):
        with pytest.raises((FileNotFoundError, NotADirectoryError)) as caught:
            picture.save(tmp_path / name)
        assert Path(caught.value.filename) == tmp_path / name
    scene.save(tmp_path / "scene.toml")
    assert lookfrom.Scene.load(tmp_path / "scene.toml").data["sphere"][0]["radius"] == 0.25
    assert sorted(_contents(tmp_path)) == sorted(before)


@pytest.mark.skipif(os.name != "posix", reason="links and permissions are those of Unix")
def test_links_and_permissions_of_replaced_files_stay(tmp_path: Path) -> None:
    picture = lookfrom.render(BALL)
    (tmp_path / "real").mkdir()
    for target in ("there.png", "new.png"):
        (tmp_path / target).symlink_to(Path("real") / target)
    (tmp_path / "real/there.png").write_bytes(b"old")
    (tmp_path / "real/there.png").chmod(0o640)
    for target in ("there.png", "new.png"):
        picture.save(tmp_path / target)
        assert (tmp_path / target).is_symlink()
        assert (tmp_path / "real" / target).read_bytes() == picture.encode("png")
    assert (tmp_path / "real/there.png").stat().st_mode & 0o777 == 0o640
    assert sorted(_contents(tmp_path / "real")) == ["new.png", "there.png"]
    # What is no file is written to.
    (tmp_path / "null.png").symlink_to("/dev/null")
    picture.save(tmp_path / "null.png")
    assert Path("/dev/null").is_char_device()


def test_progress_is_told_and_can_stop() -> None:
    told: list[tuple[int, int]] = []
    lookfrom.Session(BALL, samples=4096, time=0.5).render(
        progress=lambda done, total: told.append((done, total))
    )
    assert told and all(0 <= done <= total for done, total in told)

    def stop(done: int, total: int) -> None:
        if done > 0:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough") as caught:
        lookfrom.Session(BALL, samples=1 << 20).render(progress=stop)
    picture = caught.value.picture  # type: ignore[attr-defined]
    assert (
        isinstance(picture, lookfrom.Picture) and picture.reason == "interrupt" and picture.linear.max() > 0
    )


def test_ctrl_c_stops_and_keeps_the_picture() -> None:
    timer = threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT))
    session = lookfrom.Session(BALL, samples=1 << 22)
    started = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt) as caught:
        session.render()
    assert time.monotonic() - started < 20
    assert caught.value.picture.linear.max() > 0  # type: ignore[attr-defined]


def _waited(attempt: Callable[[], Any]) -> Any:
    """The result of an attempt that succeeds within 20 seconds."""
    for _ in range(400):
        with contextlib.suppress(OSError):
            return attempt()
        time.sleep(0.05)
    return attempt()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes with names")
def test_ctrl_c_ends_every_command(tmp_path: Path) -> None:
    # A scene that never comes.
    os.mkfifo(tmp_path / "scene.toml")
    command = [sys.executable, "-m", "lookfrom", "info", "scene.toml"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.DEVNULL) as child:
        try:
            # The pipe can be opened once the command waits for it.
            pipe = _waited(lambda: os.open(tmp_path / "scene.toml", os.O_WRONLY | os.O_NONBLOCK))
            child.send_signal(signal.SIGINT)
            assert child.wait(timeout=10) == -signal.SIGINT
            os.close(pipe)
        finally:
            child.kill()


def test_ctrl_c_keeps_the_picture_of_the_command(ball: Path) -> None:
    words = ["ball.toml", "--samples=4000000", "--write-every=1s", "-o", "a.png"]
    command = [sys.executable, "-m", "lookfrom", "render", *words]
    with subprocess.Popen(command, cwd=ball.parent, stderr=subprocess.DEVNULL) as child:
        try:
            # After the first preview.
            _waited((ball.parent / "a.png").unlink)
            child.send_signal(signal.SIGINT)
            child.wait(timeout=60)
        finally:
            child.kill()
    assert child.returncode == 130 and (ball.parent / "a.png").read_bytes().startswith(b"\x89PNG")


def test_sessions_are_safe_with_threads() -> None:
    session = lookfrom.Session(BALL)
    expected = session.render().linear
    results: list[Any] = [None] * 4

    def work(index: int) -> None:
        results[index] = session.render().linear if index % 2 else lookfrom.render(BALL).linear

    threads = [threading.Thread(target=work, args=(index,)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all((result == expected).all() for result in results)


def _everything(_: int) -> list[float]:
    """Numbers of all calls that divide their work: large enough that they do."""
    session = lookfrom.Session(BALL, size=200, samples=1, film=True, denoise=True, layers="geometry")
    picture = session.render()
    assert picture.film is not None
    copied = pickle.loads(pickle.dumps(picture.film))
    return [
        float(picture.linear.mean()),
        float(picture.srgb.mean()),
        float(picture["depth"].mean()),
        len(picture.encode("exr")),
        float(copied.develop(exposure=1).srgb.mean()),
        float(session.labels().depth[100, 100]),
        len(session.inspect(100, 100).svg),
        session.inspect_pixel(100, 100).samples,
    ]


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes_render_the_same(method: str) -> None:
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {method} here")
    # What the parent has started, threads above all, is not there in a process that is forked off.
    expected = _everything(0)
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map_async(_everything, range(2)).get(timeout=120) == [expected, expected]


def test_sessions_are_copied_and_pickled() -> None:
    session = lookfrom.Session(BALL, size=24)
    expected = session.render().linear
    for other in (copy.copy(session), copy.deepcopy(session), pickle.loads(pickle.dumps(session))):
        assert (other.render().linear == expected).all()


KNOT = Path(__file__).parents[3] / "scenes/models/knot.obj"


@pytest.mark.parametrize(
    ("options", "changes"),
    [
        # A model is framed and lit when it is read; later it keeps its light, and what sees it is moved.
        ({}, [{"size": (12, 30)}]),
        ({}, [{"width": 10}, {"height": 20}]),
        ({}, [{"fov": 20}]),
        ({}, [{"up": "z"}]),
        ({}, [{"integrator": "whitted"}]),
        ({"view": "persp"}, [{"lookfrom": (1, 2, 5), "lookat": (0, 0, 0)}]),
        ({"azimuth": 20}, [{"lookfrom": (1, 2, 5)}, {"seed": 3}]),
        ({}, [{"crop": (1, 1, 9, 8)}, {"size": 32}]),
        ({}, [{"lookfrom": (1, 2, 5)}, {"exposure": "auto"}, {"lookfrom": (0, 9, 9)}]),
        ({"turn": 0}, [{"lookfrom": (1, 2, 5)}, {"turn": 30}]),
    ],
)
def test_changed_sessions_stay_as_they_are(options: dict[str, Any], changes: list[dict[str, Any]]) -> None:
    if not KNOT.exists():
        pytest.skip("this is not a clone of the repository")
    session = lookfrom.Session(KNOT, **{"size": (24, 16), "samples": 1, **options})
    for change in changes:
        session.set(**change)
    expected, camera = session.render().srgb, session.camera
    for other in (copy.copy(session), pickle.loads(pickle.dumps(session))):
        assert np.array_equal(other.render().srgb, expected)
    # Also where the scene is read again.
    session.set(environment=np.ones((2, 4, 3)))
    assert np.array_equal(session.camera.lookfrom, camera.lookfrom)
    assert np.array_equal(session.camera.intrinsics, camera.intrinsics)


def test_pictures_tell_what_can_be_pickled() -> None:
    picture = lookfrom.render(BALL, size=4, samples=1)
    with pytest.raises(TypeError, match=r"cannot be pickled: give other processes its arrays \(linear"):
        pickle.dumps(picture)
    assert copy.deepcopy([picture])[0] is picture


def test_a_copy_changes_by_itself() -> None:
    session = lookfrom.Session(BALL, size=24, keep=True)
    other = copy.copy(session)
    other.set(fov=90)
    other.set_material("red", type="diffuse", reflectance=0)
    assert (session.render().linear == lookfrom.render(BALL, size=24).linear).all()
    assert other.camera.intrinsics[0, 0] < session.camera.intrinsics[0, 0]


def test_a_session_can_be_put_on_a_turntable() -> None:
    session = lookfrom.Session(BALL)
    session.set(lookfrom=(1, 1, 4))
    session.set(turn=30)
    assert (session.render().linear == lookfrom.render(BALL, turn=30).linear).all()


def test_films_of_changed_sessions_are_resumed(ball: Path) -> None:
    session = lookfrom.Session(ball, samples=2, film=True)
    for change in ({"seed": 5}, {"size": 20}, {"lookfrom": (1, 2, 5)}, {"depth": 2}):
        session.set(**change)
    film = session.render().film
    session.set(samples=4)
    assert film is not None and (film.resume(samples=4).linear == session.render().linear).all()


@pytest.mark.filterwarnings("ignore")
@pytest.mark.slow
def test_many_renders_take_no_memory() -> None:
    def resident() -> int:
        return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

    if not Path("/proc/self/statm").exists():
        pytest.skip("no /proc here")
    session = lookfrom.Session(BALL, size=16, samples=1)
    for _ in range(200):
        session.render().srgb.sum()
        lookfrom.render(BALL, size=16, samples=1)
    before = resident()
    for _ in range(400):
        session.render().srgb.sum()
        lookfrom.render(BALL, size=16, samples=1)
    assert resident() - before < 0.02 * before, (before, resident())


def test_warnings_are_warnings(tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_text("ply\nformat ascii 1.0\nend_header\n")
    with pytest.warns(lookfrom.SceneWarning, match="no geometry|no vertices"):
        session = lookfrom.Session(tmp_path / "a.ply")
    assert any("no geometry" in text for text in session.warnings)


def test_a_page_is_served() -> None:
    import urllib.request

    with lookfrom.show(BALL, browser=False) as page:
        assert page.url.startswith("http://127.0.0.1:")
        with urllib.request.urlopen(page.url) as answer:
            assert answer.status == 200 and b"<html" in answer.read().lower()
            # A notebook may show it.
            assert "frame-ancestors http://localhost:*" in answer.headers["Content-Security-Policy"]
        assert page.url in page._repr_html_()
    with pytest.raises(OSError):
        urllib.request.urlopen(page.url, timeout=2)


def test_a_page_of_a_scene_finds_its_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import tempfile

    for name in ("temporary", "mine"):
        (tmp_path / name).mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    lookfrom.Scene(BALL).save(tmp_path / "mine/ball.toml")
    scene = lookfrom.Scene({"import": "ball.toml"}, folder=tmp_path / "mine")
    expected = lookfrom.render(BALL, size=8, samples=1, environment=np.ones((2, 4, 3))).linear
    with lookfrom.show(scene, browser=False, environment=np.ones((2, 4, 3))):
        (folder,) = (tmp_path / "temporary").iterdir()
        shown = lookfrom.render(
            folder / "scene.toml", size=8, samples=1, environment=folder / "environment.pfm"
        )
        assert (shown.linear == expected).all()
    assert not list((tmp_path / "temporary").iterdir())


def test_a_page_of_bytes_stays_in_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import tempfile

    # Where temporary folders are made.
    (tmp_path / "inner").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "inner"))
    cube = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    for name in ("../evil.obj", "a/../../evil.obj", str(tmp_path / "evil.obj")):
        with pytest.raises(lookfrom.Error, match="one within a folder is expected"):
            lookfrom.show(cube, name=name, browser=False)
    assert [path.name for path in tmp_path.rglob("*")] == ["inner"]
    with lookfrom.show(cube, name="models/cube.obj", browser=False):
        (file,) = (path for path in tmp_path.rglob("*") if path.is_file())
        assert file.read_bytes() == cube and file.parts[-2:] == ("models", "cube.obj")
