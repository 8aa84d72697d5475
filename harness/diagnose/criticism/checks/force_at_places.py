"""A force over position and velocity that may be another at each of several places of a joint's range."""

from __future__ import annotations

from collections.abc import Iterator

from harness.diagnose.criticism.check import Check, Remainder, Test, is_no_motion
from harness.diagnose.criticism.state_forces import beyond_its_size, force_over_state, shape_names

PLACES = "a force at certain places"


def _asked(left: Remainder) -> Iterator[Test]:
    yield force_over_state(left, PLACES, range(len(shape_names(left.at))))


CHECK = Check(PLACES, _asked, every_joint=True, leaves=beyond_its_size, on_both_sides=is_no_motion, of_state=True)
