"""All ways to rewrite a set of effects, in the order in which they are asked; one file of this package each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.study import Study
from harness.registered import registered

NAMES = (
    "relatives",
    "standing_in",
    "general_law",
    "special_case",
    "alternatives",
    "pairs",
    "second_relatives",
    "shared_members",
    "emptied_member",
    "bent_tolerance",
    "falling_friction",
)


@cache
def rewrites() -> Mapping[str, Rewrite]:
    """Every way to rewrite a set by its file's name."""
    return registered(__package__, NAMES, Rewrite)


def rewritten(study: Study, best: Fit, turn: Turn, room: Room) -> Iterator[tuple[Rewrite, list[Fit]]]:
    """The ways that have their turn and what each makes of a set, one after another as they are asked for.

    Those that are asked of every member are asked of ``room.member`` alone if that is one.
    """
    for way in rewrites().values():
        if turn not in way.turns:
            continue
        every = range(len(best.hypothesis.members)) if way.every_member and room.member < 0 else [room.member]
        for k in every:
            yield way, way.fits(study, best, replace(room, member=k))
