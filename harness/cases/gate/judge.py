"""A run held against the accepted figures."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from harness.cases.case import NATIVE, Row
from harness.cases.gate.accepted import Accepted, Entry
from harness.cases.results import Results

# How the commonest reason begins: a difference beyond its limit.
LEFT = "left the line"


@dataclass(frozen=True)
class Judged:
    """One row of the run, or of the reference where the run has none.

    accepted: accepted difference. change: difference minus accepted. reason: why the gate closes; empty if it does not.
    """

    key: str
    row: Row | None
    accepted: float | None = None
    change: float | None = None
    reason: str = ""

    @property
    def ok(self) -> bool:
        return not self.reason


@dataclass(frozen=True)
class Judgement:
    """Every row's judgement; versions_changed: name to (accepted with, run with); reference: what is wrong with the file.

    not_asked: accepted rows that were not held, for they are of engines that were not asked for: how many by engine.
    """

    rows: tuple[Judged, ...]
    versions_changed: Mapping[str, tuple[str, str]]
    reference: str = ""
    not_asked: Mapping[str, int] = field(default_factory=dict)

    @property
    def ok(self) -> bool:
        return bool(self.rows) and not self.reference and all(row.ok for row in self.rows)

    def not_held(self) -> str:
        """How many accepted rows were not held, in a sentence; empty if all were."""
        count = sum(self.not_asked.values())
        if not count:
            return ""
        named = ", ".join(f"{name} ({of})" for name, of in sorted(self.not_asked.items()))
        rows, were = ("rows", "were") if count > 1 else ("row", "was")
        return f"{count} accepted {rows} {were} not held: of engines that --engine leaves out, {named}."

    @property
    def failed(self) -> tuple[Judged, ...]:
        return tuple(row for row in self.rows if not row.ok)


def judge(results: Results, accepted: Accepted, *, left_out: Collection[str] = ()) -> Judgement:
    """Hold a run against the accepted figures; left_out: engines that the run was told to do without.

    Accepted rows that are of these are counted, and not held; one that the run has all the same is held as any other.

    A row closes the gate if it fails; if it is not finite; if it was never accepted, or accepted and now missing; if it
    passes only because its limit was loosened; if its unit changed; and if it grew by more than its quantity's share of
    what is allowed. Exact digits are not compared: they differ between processors. Accepted figures that were changed by
    hand close it altogether.
    """
    twice = [key for key, count in Counter(row.key for row in results.rows).items() if count > 1]
    judged = [_judge(row, accepted.rows.get(row.key), accepted, row.key in twice) for row in results.rows]
    seen = {row.key for row in results.rows}
    not_asked: Counter[str] = Counter()
    for key, entry in accepted.rows.items():
        if key in seen:
            continue
        if without := [name for name in key.rsplit("/", 1)[1].split("+") if name in left_out]:
            not_asked[without[0]] += 1
            continue
        judged.append(Judged(key, None, entry.difference, reason=_missing(key, results)))
    before = accepted.history[0].get("versions", {}) if accepted.history else {}
    changed = {
        name: (str(version), str(results.versions.get(name, "missing")))
        for name, version in before.items()
        if results.versions.get(name) != version
    }
    if left_out:
        # Nobody asked for what these are of.
        changed = {name: pair for name, pair in changed.items() if name not in left_out}
    return Judgement(tuple(judged), changed, accepted.edited, dict(not_asked))


def _judge(row: Row, entry: Entry | None, accepted: Accepted, twice: bool) -> Judged:
    if twice:
        return Judged(row.key, row, reason="two rows have this name, so that one would hide behind the other")
    if entry is None:
        reason = {
            "fail": "failed, and was never accepted",
            "skipped": f"new, and not possible here: {row.note}",
        }.get(row.verdict, "new: not among the accepted figures")
        return Judged(row.key, row, reason=reason)
    known = entry.difference
    if row.verdict == "skipped":
        if entry.verdict == "skipped":
            return Judged(row.key, row)
        return Judged(row.key, row, known, reason=f"not possible here: {row.note}")
    if row.difference is None or not math.isfinite(row.difference):
        return Judged(row.key, row, known, reason="the difference is not a finite number")
    if row.difference < 0.0 or row.allowed is None or not 0.0 <= row.allowed < math.inf:
        return Judged(row.key, row, known, reason=f"no check gives {row.difference:.2e} where {row.allowed} is allowed")
    change = None if known is None else row.difference - known
    reason = ""
    if row.verdict != "pass" or not row.difference <= row.allowed:
        reason = f"{LEFT}: {row.difference:.2e} where {row.allowed:.0e} is allowed"
    elif entry.verdict != "pass" or entry.allowed is None or known is None:
        reason = "was skipped when the figures were accepted"
    elif row.unit != entry.unit:
        reason = f"is in {row.unit}, and was accepted in {entry.unit}"
    elif row.allowed > entry.allowed * (1.0 + 1e-9) and row.difference > entry.allowed:
        reason = f"passes only because its limit was loosened from {entry.allowed:.1e} to {row.allowed:.1e}"
    else:
        room = accepted.share(row.quantity) * entry.allowed
        if row.difference > known + room:
            reason = f"grew from {known:.2e} to {row.difference:.2e}, by more than {room:.1e}"
    return Judged(row.key, row, known, change, reason)


def _missing(key: str, results: Results) -> str:
    """Why the run lacks an accepted row: a row that was not possible says so for the rows that it stands for."""
    case, quantity, engines = key.rsplit("/", 2)
    of_case = [row for row in results.rows if row.case == case]
    if not of_case:
        return f"missing: the case {case} did not run"
    for row in of_case:
        # Of the whole case, or of this quantity; of the native engine alone it is of all engines.
        lacking = set(row.engines) - {NATIVE}
        if row.verdict == "skipped" and row.quantity in ("all", quantity) and lacking <= set(engines.split("+")):
            return f"not possible here: {row.note}"
    return f"missing: the run has no {quantity} between {' and '.join(engines.split('+'))} any more"
