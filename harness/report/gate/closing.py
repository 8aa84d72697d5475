"""What closes the gate, a line each: what changed, then where and when, then why; changes of a description stand first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from harness.cases.gate import Judged, Judgement
from harness.cases.gate.judge import LEFT
from harness.cases.gate.robot import of_description
from harness.errors import one_line
from harness.report import words
from harness.report.gate.places import line_in

# Rows that one thing stands in the way of (an engine that is not installed) are one line from this many on.
MANY = 4
HEADS = ("what changed", "case", "quantity", "engines", "accepted", "now", "allowed", "where and when", "why")
FIGURES = ("accepted", "now", "allowed")


@dataclass(frozen=True)
class Line:
    """One row that closes the gate, or several for one reason; each field as it is printed, in the order of ``HEADS``."""

    what: str
    case: str
    quantity: str
    engines: str
    accepted: str
    now: str
    allowed: str
    where: str
    why: str

    @property
    def cells(self) -> tuple[str, ...]:
        # Names out of somebody's results file: a line break in one would begin a line of its own, which servers read.
        return tuple(one_line(text) for text in (
            self.what, self.case, self.quantity, self.engines, self.accepted, self.now, self.allowed, self.where, self.why,
        ))  # fmt: skip

    @property
    def said(self) -> str:
        """What changed, where and when, and why, in one."""
        return one_line("; ".join(filter(None, (self.what, self.where, self.why))))


def lines(judgement: Judgement, files: Mapping[str, Path] | None = None) -> list[Line]:
    """What closes the gate: what has a figure first, and of a model the numbers that changed before what comes of them.

    Engines that left the line by the same, at one place and for one reason, are one line; so is what one thing stands in
    the way of. files: the model of each case, for its line.
    """
    failed = judgement.failed
    measured: dict[tuple[str, ...], list[Judged]] = {}
    reasons: dict[str, list[Judged]] = {}
    for judged in failed:
        if _compared(judged):
            one = line(judged, files)
            key = (one.what, one.case, one.quantity, one.now, one.allowed, one.where, one.why)
            measured.setdefault(key, []).append(judged)
        else:
            reasons.setdefault(judged.reason, []).append(judged)
    found = [_engines_together([line(judged, files) for judged in rows], rows) for rows in measured.values()]
    for rows in reasons.values():
        found += [_together(rows)] if len(rows) >= MANY else [line(judged, files) for judged in rows]
    return found


def _compared(judged: Judged) -> bool:
    return judged.row is not None and judged.row.verdict != "skipped"


def line(judged: Judged, files: Mapping[str, Path] | None = None) -> Line:
    """One row."""
    case, quantity, engines = judged.key.rsplit("/", 2)
    row = judged.row
    # What is not possible stands in the reason.
    what, where, why = judged.reason, "", ""
    if row is not None:
        where = words.divergence(row)
        why = row.note if row.verdict == "fail" else ""
    # The figures stand beside it.
    what = LEFT if what.startswith(LEFT) else what
    if why and is_description(judged):
        what, where, why = why, "", ""
    return Line(
        what,
        case,
        words.quantity(quantity),
        engines.replace("+", " · "),
        words.figure(judged.accepted),
        "missing" if row is None else words.figure(row.difference, verdict=row.verdict),
        "" if row is None or row.allowed is None else f"{row.allowed:.0e}",
        "; ".join(filter(None, (where, _file(judged, files or {})))),
        why,
    )


def is_description(judged: Judged) -> bool:
    """Whether a row says which number of a model's file is another than was recorded."""
    return judged.row is not None and of_description(judged.row)


def _file(judged: Judged, files: Mapping[str, Path]) -> str:
    """The model's file and line, where it is known: of what changed in it, not of where that shows."""
    path = files.get(judged.key.rsplit("/", 2)[0])
    if path is None or not is_description(judged):
        return ""
    at = line_in(judged, path)
    here = Path.cwd()
    shown = path.relative_to(here) if path.is_relative_to(here) else path
    return f"{shown}:{at}" if at else str(shown)


def _engines_together(lines: Sequence[Line], rows: Sequence[Judged]) -> Line:
    first = lines[0]
    if len(lines) == 1:
        return first
    most = max((judged.accepted or 0.0 for judged in rows), default=0.0)
    accepted = first.accepted if len({one.accepted for one in lines}) == 1 else f"≤ {words.figure(most)}"
    return replace(
        first, accepted=accepted, engines=together([judged.key.rsplit("/", 1)[1].split("+") for judged in rows])
    )


def together(pairs: Sequence[Sequence[str]]) -> str:
    """Pairs that share an engine with that one named once."""
    lasts, firsts = {pair[-1] for pair in pairs}, {tuple(pair[:-1]) for pair in pairs}
    if len(lasts) == 1:
        return f"{', '.join(' · '.join(pair[:-1]) for pair in pairs)} · {pairs[0][-1]}"
    if len(firsts) == 1:
        return f"{' · '.join(pairs[0][:-1])} · {', '.join(pair[-1] for pair in pairs)}"
    return ", ".join(" · ".join(pair) for pair in pairs)


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
        "",
    )


def _some(names: Sequence[str], what: str) -> str:
    return ", ".join(names) if len(names) <= 2 else f"{len(names)} {what}: {names[0]}, {names[1]} …"
