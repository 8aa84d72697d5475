"""Readings that change where dry friction holds the model: friction that gives way slowly, as lubricants do."""

from __future__ import annotations

from collections.abc import Iterator

from scipy.stats import chi2

from harness.diagnose.criticism.check import Asked, Check, Remainder, Test
from harness.diagnose.criticism.where_held import predicted, still, stretches, variation

WHERE_HELD = "motion where dry friction holds the model"


def _asked(left: Remainder) -> Iterator[Test]:
    """A test, if the model is held anywhere; names the plainest stretch."""
    found: list[tuple[float, int, str]] = []
    for window, steps, rows in predicted(left.study, left.fitted):
        run = left.study.problem.runs[window.run]
        for first, last in stretches(still(steps)):
            begun = run.time[window.first + first] - run.time[0]
            found.append(
                (variation(rows[:, first:last]), rows[:, first + 1 : last].size, f"{run.name} from {begun:.3g} s on")
            )
    if not found:
        return
    cost, size = sum(c for c, _, _ in found), sum(n for _, n, _ in found)
    _, _, where = max(found)
    yield Test(WHERE_HELD, cost - size, size, float(chi2.sf(cost, size)), (where,), -1, cause=True)


CHECK = Check(WHERE_HELD, _asked, asked=Asked.BESIDE_A_REMAINDER)
