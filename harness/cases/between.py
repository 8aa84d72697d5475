"""Two runs of the suite, or of the same models, held against one another: what changed between them, the gravest first."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from harness.cases.case import Row
from harness.cases.gate.robot import of_description
from harness.cases.results import Results

SCHEMA = "denoc.comparison/1"
# Kinds of change, the gravest first, and what each is in words.
KINDS = {
    "failed": "passes no more",
    "lost": "is not compared any more",
    "gone": "is not there any more",
    "loosened": "has another limit",
    "grew": "grew",
    "failing": "fails in both",
    "mended": "passes now",
    "shrank": "shrank",
    "new": "is new",
}
GRAVE = ("failed", "lost", "gone", "loosened")
# Of what is allowed: less is another processor's rounding.
SHARE = 0.1


@dataclass(frozen=True)
class Changed:
    """One row of either run that is not as it was. kind: of ``KINDS``; before, after: None where a run has no such row."""

    key: str
    kind: str
    before: Row | None
    after: Row | None

    def to_json(self) -> dict[str, Any]:
        """Plain values: figures, limits and verdicts of both, where, when and why of the later."""
        row = self.after or self.before
        assert row is not None
        sides = {
            side: None
            if one is None
            else {"difference": _number(one.difference), "allowed": _number(one.allowed), "verdict": one.verdict}
            for side, one in (("before", self.before), ("after", self.after))
        }
        return {
            "case": row.case,
            "quantity": row.quantity,
            "engines": list(row.engines),
            "unit": row.unit,
            "kind": self.kind,
            **sides,
            "first_divergence": None if row.first_divergence is None else dict(row.first_divergence),
            "why": row.note,
        }


@dataclass(frozen=True)
class Comparison:
    """changed: the gravest first. same: how many rows are as they were. versions: name to (before, after), where they differ."""

    changed: tuple[Changed, ...]
    same: int
    versions: Mapping[str, tuple[str, str]]

    @property
    def worse(self) -> bool:
        """Whether something passes no more, is compared no more, or has another limit."""
        return any(one.kind in GRAVE for one in self.changed)

    def to_json(self) -> dict[str, Any]:
        """The document ``denoc.comparison/1``."""
        return {
            "schema": SCHEMA,
            "worse": self.worse,
            "same": self.same,
            "versions": {name: list(pair) for name, pair in self.versions.items()},
            "rows": [one.to_json() for one in self.changed],
        }


def between(before: Results, after: Results) -> Comparison:
    """What is not in the second run as it was in the first."""
    old = {row.key: row for row in before.rows}
    new = {row.key: row for row in after.rows}
    changed = [
        Changed(key, kind, old.get(key), new.get(key))
        for key in (*new, *(key for key in old if key not in new))
        if (kind := _kind(old.get(key), new.get(key)))
    ]
    order = list(KINDS)
    # Numbers of a model's file that changed stand before what comes of them.
    changed.sort(key=lambda one: (order.index(one.kind), not _is_cause(one), -_size(one)))
    names = dict.fromkeys((*before.versions, *after.versions))
    versions = {
        name: (before.versions.get(name, "missing"), after.versions.get(name, "missing"))
        for name in names
        if before.versions.get(name) != after.versions.get(name)
    }
    gone = sum(one.kind == "gone" for one in changed)
    return Comparison(tuple(changed), len(new) + gone - len(changed), versions)


def _kind(before: Row | None, after: Row | None) -> str:
    """Of ``KINDS``; empty where nothing changed by more than rounding."""
    if before is None:
        return "new"
    if after is None:
        return "gone"
    if after.verdict == "fail":
        return "failing" if before.verdict == "fail" else "failed"
    if after.verdict == "skipped":
        return "" if before.verdict == "skipped" else "lost"
    if before.verdict != "pass":
        return "mended"
    if before.allowed != after.allowed or before.unit != after.unit:
        return "loosened"
    a, b = before.difference, after.difference
    if a is None or b is None or after.allowed is None or abs(b - a) <= SHARE * after.allowed:
        return ""
    return "grew" if b > a else "shrank"


def _is_cause(one: Changed) -> bool:
    row = one.after or one.before
    return row is not None and of_description(row)


def _size(one: Changed) -> float:
    """How far the later is towards its limit, for the order within a kind."""
    row = one.after or one.before
    if row is None or row.difference is None or not row.allowed or not math.isfinite(row.difference):
        return math.inf
    return row.difference / row.allowed


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)
