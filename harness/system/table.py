"""One table of a TOML file, read key by key; what is missing, ill-typed or unknown is refused with its place."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from harness.errors import InputError
from harness.system.description import Array, constant
from harness.system.magnitudes import NUMBER
from harness.system.suggest import did_you_mean


class TableReader:
    """Reads one table and remembers which keys were asked for, so that ``finish`` can refuse the others.

    what: how messages name the table (``joint 'pivot'``). line, lines: where it starts, and where its keys stand.
    """

    def __init__(
        self,
        table: Mapping[str, Any],
        what: str,
        source: Path | None = None,
        line: int | None = None,
        lines: Mapping[str, int] | None = None,
    ) -> None:
        self.table = table
        self.what = what
        self.source = source
        self.line = line
        self.lines = lines or {}
        self._asked: set[str] = set()

    def refuse(self, what: str, mend: str = "", key: str | None = None) -> NoReturn:
        """Raise InputError at this table (at the key's line if it is known)."""
        line = self.lines.get(key, self.line) if key is not None else self.line
        raise InputError(f"{self.what}: {what}", mend=mend, source=self.source, line=line)

    def has(self, key: str) -> bool:
        self._asked.add(key)
        return key in self.table

    def _get(self, key: str, mend: str) -> Any:
        if not self.has(key):
            self.refuse(f"{key!r} is missing", mend)
        return self.table[key]

    def text(self, key: str, default: str | None = None, *, mend: str = "") -> str:
        if default is not None and not self.has(key):
            return default
        value = self._get(key, mend or f'add {key} = "…"')
        if not isinstance(value, str) or not value.strip():
            self.refuse(f"{key!r} must be a text, not {value!r}", key=key)
        return value

    def flag(self, key: str, default: bool) -> bool:
        if not self.has(key):
            return default
        value = self.table[key]
        if not isinstance(value, bool):
            self.refuse(f"{key!r} must be true or false, not {value!r}", key=key)
        return value

    def count(self, key: str, default: int, *, most: int) -> int:
        if not self.has(key):
            return default
        value = self.table[key]
        if isinstance(value, bool) or not isinstance(value, int) or value < 0:
            self.refuse(f"{key!r} must be a whole number of at least 0, not {value!r}", key=key)
        if value > most:
            self.refuse(f"{key} = {value} is more than is numerically sound", f"use at most {most}", key=key)
        return value

    def number(
        self,
        key: str,
        default: float | None = None,
        *,
        positive: bool = False,
        non_negative: bool = False,
        infinite: bool = False,
        mend: str = "",
    ) -> float:
        if default is not None and not self.has(key):
            return default
        value = self._finite(key, self._get(key, mend or f"add {key} = …"), infinite)
        if positive and value <= 0.0:
            self.refuse(f"{key!r} must be positive, not {value:g}", key=key)
        if positive and value < 1.0 / NUMBER:
            self.refuse(f"{key!r} is {value:.3g}, beyond any mechanism", "check the number and its unit", key)
        if non_negative and value < 0.0:
            self.refuse(f"{key!r} must not be negative, but is {value:g}", key=key)
        return value

    def _finite(self, key: str, value: Any, infinite: bool = False) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.refuse(f"{key!r} must be a number, not {value!r}", key=key)
        number = float(value)
        if math.isfinite(number) and abs(number) > NUMBER:
            self.refuse(f"{key!r} is {number:.3g}, beyond any mechanism", "check the number and its unit", key)
        if math.isnan(number) or (math.isinf(number) and not infinite):
            self.refuse(f"{key!r} must be a finite number, not {value!r}", key=key)
        return number

    def numbers(self, key: str) -> tuple[float, ...]:
        """A list of finite numbers of any length."""
        value = self._get(key, f"add {key} = […]")
        if not isinstance(value, list):
            self.refuse(f"{key!r} must be a list of numbers, not {value!r}", key=key)
        return tuple(self._finite(key, x) for x in value)

    def vector(self, key: str, default: Iterable[float] | None = None, *, mend: str = "") -> Array:
        """Three finite numbers."""
        if default is not None and not self.has(key):
            return constant(list(default))
        value = self._get(key, mend or f"add {key} = [x, y, z]")
        if not isinstance(value, list) or len(value) != 3:
            size = f"{len(value)} value(s)" if isinstance(value, list) else repr(value)
            self.refuse(f"{key!r} must be three numbers, not {size}", f"write {key} = [x, y, z]", key=key)
        return constant([self._finite(key, x) for x in value])

    def direction(self, key: str, *, mend: str = "") -> Array:
        """A unit vector from three numbers of any length but zero."""
        vector = self.vector(key, mend=mend)
        length = float(np.linalg.norm(vector))
        if length < 1e-12:
            self.refuse(f"{key!r} has zero length", "give a direction such as [0, 1, 0]", key=key)
        # An exact unit vector is left bit for bit as it stands.
        return vector if abs(length - 1.0) < 1e-15 else constant(np.asarray(vector) / length)

    def tensor(self, key: str) -> Array:
        """Symmetric 3 x 3 tensor from 3 values (diagonal), 6 (ixx, iyy, izz, ixy, ixz, iyz) or 3 rows of 3."""
        mend = "write [ixx, iyy, izz], [ixx, iyy, izz, ixy, ixz, iyz] or three rows of three"
        value = self._get(key, mend)
        if not isinstance(value, list):
            self.refuse(f"{key!r} must be a list, not {value!r}", mend, key)
        if len(value) == 3 and all(isinstance(row, list) for row in value):
            if any(len(row) != 3 for row in value):
                self.refuse(f"{key!r} must have three rows of three", mend, key)
            tensor = np.array([[self._finite(key, x) for x in row] for row in value])
            if not np.allclose(tensor, tensor.T, rtol=1e-9, atol=1e-12 * np.abs(tensor).max()):
                self.refuse(f"{key!r} is not symmetric", "an inertia tensor is", key)
            return constant((tensor + tensor.T) / 2.0)
        if len(value) not in (3, 6):
            self.refuse(f"{key!r} has {len(value)} values", mend, key)
        xx, yy, zz, *products = [self._finite(key, x) for x in value]
        xy, xz, yz = products or (0.0, 0.0, 0.0)
        return constant([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def inner(self, key: str) -> TableReader | None:
        """The table under a key, or None."""
        if not self.has(key):
            return None
        value = self.table[key]
        if not isinstance(value, dict):
            self.refuse(f"{key!r} must be a table, as in {key} = {{ … }}, not {value!r}", key=key)
        line = self.lines.get(key, self.line)
        return TableReader(value, f"{self.what}, {key}", self.source, line, self.lines)

    def finish(self) -> None:
        """Refuse keys that nobody asked for."""
        for key in self.table:
            if key not in self._asked:
                self.refuse(f"unknown key {key!r}", did_you_mean(key, self._asked), key)


_HEADER = re.compile(r"^\s*\[\[\s*([\w.-]+)\s*\]\]")
_SUBTABLE = re.compile(r"^\s*\[\s*([\w.-]+)\s*\]")
_KEY = re.compile(r"^\s*([\w-]+)\s*=")


def locate(text: str) -> dict[str, list[tuple[int, dict[str, int]]]]:
    """Where the ``[[tables]]`` of a TOML text and their keys stand, for messages; the parser does not tell.

    Returns, by table name, (line of the header, line by key) for each; the top level goes by the name "".
    """
    keys: dict[str, int] = {}
    places: dict[str, list[tuple[int, dict[str, int]]]] = {"": [(1, keys)]}
    for number, line in enumerate(text.splitlines(), start=1):
        if header := _HEADER.match(line):
            keys = {}
            places.setdefault(header[1], []).append((number, keys))
        elif subtable := _SUBTABLE.match(line):
            keys.setdefault(subtable[1].rpartition(".")[2], number)
        elif key := _KEY.match(line):
            keys.setdefault(key[1], number)
    return places
