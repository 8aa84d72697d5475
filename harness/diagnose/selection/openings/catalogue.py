"""All openings of a search, in the order in which they are gone through; one file of this package each."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from harness.diagnose.selection.opening import Opening
from harness.registered import registered

NAMES = ("ordinary_first", "very_short_windows", "short_windows", "ordinary_last")


@cache
def openings() -> Mapping[str, Opening]:
    """Every opening by its file's name."""
    return registered(__package__, NAMES, Opening)
