"""A force that acts once in a recording, or once in every one: a blow."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.stats import chi2

from harness.diagnose.criticism.check import Check, Remainder, Test
from harness.diagnose.criticism.constants import SINGLE_FORCE_PERIODS
from harness.diagnose.criticism.gains import jointly

ONCE = "a force that acts once"


def _asked(left: Remainder) -> Iterator[Test]:
    """Largest gain by one pulse of force anywhere, all places counted in its chance."""
    own, space, joint = left.at.probe, left.space, left.at.joint
    best, count, where = 0.0, 0, ""
    chosen = [np.zeros(len(q)) for q in space.states]
    width = SINGLE_FORCE_PERIODS * left.period
    for window, found in own.motions.items():
        centres = np.arange(0.5 * width, found.time[-1], 0.5 * width)
        if len(centres) == 0:
            continue
        histories = np.exp(-(((found.time[None, :] - centres[:, None]) / (0.4 * width)) ** 2))
        place = own.fitted.windows.index(window)
        pulses = own.pulses(joint, window, histories)
        gains = space.measure([pulses], only=place).gains()
        count += len(centres)
        top = int(np.argmax(gains))
        chosen[place] = pulses[top]
        if gains[top] > best:
            best = float(gains[top])
            run = own.predictor.runs[window.run]
            where = f"{run.name} at {centres[top] + run.time[window.first]:.2f} s"
    chance = min(1.0, count * float(chi2.sf(best / left.noise, 1)))
    every = (jointly(space, chosen), len(chosen))
    yield Test(f"{ONCE} at {joint}", best, 1, chance, (joint, where), 1, every)


CHECK = Check(ONCE, _asked, every_joint=True)
