"""What a benchmark says: ours and a peer's cost of the same work, measured side by side in one run."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from harness.compare.bench.measure import Timing

SCHEMA = "denoc.bench/1"


@dataclass(frozen=True)
class Row:
    """One comparison of cost.

    what: the work. n: coordinates of the mechanism, None where that says nothing. peer: whom with.
    ours, theirs: medians in ``unit`` (``s``, ``MB``, or ``1`` for an exponent); None if not measured.
    ours_spread, theirs_spread: quartiles (25 %, 75 %). case: the mechanism. note: what else a reader should know; the
    reason in a skipped row. wanted: the ratio aimed at, None if there is none.
    """

    what: str
    n: int | None
    peer: str
    ours: float | None
    theirs: float | None
    unit: str = "s"
    ours_spread: tuple[float, float] | None = None
    theirs_spread: tuple[float, float] | None = None
    case: str = ""
    note: str = ""
    wanted: float | None = None

    @classmethod
    def timed(
        cls, what: str, n: int | None, peer: str, ours: Timing, theirs: Timing, *, case: str = "", note: str = "",
        wanted: float | None = None,
    ) -> Row:  # fmt: skip
        """The row of two timings: their medians [s], and quartiles as spreads."""
        return cls(
            what, n, peer, ours.median, theirs.median, ours_spread=ours.spread, theirs_spread=theirs.spread,
            case=case, note=note, wanted=wanted,
        )  # fmt: skip

    @property
    def skipped(self) -> bool:
        return self.ours is None

    @property
    def ratio(self) -> float | None:
        """theirs / ours, above 1 we are cheaper; None if either is missing."""
        if self.ours is None or self.theirs is None or self.ours <= 0.0:
            return None
        return self.theirs / self.ours

    @property
    def met(self) -> bool | None:
        """Whether the ratio aimed at is reached; None if there is none or nothing was measured."""
        ratio = self.ratio
        return None if self.wanted is None or ratio is None else ratio >= self.wanted

    def as_dict(self) -> dict[str, Any]:
        """The row for a file."""
        return {
            "what": self.what,
            "n": self.n,
            "peer": self.peer,
            "ours": self.ours,
            "theirs": self.theirs,
            "ratio": self.ratio,
            "unit": self.unit,
            "ours_spread": list(self.ours_spread) if self.ours_spread else None,
            "theirs_spread": list(self.theirs_spread) if self.theirs_spread else None,
            "case": self.case,
            "note": self.note,
            "wanted": self.wanted,
            "met": self.met,
        }


def skipped(what: str, n: int | None, peer: str, reason: str, *, case: str = "", wanted: float | None = None) -> Row:
    """A row for what could not be measured, with the reason."""
    return Row(what, n, peer, None, None, note=reason, case=case, wanted=wanted)


def document(rows: Iterable[Row], machine: dict[str, Any]) -> dict[str, Any]:
    """All rows as a JSON document of schema ``denoc.bench/1``."""
    return {"schema": SCHEMA, "machine": machine, "rows": [row.as_dict() for row in rows]}
