"""What a conclusion has come to when its time is up, and what is then left."""

from __future__ import annotations

from dataclasses import dataclass

from harness.diagnose.criticism.remainder import Remains
from harness.diagnose.estimation.least_squares import Fit

UNSEARCHED, UNJUDGED, UNCRITICISED = "search", "judgement", "criticism"
# By what the time was up for: what was not tried, and what that may change.
LEFT = {
    "rivals": ("all that could stand in the place of what was found", "another effect may be likelier, or as likely"),
    UNJUDGED: ("the judgement on data held out", "what was found may not hold up there, so that nothing is claimed"),
    UNCRITICISED: (
        "all tests of what is left, and of whether something that nobody has named could have done the work of what was found",
        "what was found may only stand in for something else, and more may be missing",
    ),
    "errors": ("errors on data held out", "those that are told are of a fit to all recordings"),
    "remains": ("all tests of what is left", "what is left may have a shape that would be told"),
    "ordinary": ("ordinary laws at every joint, by their free runs", "they may foretell more than what is told"),
    "weighed": ("the evidence of all sets that were fitted", "an effect may be more or less probable than it is told"),
    "told": (
        "what else could stand in the place of each effect claimed",
        "more effects may be as likely as those told",
    ),
}


@dataclass(eq=False)
class Reached:
    """How far a conclusion has come.

    wanted: the best set. settled: the one that stands on data held out. doubted: keys of what was left out since. remains: what the
    set leaves; incomplete: whether that is more than noise, or something is doubted. criticised: whether nothing in it is doubtful.
    by_free_runs: see ``Conclusion``.
    """

    wanted: Fit
    settled: Fit | None = None
    doubted: tuple[str, ...] = ()
    remains: Remains | None = None
    incomplete: bool = False
    criticised: bool = False
    by_free_runs: bool = False
