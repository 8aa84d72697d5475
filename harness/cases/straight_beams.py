"""Flexible links held straight: what is left of the flexible recursions is the rigid mechanism."""

from functools import partial

from harness.cases.beams import alternating_chain, two_strips
from harness.cases.case import Case
from harness.cases.user_beams import straight_checks

_CASES = (
    ("straight_two_links", "Two flexible links held straight", partial(two_strips, 3)),
    ("straight_alternating", "Six links, rigid and flexible in turn, held straight", partial(alternating_chain, 6, 2)),
)

CASES = tuple(
    Case(
        name=name,
        title=title,
        source="the integrals of a straight beam are those of a slender rod: engines of rigid bodies",
        system=build,
        checks=straight_checks(build()),
        group="flexible",
        engines=("denoc", "pinocchio", "mujoco"),
    )
    for name, title, build in _CASES
)
