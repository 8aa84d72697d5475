"""All ways to begin a fit with one more effect, in the order in which they are tried; one file of this package each."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from harness.diagnose.selection.beginning import Beginning
from harness.registered import registered

NAMES = ("promised", "calmed", "foretold", "alongside")


@cache
def beginnings() -> Mapping[str, Beginning]:
    """Every way to begin by its file's name."""
    return registered(__package__, NAMES, Beginning)
