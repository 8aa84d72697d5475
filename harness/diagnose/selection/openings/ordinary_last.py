"""Friction and drag together, where nothing else leads near the recordings."""

from __future__ import annotations

from harness.diagnose.selection.constants.starts import NONLINEAR_COST_RATIO
from harness.diagnose.selection.dissipation_starts import ordinary
from harness.diagnose.selection.opening import Opened, Opening


def _go(opened: Opened) -> None:
    if min(f.score for f in opened.seeds) > NONLINEAR_COST_RATIO * opened.long.samples:
        opened.seeds += ordinary(opened.long, opened.empty)
        opened.progress("friction and drag together")


OPENING = Opening(_go)
