"""What a set leaves of recorded efforts, as a force at every joint: how large, for how long it keeps, and where most of it lies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.left_out import AtJoint, LeftOut
from harness.diagnose.criticism.left_force import LeftForce, place_of
from harness.diagnose.inverse.constants import FEWEST_MEMORY_SAMPLES, FORGOTTEN_SHARE
from harness.diagnose.inverse.effort_fit import EffortData, EffortFit
from harness.effects.scale import references
from harness.system import System

Array = NDArray[np.float64]


def effort_left(system: System, parts: Sequence[EffortData], fitted: EffortFit) -> LeftOut | None:
    """What is left of the efforts of all recordings beyond their noise; None where that is nothing.

    parts: the training data and those held out.
    """
    left, names = list[LeftForce](), list[str]()
    rows, keeps = [], dict[str, float]()
    for part in parts:
        residuals = part.model.residuals(fitted.hypothesis, fitted.x)
        for run, residual in zip(part.model.runs, residuals, strict=True):
            use = run.usable
            for k in np.flatnonzero(run.driven):
                name = system.joint_names[int(k)]
                left.append(LeftForce(name, len(names), run.time[use], run.q[use, k], run.qd[use, k], residual[use, k]))
            names.append(run.name)
    for j in parts[0].joints:
        joint = system.joint_names[j]
        own = [part.force for part in left if part.joint == joint]
        step = float(parts[0].model.runs[0].time[1])
        keeps[joint] = step * _memory(own)
        power = float(np.mean(np.concatenate(own) ** 2)) - parts[0].noises[j].std ** 2
        if power <= 0.0:
            continue
        size = float(np.sqrt(power))
        unit, natural = system.joint(joint).force_unit, float(references(system, joint).torque)
        rows.append(AtJoint(joint, size, unit, size / natural, keeps[joint]))
    kept = [replace(part, memory=keeps.get(part.joint, 0.0)) for part in left]
    return LeftOut(tuple(rows), place_of(system, names, kept)) if rows else None


def _memory(stretches: Sequence[Array]) -> float:
    """Samples after which what is left has been forgotten, by its autocorrelation over all stretches."""
    longest = max((len(own) // 2 for own in stretches if len(own) >= FEWEST_MEMORY_SAMPLES), default=1)
    sums = np.zeros(longest + 1)
    for own in stretches:
        if len(own) >= FEWEST_MEMORY_SAMPLES:
            # Padded with as many zeros as there are samples, so that the ends do not meet.
            power = np.abs(np.fft.rfft(own, 2 * len(own))) ** 2
            lags = np.fft.irfft(power)[: min(len(own) // 2, longest) + 1]
            sums[: len(lags)] += lags
    if sums[0] <= 0.0:
        return 1.0
    return float(np.argmax(sums < FORGOTTEN_SHARE * sums[0]) or longest)
