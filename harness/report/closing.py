"""What closes the gate, a line each: what changed, then where and when, then why; figures that left their line stand first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from harness.cases.gate import Judged, Judgement
from harness.report import words

# Rows that one thing stands in the way of (an engine that is not installed) are one line from this many on.
MANY = 4
HEADS = ("what changed", "case", "quantity", "engines", "accepted", "now", "where and when", "why")


@dataclass(frozen=True)
class Line:
    """One row that closes the gate, or several for one reason; each field as it is printed, in the order of ``HEADS``."""

    what: str
    case: str
    quantity: str
    engines: str
    accepted: str
    now: str
    where: str
    why: str

    @property
    def cells(self) -> tuple[str, ...]:
        return (self.what, self.case, self.quantity, self.engines, self.accepted, self.now, self.where, self.why)

    @property
    def said(self) -> str:
        """What changed, where and when, and why, in one."""
        return "; ".join(filter(None, (self.what, self.where, self.why)))


def lines(judgement: Judgement) -> list[Line]:
    """Every row that closes the gate, those that have a figure first."""
    failed = judgement.failed
    measured = [judged for judged in failed if _compared(judged)]
    reasons: dict[str, list[Judged]] = {}
    for judged in failed:
        if not _compared(judged):
            reasons.setdefault(judged.reason, []).append(judged)
    found = [line(judged) for judged in measured]
    for rows in reasons.values():
        found += [_together(rows)] if len(rows) >= MANY else [line(judged) for judged in rows]
    return found


def _compared(judged: Judged) -> bool:
    return judged.row is not None and judged.row.verdict != "skipped"


def line(judged: Judged) -> Line:
    """One row."""
    case, quantity, engines = judged.key.rsplit("/", 2)
    row = judged.row
    return Line(
        judged.reason,
        case,
        words.quantity(quantity),
        engines.replace("+", " · "),
        words.figure(judged.accepted),
        _now(judged),
        "" if row is None else words.divergence(row),
        # What is not possible stands in the reason.
        row.note if row is not None and row.verdict == "fail" else "",
    )


def _now(judged: Judged) -> str:
    return "missing" if judged.row is None else words.figure(judged.row.difference, verdict=judged.row.verdict)


def _together(rows: Sequence[Judged]) -> Line:
    keys = [judged.key.rsplit("/", 2) for judged in rows]
    cases, quantities = (list(dict.fromkeys(key[k] for key in keys)) for k in (0, 1))
    pairs = {key[2] for key in keys}
    return Line(
        rows[0].reason,
        _some(cases, "cases"),
        _some([words.quantity(name) for name in quantities], "quantities"),
        pairs.pop().replace("+", " · ") if len(pairs) == 1 else f"{len(pairs)} pairs",
        "",
        f"{len(rows)} rows",
        "",
        "",
    )


def _some(names: Sequence[str], what: str) -> str:
    return ", ".join(names) if len(names) <= 2 else f"{len(names)} {what}: {names[0]}, {names[1]} …"
