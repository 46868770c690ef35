"""Colours of other packages, which are made for screens, as linear light."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._lookfrom import Error

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def linear(color: str | ArrayLike) -> NDArray[np.float32]:
    """Linear light of colours for screens (sRGB), as materials, lights and `colors` of meshes take it.

    color: shape (..., 3) or (..., 4) of uint8, or of numbers from 0 to 1, as colour maps of matplotlib give them (without alpha);
        "#rrggbb"; or a name that matplotlib knows, where that is installed, such as "tab:orange".
    Returns an array of shape (..., 3). Raises Error for anything else.
    """
    encoded = _encoded(color)
    if encoded.ndim == 0 or encoded.shape[-1] not in (3, 4) or encoded.dtype.kind not in "fiu":
        raise Error(f"a colour has shape {encoded.shape}, but (..., 3) or (..., 4) numbers are expected")
    values = encoded[..., :3].astype(np.float64) / (255 if encoded.dtype == np.uint8 else 1)
    if not ((values >= 0) & (values <= 1)).all():
        raise Error("colours for screens are numbers from 0 to 1, or uint8")
    light = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    return light.astype(np.float32)


def _encoded(color: str | ArrayLike) -> NDArray[Any]:
    if not isinstance(color, str):
        return np.asarray(color)
    digits = color.removeprefix("#")
    if color.startswith("#") and len(digits) == 6:
        try:
            return np.frombuffer(bytes.fromhex(digits), np.uint8)
        except ValueError as error:
            raise Error(f"{color!r} is no colour: six hexadecimal digits are expected after #") from error
    try:
        from matplotlib.colors import to_rgb
    except ImportError as error:
        raise Error(
            f"{color!r} is a name that matplotlib may know, which is not installed; '#rrggbb' needs none"
        ) from error
    try:
        return np.array(to_rgb(color))
    except ValueError as error:
        raise Error(f"{color!r} is no colour that matplotlib knows") from error
