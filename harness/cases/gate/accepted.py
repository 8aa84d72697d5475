"""The accepted figures: what they are, read and written; schema ``denoc.accepted/1``."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness.cases.results import Results
from harness.errors import InputError

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
    """

    rows: Mapping[str, Entry]
    shares: Mapping[str, float] = field(default_factory=lambda: dict(SHARES))
    history: tuple[Mapping[str, Any], ...] = ()

    def share(self, quantity: str) -> float:
        return float(self.shares.get(quantity, self.shares.get("default", SHARES["default"])))

    def to_json(self) -> str:
        """The file's text, one row a line, so that a change of one figure is a change of one line."""
        rows = ",\n".join(
            f"  {json.dumps(key)}: "
            + json.dumps(
                {"verdict": e.verdict, "difference": _digits(e.difference), "allowed": e.allowed, "unit": e.unit}
            )
            for key, e in sorted(self.rows.items())
        )
        head = json.dumps({"schema": SCHEMA, "shares": dict(self.shares), "history": list(self.history)}, indent=1)
        return head[:-2] + ',\n "rows": {\n' + rows + "\n }\n}\n"


def _digits(value: float | None) -> float | None:
    # Three digits are all that another processor could reproduce.
    return None if value is None else float(f"{value:.2e}")


def read_accepted(path: str | Path) -> Accepted:
    """The accepted figures of a file.

    Raises InputError if it is missing, broken, of another schema, or holds a figure that is not a finite number: a gate
    without a reference would let everything through.
    """
    path = Path(path)
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(
            "there are no accepted figures",
            source=path,
            mend="check the path; `denoc gate --accept --new --why …` starts a new file",
        ) from None
    except OSError as error:
        raise InputError(
            f"cannot be read: {error.strerror}", source=path, mend="name the file accepted.json"
        ) from error
    except UnicodeDecodeError as error:
        raise InputError("is not a text file", source=path, mend="restore it from version control") from error
    except json.JSONDecodeError as error:
        raise InputError(
            f"is not JSON: {error.msg}", source=path, line=error.lineno, mend="restore it from version control"
        ) from error
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        found = document.get("schema") if isinstance(document, dict) else None
        raise InputError(f"schema is {found!r}, not {SCHEMA!r}", source=path, mend="name an accepted.json")
    try:
        rows = {key: _entry(key, values, path) for key, values in document["rows"].items()}
        shares = {str(k): float(v) for k, v in document.get("shares", SHARES).items()}
        history = tuple(document.get("history", ()))
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"is incomplete: {error}", source=path, mend="restore it from version control") from error
    if not rows:
        raise InputError("holds no figures", source=path, mend="restore it from version control")
    for quantity, share in shares.items():
        if not (math.isfinite(share) and 0.0 <= share <= 1.0):
            raise InputError(f"share of {quantity} is {share:g}", source=path, mend="shares lie between 0 and 1")
    return Accepted(rows, shares, history)


def _entry(key: str, values: Mapping[str, Any], path: Path) -> Entry:
    entry = Entry(values["verdict"], values["difference"], values["allowed"], values["unit"])
    numbers = (entry.difference, entry.allowed)
    if entry.verdict == "skipped":
        return entry
    if entry.verdict != "pass" or not all(isinstance(x, int | float) and math.isfinite(x) for x in numbers):
        raise InputError(f"row {key!r} holds no finite accepted figure", source=path, mend="accept it again")
    # The difference was rounded to three digits, perhaps upwards.
    if not 0.0 <= values["difference"] <= 1.01 * values["allowed"]:
        raise InputError(
            f"row {key!r} accepts {entry.difference:.3g} where {entry.allowed:.3g} is allowed",
            source=path,
            mend="restore it from version control",
        )
    return entry


def _within(difference: float | None, allowed: float | None) -> bool:
    # False for NaN and infinities as well.
    return difference is not None and allowed is not None and 0.0 <= difference <= allowed < math.inf


def accept(results: Results, before: Accepted | None, why: str) -> Accepted:
    """The figures of a run as the new accepted ones, with the reason.

    Raises InputError if a row fails (that is no figure to accept), passes with a figure that cannot pass, or stands
    there twice, or if no reason is given.
    """
    if not why.strip():
        raise InputError("accepting needs a reason", mend='add --why "what changed and why the new figures are right"')
    if results.failed:
        row = results.failed[0]
        raise InputError(
            f"{len(results.failed)} rows fail, the first is {row.key}",
            mend="only what is within its allowed difference can be accepted; mend the cause, or the case with a reason",
        )
    if not any(row.verdict == "pass" for row in results.rows):
        raise InputError("nothing was compared", mend="install the engines: denoc doctor")
    for row in results.rows:
        if row.verdict == "pass" and not _within(row.difference, row.allowed):
            raise InputError(
                f"row {row.key} passes with a difference of {row.difference} where {row.allowed} is allowed",
                mend="these results were changed by hand; run the suite again",
            )
    rows = {row.key: Entry(row.verdict, row.difference, row.allowed, row.unit) for row in results.rows}
    if len(rows) < len(results.rows):
        twice = next(key for key, count in Counter(row.key for row in results.rows).items() if count > 1)
        raise InputError(f"two rows are named {twice}", mend="give the cases' quantities names of their own")
    old = before.rows if before is not None else {}
    entry = {
        "date": results.created[:10],
        "why": " ".join(why.split()),
        "versions": dict(results.versions),
        "added": len(rows.keys() - old.keys()),
        "changed": sum(rows[key] != old[key] for key in rows.keys() & old.keys()),
        "removed": len(old.keys() - rows.keys()),
    }
    history = (entry, *(before.history if before is not None else ()))
    return Accepted(rows, dict(before.shares if before is not None else SHARES), history)
