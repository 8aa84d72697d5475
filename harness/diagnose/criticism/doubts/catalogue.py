"""All reasons to doubt members of a set, in the order in which they are looked at; one file of this package each."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from harness.diagnose.criticism.reason import Reason
from harness.registered import registered

NAMES = (
    "side_unknown",
    "creep",
    "single_event",
    "vertical_shaking",
    "unnamed_force",
    "little_beside_remainder",
    "one_force_for_several",
    "several_filters",
)


@cache
def reasons() -> Mapping[str, Reason]:
    """Every reason to doubt by its file's name."""
    return registered(__package__, NAMES, Reason)
