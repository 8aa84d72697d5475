"""What a reason to doubt is: why members of a set may only stand in for something that nobody has named.

A reason is a file of ``doubts/`` that says ``REASON = Reason(what, holds, …)``, and its name stands in ``doubts/catalogue.py``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from harness.diagnose.criticism.alternatives import missing
from harness.diagnose.criticism.remainder import Remains
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.outcome import Outcome
from harness.effects.effect import Effect


@dataclass(frozen=True, eq=False)
class Suspect:
    """Members of a set that are doubted, one or several together.

    smaller: the best fit without them; remains: what ``best`` leaves.
    """

    outcome: Outcome
    best: Fit
    places: tuple[int, ...]
    smaller: Fit
    remains: Remains

    @property
    def effects(self) -> list[Effect]:
        """Those of the members."""
        return [self.best.hypothesis.members[k].effect for k in self.places]

    @property
    def missing(self) -> list[Effect]:
        """Those that the best fit without the members does without."""
        return missing(self.best, self.smaller)


def suspect(outcome: Outcome, best: Fit, places: Sequence[int], remains: Remains) -> Suspect:
    """Members of a set to be doubted."""
    smaller = best
    for key in [best.hypothesis.keys[k] for k in places]:
        if key in smaller.hypothesis.keys:
            smaller = outcome.study.below(smaller, smaller.hypothesis.keys.index(key))
    return Suspect(outcome, best, tuple(places), smaller, remains)


@dataclass(frozen=True, eq=False)
class Reason:
    """One reason to doubt. what: of the members, in words; holds: whether it is one.

    together: whether it is a reason to doubt several at once, and not one member by itself.
    """

    what: str
    holds: Callable[[Suspect], bool]
    together: bool = False
