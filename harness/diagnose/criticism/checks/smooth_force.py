"""A smooth force over position and velocity, the same in every recording."""

from __future__ import annotations

from collections.abc import Iterator

from harness.diagnose.criticism.check import Check, Remainder, Test, is_no_motion
from harness.diagnose.criticism.state_forces import beyond_its_size, force_over_state, shape_names

SMOOTH = "a smooth force over the state"


def _asked(left: Remainder) -> Iterator[Test]:
    smooth = [i for i, name in enumerate(shape_names(left.at)) if not name.startswith("bump")]
    yield force_over_state(left, SMOOTH, smooth)


CHECK = Check(SMOOTH, _asked, every_joint=True, leaves=beyond_its_size, on_both_sides=is_no_motion, of_state=True)
