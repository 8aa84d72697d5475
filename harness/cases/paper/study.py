"""What a study of the paper gives: tables, lines to draw, numbers by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from harness.cases.case import Series

Table = tuple[tuple[str, ...], Sequence[tuple[str, ...]]]
Progress = Callable[[int, int, str], None]


@dataclass(frozen=True, eq=False)
class Study:
    """tables: by name, heads and rows. series: lines by figure. numbers: by name. records: what single trials gave, where there are
    any."""

    tables: Mapping[str, Table]
    series: tuple[Series, ...] = ()
    numbers: Mapping[str, float] = field(default_factory=dict)
    records: Sequence[Mapping[str, Any]] = ()


def silent(done: int, total: int, what: str) -> None:
    """Progress that nobody watches."""
