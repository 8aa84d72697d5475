"""Figures of a run made the accepted ones, with a reason."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from harness.cases.case import Row
from harness.cases.gate.accepted import SHARES, Accepted, Entry
from harness.cases.results import Results
from harness.errors import InputError


@dataclass(frozen=True)
class Change:
    """What an acceptance does to the file; each a tuple of row keys.

    kept: accepted rows that the run did not hold, and that stay as they were. loosened: rows whose limit grew.
    """

    accepted: Accepted
    added: tuple[str, ...]
    changed: tuple[str, ...]
    removed: tuple[str, ...]
    kept: tuple[str, ...]
    loosened: tuple[str, ...]


def accept(
    results: Results,
    before: Accepted | None,
    why: str,
    *,
    remove: Sequence[str] = (),
    robots: Mapping[str, Any] | None = None,
) -> Change:
    """The figures of a run as the accepted ones, with the reason.

    A run accepts what it holds and nothing else: rows that it lacks stay, so that a run of a part of the suite cannot
    take the rest out of the file. remove: cases, ``case/quantity`` or whole keys (``*`` stands for anything) to be let go.
    robots: what is recorded of users' models, by case. Raises InputError if a row fails (that is no figure to accept),
    passes with a figure that cannot pass, is skipped though it was compared before, or stands there twice; if ``remove``
    names nothing, or what the run still holds; if the file was changed by hand and has rows that the run lacks, for nobody
    looked at these; and if no reason is given.
    """
    if not why.strip():
        raise InputError("accepting needs a reason", mend='add --why "what changed and why the new figures are right"')
    _check(results)
    rows = {row.key: _entry(row) for row in results.rows}
    old = dict(before.rows) if before is not None else {}
    gone = _named(remove, old)
    for row in results.rows:
        if row.verdict == "skipped" and row.key in old and old[row.key].verdict == "pass" and row.key not in gone:
            raise InputError(
                f"row {row.key} was compared when it was accepted, and is skipped now: {row.note}",
                mend=f"install what is missing, or let it go with --remove '{row.key}'",
            )
        if row.verdict == "pass" and row.key in gone:
            raise InputError(
                f"--remove names {row.key}, which this run holds",
                mend="leave it out, or take the check out of its case",
            )
    # A row that only said why nothing was compared is no loss once these engines were compared on its case.
    idle = {key for key, e in old.items() if e.verdict == "skipped" and _compared_now(key, results)}
    kept = {key: e for key, e in old.items() if key not in rows and key not in gone and key not in idle}
    if before is not None and before.edited and kept:
        raise InputError(
            f"the reference {before.edited}; this run lacks {len(kept)} of its rows, the first is {min(kept)}",
            mend="restore the file, or accept a run that has all its rows, so that none is taken as it was edited",
        )
    removed = sorted(old.keys() - rows.keys() - kept.keys())
    added, common = sorted(rows.keys() - old.keys()), sorted(rows.keys() & old.keys())
    changed = [key for key in common if rows[key] != old[key]]
    loosened = [key for key in common if _looser(rows[key], old[key])]
    entry: dict[str, Any] = {
        "date": results.created[:10],
        "why": " ".join(why.split()),
        "versions": dict(results.versions),
        "added": len(added),
        "changed": len(changed),
        "removed": len(removed),
    }
    if loosened:
        entry["loosened"] = len(loosened)
    if kept:
        entry["kept"] = len(kept)
    if before is not None and before.edited:
        entry["edited"] = before.edited
    history = (entry, *(before.history if before is not None else ()))
    recorded = dict(before.robots) if before is not None else {}
    cases = {key.rsplit("/", 2)[0] for key in (*rows, *kept)}
    recorded = {name: held for name, held in {**recorded, **(robots or {})}.items() if name in cases}
    shares = dict(before.shares if before is not None else SHARES)
    figures = Accepted({**kept, **rows}, shares, history, recorded)
    return Change(figures, *map(tuple, (added, changed, removed, sorted(kept), loosened)))


def _compared_now(key: str, results: Results) -> bool:
    """Whether a run compares the engines of an accepted row on its case."""
    case, _, engines = key.rsplit("/", 2)
    named = set(engines.split("+"))
    return any(row.case == case and row.verdict != "skipped" and named <= set(row.engines) for row in results.rows)


def _entry(row: Row) -> Entry:
    """A row as it is kept; what was not possible holds to no figure, though it may tell one."""
    if row.verdict == "skipped":
        return Entry(row.verdict, None, None, row.unit)
    return Entry(row.verdict, row.difference, row.allowed, row.unit)


def _check(results: Results) -> None:
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
    twice = [key for key, count in Counter(row.key for row in results.rows).items() if count > 1]
    if twice:
        raise InputError(f"two rows are named {twice[0]}", mend="give the cases' quantities names of their own")


def _within(difference: float | None, allowed: float | None) -> bool:
    # False for NaN and infinities as well.
    return difference is not None and allowed is not None and 0.0 <= difference <= allowed < math.inf


def _looser(now: Entry, then: Entry) -> bool:
    return now.allowed is not None and then.allowed is not None and now.allowed > then.allowed * (1.0 + 1e-9)


def _named(patterns: Sequence[str], old: Mapping[str, Entry]) -> set[str]:
    """Keys of the accepted rows that the patterns name."""
    found: set[str] = set()
    for pattern in patterns:
        # A key ends in quantity and engines; a case's name may itself contain slashes.
        hits = {
            key
            for key in old
            if any(fnmatchcase(name, pattern) for name in (key, key.rsplit("/", 1)[0], key.rsplit("/", 2)[0]))
        }
        if not hits:
            raise InputError(
                f"--remove {pattern!r} names no accepted row", mend="name a case, case/quantity or a row's whole key"
            )
        found |= hits
    return found
