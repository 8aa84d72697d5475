"""The accepted figures read from their file, and refused where they could let something through."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness.cases.gate.accepted import SCHEMA, SHARES, Accepted, Entry, digest
from harness.cases.json_file import read_json, shaped
from harness.errors import InputError

_RESTORE = "restore it from version control"


@dataclass(frozen=True)
class _Document:
    schema: str
    rows: dict[str, Entry]
    shares: dict[str, float] = field(default_factory=lambda: dict(SHARES))
    history: list[_Acceptance] = field(default_factory=list)
    robots: dict[str, dict[str, Any]] = field(default_factory=dict)
    digest: str = ""


@dataclass(frozen=True)
class _Acceptance:
    date: str
    why: str
    versions: dict[str, str]


def read_accepted(path: str | Path) -> Accepted:
    """The accepted figures of a file.

    Raises InputError if it is missing, broken, of another schema, or holds a figure that is not a finite number: a gate
    without a reference would let everything through. A file whose digest does not fit is read, and says so in
    ``edited``: the gate stays closed on it until its figures are accepted with a reason.
    """
    path = Path(path)
    document = read_json(
        path,
        missing="there are no accepted figures",
        mend="check the path; `denoc gate --accept --new --why …` starts a new file",
        restore=_RESTORE,
    )
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        found = document.get("schema") if isinstance(document, dict) else None
        raise InputError(f"schema is {repr(found)[:80]}, not {SCHEMA!r}", source=path, mend="name an accepted.json")
    held = shaped(document, _Document, source=path, mend=_RESTORE)
    if not held.rows:
        raise InputError("holds no figures", source=path, mend=_RESTORE)
    for key, entry in held.rows.items():
        _check(key, entry, path)
    for quantity, share in held.shares.items():
        if not (math.isfinite(share) and 0.0 <= share <= 1.0):
            raise InputError(f"share of {quantity[:80]} is {share:g}", source=path, mend="shares lie between 0 and 1")
    edited = ""
    if not held.digest:
        edited = "carries no digest, so that nobody would see a figure changed by hand"
    elif held.digest != digest(document):
        edited = "was changed by hand: its digest does not fit its figures, shares, versions and reasons"
    return Accepted(held.rows, held.shares, tuple(document.get("history", ())), held.robots, edited)


def _check(key: str, entry: Entry, path: Path) -> None:
    if key.count("/") < 2:
        raise InputError(f"{key[:80]!r} is no row's key", source=path, mend=_RESTORE)
    difference, allowed = entry.difference, entry.allowed
    if entry.verdict == "skipped":
        if difference is not None or allowed is not None:
            raise InputError(f"row {key[:120]!r} is skipped, and has figures", source=path, mend=_RESTORE)
        return
    if entry.verdict != "pass" or difference is None or allowed is None or not math.isfinite(difference + allowed):
        raise InputError(f"row {key[:120]!r} holds no finite accepted figure", source=path, mend="accept it again")
    # The difference was rounded to three digits, perhaps upwards.
    if not 0.0 <= difference <= 1.01 * allowed:
        raise InputError(
            f"row {key[:120]!r} accepts {difference:.3g} where {allowed:.3g} is allowed",
            source=path,
            mend=_RESTORE,
        )
