"""A force at one place of a joint's range (attraction, push, drag, friction there), or on one side of it only."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.criticism.check import Check, Remainder, Test
from harness.diagnose.criticism.constants import (
    LOCAL_FORCE_WIDTHS,
    ONE_SIDED_FORCE_ANGLES,
    STATE_CUT,
    TURNING_STEEPNESS,
)

Array = NDArray[np.float64]

LOCAL = "a force at one place or one side"


def _asked(left: Remainder) -> Iterator[Test]:
    """Largest gain by one such force, all of them counted in its chance."""
    at = left.at
    shapes = partial(_local_shapes, low=at.low, high=at.high, fast=at.fast)
    gains = left.space.measure(at.probe.changes(at.joint, shapes)).gains()
    gain = float(gains.max(initial=0.0))
    chance = min(1.0, int(np.count_nonzero(gains)) * float(chi2.sf(gain / left.noise, 1)))
    yield Test(f"{LOCAL} at {at.joint}", gain, 1, chance, (at.joint,), 2)


def _local_shapes(q: Array, qd: Array, low: float, high: float, fast: float) -> Array:
    """Forces that nobody has a law for, one amplitude each: at one place of the range (attraction, push, drag, friction
    there), or on one side of it only; shape (k, G)."""
    w = np.clip(qd / fast, -STATE_CUT, STATE_CUT)
    sense = np.tanh(TURNING_STEEPNESS * w)
    values = []
    for share in LOCAL_FORCE_WIDTHS:
        width = share * (high - low)
        for centre in np.arange(low, high + 0.5 * width, 0.5 * width):
            x = (q - centre) / width
            bump = np.exp(-(x**2))
            values += [bump, x * bump, bump * w, bump * sense]
    for centre in [*np.linspace(low, high, ONE_SIDED_FORCE_ANGLES + 2)[1:-1], *([0.0] if low < 0.0 < high else [])]:
        beyond = (q > centre).astype(np.float64)
        values += [beyond * (q - centre), (1.0 - beyond) * (q - centre), beyond * w, beyond * sense]
    return np.array(values)


# A third of the time that all checks take, most of it in compiled code.
CHECK = Check(LOCAL, _asked, every_joint=True, aside=True, of_state=True)
