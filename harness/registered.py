"""Things of one kind, a file each: what a package's catalogue names is found in the file of that name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from types import MappingProxyType
from typing import TypeVar

Kind = TypeVar("Kind")


def registered(package: str, names: Sequence[str], kind: type[Kind]) -> Mapping[str, Kind]:
    """The thing of a kind that each named file of a package holds, by the file's name; ``CHECK`` for a kind ``Check``.

    Raises TypeError where a file holds another thing under that name.
    """
    found = {name: getattr(import_module(f"{package}.{name}"), kind.__name__.upper()) for name in names}
    for name, one in found.items():
        if not isinstance(one, kind):
            raise TypeError(f"{package}.{name}.{kind.__name__.upper()} is no {kind.__name__}")
    return MappingProxyType(found)
