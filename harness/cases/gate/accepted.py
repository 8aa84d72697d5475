"""The accepted figures: what they are and how they are written; schema ``denoc.accepted/1``."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

SCHEMA = "denoc.accepted/1"
DEFAULT = Path("reference") / "accepted.json"

# By how much of what is allowed a figure may grow over the accepted one before the gate speaks up. Rounding differs
# between processors and libraries, so quantities that are nothing but rounding get more room than those that are not.
SHARES = {
    "default": 0.5,
    "point": 0.05,
    "period": 0.1,
    "decrement": 0.1,
    "half_swing_frequency": 0.1,
}


@dataclass(frozen=True)
class Entry:
    """The accepted figure of one row: verdict, difference and what was allowed when it was accepted."""

    verdict: str
    difference: float | None
    allowed: float | None
    unit: str


@dataclass(frozen=True)
class Accepted:
    """All accepted figures.

    rows: by ``Row.key``. shares: by quantity, the part of ``allowed`` by which a figure may grow; ``default`` for the
    others. history: newest first; each with date, why, versions, and how many rows were added, changed and removed.
    robots: what is recorded of users' models, by case. edited: what is wrong with the file's digest; empty if nothing.
    """

    rows: Mapping[str, Entry]
    shares: Mapping[str, float] = field(default_factory=lambda: dict(SHARES))
    history: tuple[Mapping[str, Any], ...] = ()
    robots: Mapping[str, Any] = field(default_factory=dict)
    edited: str = ""

    def share(self, quantity: str) -> float:
        return float(self.shares.get(quantity, self.shares.get("default", SHARES["default"])))

    def of(self, cases: Collection[str]) -> Accepted:
        """The figures of some cases alone."""
        return replace(self, rows={key: entry for key, entry in self.rows.items() if key.rsplit("/", 2)[0] in cases})

    def to_json(self) -> str:
        """The file's text, one row a line, so that a change of one figure is a change of one line."""
        written = {
            key: {"verdict": e.verdict, "difference": _digits(e.difference), "allowed": e.allowed, "unit": e.unit}
            for key, e in sorted(self.rows.items())
        }
        head: dict[str, Any] = {"schema": SCHEMA, "shares": dict(self.shares), "history": list(self.history)}
        if self.robots:
            head["robots"] = dict(sorted(self.robots.items()))
        head["digest"] = digest({**head, "rows": written})
        rows = ",\n".join(f"  {json.dumps(key)}: {json.dumps(values)}" for key, values in written.items())
        return json.dumps(head, indent=1)[:-2] + ',\n "rows": {\n' + rows + "\n }\n}\n"


def _digits(value: float | None) -> float | None:
    # Three digits are all that another processor could reproduce.
    return None if value is None else float(f"{value:.2e}")


def digest(document: Mapping[str, Any]) -> str:
    """SHA-256 over rows, shares, robots and history (with its versions and reasons) of a document.

    It notices a figure changed by hand or a merge gone wrong; it is no signature, and is not meant to be one: who can
    write the file can write a digest, but then the change stands in it with a date and a reason.
    """
    held = {name: document.get(name) for name in ("rows", "shares", "history", "robots") if document.get(name)}
    text = json.dumps(held, sort_keys=True, separators=(",", ":"))
    return "sha256:" + hashlib.sha256(text.encode()).hexdigest()
