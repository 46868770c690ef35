"""The page of `lookfrom view`, from Python."""

from __future__ import annotations

import os
import tempfile
import webbrowser
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _lookfrom
from ._arrays import is_array
from ._lookfrom import Error
from ._scene import image_file
from ._session import _source, as_scene
from ._words import words

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._words import Options


class Page:
    """A page that shows a scene while it renders, and why each pixel is as it is. It is served by this process, to this
    machine only, until it is closed or collected.

    url: its address, with a token that only this process knows.

    In Jupyter it shows itself in a frame.
    """

    def __init__(self, native: _lookfrom.Page, folder: tempfile.TemporaryDirectory[str] | None) -> None:
        self._native = native
        self._folder = folder

    @property
    def url(self) -> str:
        """The address."""
        return self._native.url

    def close(self) -> None:
        """Ends the page."""
        self._native.close()
        if self._folder is not None:
            self._folder.cleanup()

    def __enter__(self) -> Page:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Page({self.url!r})"

    def _repr_html_(self) -> str:
        return f'<iframe src="{self.url}" width="100%" height="640" style="border: 0"></iframe>'


def show(
    scene: Any, *, name: str = "", port: int = 0, browser: bool | None = None, **options: Unpack[Options]
) -> Page:
    """Serves the page of a scene.

    scene, name, options: as those of Session. What is in memory is written to a temporary folder, from which the page reads it.
    port: 0 for any that is free.
    browser: whether to open the page in the user's browser; by default not in Jupyter, where the returned page shows itself.

    Raises Error for options that make no sense, and for a name of bytes that is no path within a folder; OSError where the port
    is in use. What is wrong with the scene is shown on the page.
    """
    given: dict[str, Any] = dict(options)
    made, has_map = as_scene(scene), is_array(given.get("environment"))
    path, files = ("", {}) if made is not None else _source(scene, name)
    for file in files:
        if Path(file).anchor or ".." in Path(file).parts:
            raise Error(f'name is {file!r}, but one within a folder is expected, such as "models/cube.obj"')
    folder: tempfile.TemporaryDirectory[str] | None = None
    if made is not None or files or has_map:
        folder = tempfile.TemporaryDirectory(prefix="lookfrom-")
    if folder is not None and has_map:
        extension, content = image_file(given["environment"])
        given["environment"] = os.path.join(folder.name, f"environment.{extension}")
        Path(given["environment"]).write_bytes(content)
    if folder is not None and made is not None:
        path = os.path.join(folder.name, "scene.toml")
        made.save(path)
    elif folder is not None and files:
        for file, content in files.items():
            target = Path(folder.name) / file
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
        path = os.path.join(folder.name, path)
    page = Page(_lookfrom.Page(path, words(given), port), folder)
    if browser or (browser is None and not _is_in_jupyter()):
        webbrowser.open(page.url)
    return page


def _is_in_jupyter() -> bool:
    try:
        from IPython import get_ipython
    except ImportError:
        return False
    shell = get_ipython()
    return shell is not None and type(shell).__name__ == "ZMQInteractiveShell"
