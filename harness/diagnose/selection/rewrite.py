"""What a way to rewrite a set of effects is: other sets near to one, fitted, which a search by growing does not come by.

A way is a file of ``rewrites/`` that says ``REWRITE = Rewrite(what, fits, …)``, and its name stands in ``rewrites/catalogue.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.study import Study


class Turn(Enum):
    """When a way to rewrite a set has its turn."""

    KIN = "before anything is added to the best set"
    WIDER = "while sets grow, where the best one leaves more than noise"
    STRAIGHTER = "while sets grow, where nominal quantities are bent"
    POLISHING = "where growing makes nothing better"
    PRUNING = "where members and generality must pay for themselves"
    FEWER = "where something better was exchanged"
    IN_PLACE = "for what else a member that is to be told could be"
    LAST = "before the best set is told"


@dataclass(frozen=True)
class Room:
    """How far a way may go: most_fits: of the study, beyond which nothing further is fitted. count: fits at most, where it has many
    to choose from. quick: only what is quick to fit. member: the one to be exchanged, for ways that are asked of every member.
    """

    most_fits: int = 0
    count: int = 0
    quick: bool = False
    member: int = -1


@dataclass(frozen=True, eq=False)
class Rewrite:
    """One way to rewrite a set. what: of the set, in words. fits: the sets that it leads to. turns: when it is asked.

    every_member: whether it is asked of every member by itself.
    """

    what: str
    fits: Callable[[Study, Fit, Room], list[Fit]]
    turns: tuple[Turn, ...]
    every_member: bool = False
