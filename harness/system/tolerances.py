"""Tolerances of single quantities, where they are known better or worse than the others: ``tolerance = { armature = 0.2 }``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from harness.system.description import System
from harness.system.suggest import did_you_mean
from harness.system.table import TableReader

OF_JOINTS = ("armature", "damping", "stiffness")
OF_LINKS = ("mass", "length", "inertia")
OF_BEAMS = ("mass", "length", "stiffness", "payload")


def read_tolerances(table: TableReader, kinds: Sequence[str]) -> dict[str, float]:
    """Relative 1σ by kind of quantity, of a joint's or a link's table; none where it states none."""
    inner = table.inner("tolerance")
    if inner is None:
        return {}
    found = {}
    for kind in inner.table:
        if kind not in kinds:
            inner.refuse(f"there is no tolerance of {kind!r} here", did_you_mean(kind, kinds))
        value = inner.number(kind, non_negative=True)
        if not 0.0 < value < 1.0:
            inner.refuse(f"tolerance {value:g} of {kind!r} is not a relative 1σ between 0 and 1", "0.2 is a fifth")
        found[kind] = value
    inner.finish()
    return found


def own_tolerances(system: System, kinds: Sequence[str], name: str) -> dict[str, Any]:
    """The same as a table has it, to be written."""
    own = {kind: system.tolerances[f"{kind}@{name}"] for kind in kinds if f"{kind}@{name}" in system.tolerances}
    return {"tolerance": own} if own else {}
