"""A support that moves up and down: gravity that comes and goes with time at one frequency."""

from __future__ import annotations

from collections.abc import Iterator

from harness.diagnose.criticism.check import Asked, Check, Remainder, Test
from harness.diagnose.criticism.shaken_support import UP_AND_DOWN, shaken_up_and_down
from harness.diagnose.estimation.linear_response import responsive
from harness.diagnose.selection.study import Study


def _asked(left: Remainder) -> Iterator[Test]:
    test = shaken_up_and_down(left.study, left.fitted)
    if test is not None:
        yield test


def _responsive(study: Study) -> bool:
    """It has a frequency to be looked for, and is quick where channels answer linearly."""
    return responsive(study.predictor)


CHECK = Check(UP_AND_DOWN, _asked, asked=Asked.BESIDE_A_REMAINDER, quick=_responsive)
