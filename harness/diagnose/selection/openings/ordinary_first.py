"""Ordinary dissipation at every joint, before anything is searched for.

Rigs are at first too damped or not enough: where that is most of it, nothing need be looked for that leads there.
"""

from __future__ import annotations

from functools import partial

from harness.diagnose.problem.constants import FEW_EFFECTS_SHARE
from harness.diagnose.selection.effort_hold import either_way
from harness.diagnose.selection.model_error import begun_ordinary
from harness.diagnose.selection.opening import Opened, Opening
from harness.diagnose.selection.short_window_starts import begun, branching, few_suffice, ordinary_by_way_of_shorter

FEW = "whether few effects leave only noise on short windows", "what is told may stand in for few others"


def _go(opened: Opened) -> None:
    if not opened.lost:
        return
    if branching(opened.short):
        # Few effects show over few samples, where everything at once goes many ways over many.
        opened.shorter = begun(opened.short, opened.fine, opened.effort, opened.progress)
        if any(map(opened.short.only_noise, opened.shorter)):
            return
    usual = ordinary_by_way_of_shorter(opened.short, opened.fine)
    if usual is None:
        return
    # What efforts that are held for smooth ones leave would be a force that nobody has named. The nominal model is too far off to
    # tell; ordinary dissipation may not be.
    other, usual = either_way(opened.short, usual)
    if other is not opened.short:
        opened.restart(other)
    short, long = opened.short, opened.long
    few = partial(few_suffice, short, usual, opened.effort, opened.progress)
    early = begun_ordinary(
        long, usual, short.swing, opened.effort, opened.progress, opened.structure, opened.reached,
        lambda: short.predictor.deadline.within(FEW_EFFECTS_SHARE, *FEW, few, lambda: None), opened.laws,
    )  # fmt: skip
    if early is None:
        return
    if early[0].likelihood.discrepancy is not None:
        opened.answer = early
        return
    opened.seeds += [long.fit(f.hypothesis, [f.x], f) for f in early[1]]


OPENING = Opening(_go)
