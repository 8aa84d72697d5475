"""The band in which efforts are compared: as high as the noise of the angle allows, as the motion asks for, and as rests ask for.

What a joint does at rest says nothing of its friction, and a low-pass mixes it into the motion on either side: where most of what
moved would be lost to that, the band is wider.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.inverse.constants import (
    ATTENUATION,
    FEWEST_HARMONICS,
    LEAST_MOVING_SHARE,
    NYQUIST_SHARE,
    WIDER_BAND_RATIO,
)
from harness.diagnose.inverse.effort_motion import EffortRun, effort_run, reading_noise
from harness.diagnose.inverse.effort_noise import grid_of
from harness.diagnose.selection.constants.starts import MOTION_HARMONICS
from harness.effects.scale import swings
from harness.recording.recording import Recording
from harness.system import System

Array = NDArray[np.float64]


def band(system: System, recordings: Sequence[Recording]) -> float:
    """One cutoff [Hz] for all recordings: the lowest of theirs, and higher where rests would hide most of the motion."""
    swing = min(pace(system, recording) for recording in recordings)
    cutoff = min(cutoff_for(system, recording, swing) for recording in recordings)
    while True:
        runs = [effort_run(system, recording, cutoff) for recording in recordings]
        if all(_seen(run) >= LEAST_MOVING_SHARE for run in runs):
            return cutoff
        wider = WIDER_BAND_RATIO * cutoff
        for recording in recordings:
            if wider > NYQUIST_SHARE * 0.5 / recording.interval or not _quiet(system, recording, wider):
                return cutoff
        cutoff = wider


def _seen(run: EffortRun) -> float:
    """Share of the samples at which a driven joint moves that lie in stretches long enough to compare."""
    moves = np.any(np.abs(run.sharp[:, run.driven]) >= run.still[run.driven], axis=1) & run.inner
    compared = np.zeros(len(run.time), dtype=bool)
    for stretch in grid_of(run).stretches:
        compared[stretch[0] : stretch[-1] + 1] = True
    return float(np.mean(compared[moves])) if moves.any() else 1.0


def cutoff_for(system: System, recording: Recording, swing: float) -> float:
    """The highest cutoff [Hz] at which the noise of the accelerations stays small beside the accelerations.

    swing: frequency of the slowest swing [Hz].
    """
    highest = min(MOTION_HARMONICS * swing, NYQUIST_SHARE * 0.5 / recording.interval)
    for cutoff in np.geomspace(highest, FEWEST_HARMONICS * swing, 12):
        if _quiet(system, recording, float(cutoff)):
            return float(cutoff)
    return float(max(FEWEST_HARMONICS * swing, 1e-3))


def _quiet(system: System, recording: Recording, cutoff: float) -> bool:
    """Whether the noise of the accelerations is small beside them."""
    run = effort_run(system, recording, cutoff)
    inner = slice(len(run.time) // 20, -max(1, len(run.time) // 20))
    ratios = [
        motion_noise(recording, name, cutoff, 2) ** 2 / max(float(np.var(a[inner])), 1e-30)
        for name, a in zip(system.joint_names, run.smooth(run.qdd).T, strict=True)
    ]
    return max(ratios) < ATTENUATION


def pace(system: System, recording: Recording) -> float:
    """How fast the slowest joint swings or is driven [Hz], whichever is faster: an axis that is all but upright hardly swings."""
    own = np.array(swings(system, recording)) / (2.0 * np.pi)
    return float(min(max(f, driven_at(recording, name)) for f, name in zip(own, system.joint_names, strict=True)))


def driven_at(recording: Recording, joint: str) -> float:
    """Mean frequency of a joint's recorded motion [Hz], zero where its position is not recorded.

    √(∫f² S df / ∫S df) of its spectrum (Rice, Bell System Technical J. 24 (1945) 46), less the white noise of the reading.
    """
    channel = next((c for c in recording.channels if c.site == joint and c.quantity == "position"), None)
    if channel is None:
        return 0.0
    good = np.isfinite(channel.values)
    even = np.arange(recording.time[good][0], recording.time[good][-1], recording.interval)
    values = np.interp(even, recording.time[good], channel.values[good])
    power = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(len(values)))) ** 2
    frequency = np.fft.rfftfreq(len(values), recording.interval)
    # Of white noise all frequencies have as much.
    power = np.maximum(power - reading_noise(recording, channel) ** 2 * 0.375 * len(values), 0.0)
    total = float(power.sum())
    return float(np.sqrt(np.sum(frequency**2 * power) / total)) if total > 0.0 else 0.0


def motion_noise(recording: Recording, joint: str, cutoff: float, order: int) -> float:
    """Standard deviation of the noise of a joint's ``order``-th derivative after a low-pass at ``cutoff`` [Hz].

    White noise of the position: ∫₀^f (2πf)^(2k) S df with S = 2 σ² Δt.
    """
    density = 2.0 * reading_noise(recording, recording.channel(f"{joint}.position")) ** 2 * recording.interval
    power = 2 * order + 1
    return float(np.sqrt((2.0 * np.pi) ** (2 * order) * density * cutoff**power / power))
