"""Inspections: JSON into dataclasses, and what one does with them."""

from __future__ import annotations

import builtins
import dataclasses
import functools
import json
import types
import typing
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from . import _inspection

if TYPE_CHECKING:
    from pandas import DataFrame

_Line = Callable[[], str] | str
_T = TypeVar("_T")


class Inspection(_inspection.Sample):
    """Every step of the computation of one sample. Its fields are those of `Sample`.

    Numbers are those of the renderer, bit for bit: `np.float32(x)` is the float32 that it had. The additions, added as float32 in
    their order, are `radiance.lanes`; in Jupyter it shows the drawing of its rays.
    """

    _told: _Line = ""
    _drawn: _Line = ""

    @property
    def text(self) -> str:
        """The report for people, as `lookfrom inspect` prints it."""
        return self._told if isinstance(self._told, str) else self._told()

    @property
    def svg(self) -> str:
        """A drawing of the rays."""
        return self._drawn if isinstance(self._drawn, str) else self._drawn()

    def ray(self, address: int) -> _inspection.Ray:
        """A ray by its address: 1 is the camera ray. Raises KeyError where the sample has no such ray."""
        for ray in self.rays:
            if ray.address == address:
                return ray
        raise KeyError(
            f"there is no ray {address}; there are {', '.join(str(ray.address) for ray in self.rays)}"
        )

    def to_dataframe(self) -> DataFrame:
        """The rays as rows of a table of pandas, by address."""
        rows = [
            {
                "address": ray.address,
                "parent": ray.parent,
                "kind": ray.kind,
                "depth": ray.depth,
                "shape": ray.met.shape if ray.met else None,
                "material": ray.met.material if ray.met else None,
                "t": ray.met.t if ray.met else None,
                "point": ray.met.point if ray.met else None,
                "throughput": ray.throughput,
                "added": ray.added.rgb,
                "nodes": ray.traversal.nodes,
                "tests": ray.traversal.tests,
            }
            for ray in self.rays
        ]
        return _table(rows, "address")

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return (
            f"Inspection(pixel={self.pixel}, sample={self.sample}, {len(self.rays)} rays, film={self.film})"
        )

    def _repr_svg_(self) -> str:
        return self.svg

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_told": self.text, "_drawn": self.svg}


class PixelInspection(_inspection.Pixel):
    """All samples of a pixel. Its fields are those of `Pixel`."""

    def to_dataframe(self) -> DataFrame:
        """The samples as rows of a table of pandas, by number."""
        return _table([dataclasses.asdict(summary) for summary in self.all], "sample")

    def __repr__(self) -> str:
        return f"PixelInspection(pixel={self.pixel}, samples={self.samples}, mean={self.mean})"


def from_json(kind: type[_T], text: str, told: _Line = "", drawn: _Line = "") -> _T:
    """The inspection of a JSON text."""
    made = _decoded(json.loads(text), kind)
    if isinstance(made, Inspection):
        object.__setattr__(made, "_told", told)
        object.__setattr__(made, "_drawn", drawn)
    assert isinstance(made, kind)
    return made


@functools.cache
def _hints(kind: type[Any]) -> dict[str, Any]:
    """The types of the keys of an object."""
    # An inspection has the keys of its base.
    told = next(base for base in kind.mro() if base.__module__ == _inspection.__name__)
    return typing.get_type_hints(told)


def _decoded(item: Any, kind: Any) -> Any:
    """A value of JSON as one of a type."""
    arguments = typing.get_args(kind)
    if item is None:
        return None
    if isinstance(kind, types.UnionType):
        return _decoded(item, next(part for part in arguments if part is not type(None)))
    match typing.get_origin(kind) or kind:
        case builtins.list:
            return [_decoded(part, arguments[0]) for part in item]
        case builtins.tuple if arguments[-1] is Ellipsis:
            return tuple(_decoded(part, arguments[0]) for part in item)
        case builtins.tuple:
            return tuple(_decoded(part, of) for part, of in zip(item, arguments, strict=True))
        case builtins.dict:
            return {key: _decoded(part, arguments[1]) for key, part in item.items()}
        case builtins.float:
            # Those that JSON does not have are texts there.
            return float(item)
        case type() as made if dataclasses.is_dataclass(made):
            return made(**{name: _decoded(item[name.rstrip("_")], of) for name, of in _hints(made).items()})
    return item


def _table(rows: list[dict[str, Any]], index: str) -> DataFrame:
    import pandas

    return pandas.DataFrame(rows).set_index(index)
