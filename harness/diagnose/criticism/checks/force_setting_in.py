"""A push, friction, drag or spring that sets in at some moment or grows all along, in one recording or in all alike."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.criticism.check import Check, Remainder, Test
from harness.diagnose.criticism.constants import SETTING_IN_MOMENTS, STATE_CUT, TURNING_STEEPNESS
from harness.diagnose.criticism.gains import jointly
from harness.effects.effect import Effect, Family

Array = NDArray[np.float64]

SETS_IN = "a force that sets in"


def _asked(left: Remainder) -> Iterator[Test]:
    """Largest gains by such a force: in one recording, in all alike."""
    at, space = left.at, left.space
    own, joint, k = at.probe, at.joint, at.place
    longest = max(run.date(-1) for run in own.predictor.runs)
    moments = np.linspace(0.0, longest, SETTING_IN_MOMENTS + 2)[1:-1]
    best, count, where = 0.0, 0, ""
    chosen, columns = [], []
    for place, window in enumerate(own.fitted.windows):
        found = own.motions[window]
        run = own.predictor.runs[window.run]
        time = found.time + run.date(window.first)
        speed = np.clip(found.qd[:, k] / at.fast, -STATE_CUT, STATE_CUT)
        shapes = np.array([np.ones_like(speed), np.tanh(TURNING_STEEPNESS * speed), speed, np.sin(found.q[:, k])])
        later = (time[None, :] >= moments[:, None]).astype(np.float64)
        histories = np.vstack([(shapes[:, None, :] * later[None]).reshape(-1, len(speed)), shapes * time / longest])
        columns.append(own.pulses(joint, window, histories))
        gains = space.measure([columns[-1]], only=place).gains()
        count += len(gains)
        top = int(np.argmax(gains))
        chosen.append(columns[-1][top])
        if gains[top] > best:
            best = float(gains[top])
            where = f"{run.name} {_since(moments, shapes, top)}"
    chance = min(1.0, count * float(chi2.sf(best / left.noise, 1)))
    yield Test(f"{SETS_IN} at {joint}", best, 1, chance, (joint, where), 2, (jointly(space, chosen), len(chosen)))
    gains = space.measure(columns).gains()
    top = int(np.argmax(gains))
    chance = min(1.0, len(gains) * float(chi2.sf(gains[top] / left.noise, 1)))
    where = f"{_since(moments, shapes, top)} in every recording"
    yield Test(f"{SETS_IN} every time at {joint}", float(gains[top]), 1, chance, (joint, where), 2)


def _since(moments: Array, shapes: Array, column: int) -> str:
    """When the force of a column of a history acts."""
    return (
        f"from {moments[column % len(moments)]:.2f} s on"
        if column < len(shapes) * len(moments)
        else "growing all along"
    )


def _no_dissipation(effects: Sequence[Effect]) -> bool:
    """A friction or drag that sets in soon after the start is hardly another thing than one that always acts."""
    return not any(effect.family is Family.DISSIPATION for effect in effects)


CHECK = Check(SETS_IN, _asked, every_joint=True, may_stand_for=_no_dissipation)
