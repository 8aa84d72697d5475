"""Time stamps that are not those of the readings: noise of an angle that grows with its speed.

A logger stamps a sample when it stores it, a sensor reads it when it can: over a bus, behind a filter of its own, or
interpolated from the last edge of an encoder. Readings that are late by a varying time err by speed times that time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.recording.differences import SQUARE, third_differences
from harness.recording.recording import QualityNote
from harness.system.description import Array

FEWEST = 200  # moving samples
GROUPS = 8  # of equally many samples, by speed
SIGMAS = 6.0  # significance of the growth with speed
WORTH = 1.5  # times the noise of the slowest moving samples that the lateness must make at high speed
OUTLIER = 15.0  # times the median square
ALTERNATES = (
    -0.35
)  # third differences of independent errors correlate by −3/4 from one to the next; those of motion by +1


@dataclass(frozen=True)
class Jitter:
    """Standard deviation of the readings' lateness [s], and of the error that does not depend on speed [channel unit]."""

    lateness: float
    still: float


def timing_jitter(time: Array, values: Array, step: float = 0.0) -> Jitter | None:
    """How much readings are late by a time that varies, or None where noise does not grow with speed.

    time, values: shape (T,), values nan where missing. step: quantisation step of the channel.
    The variance of third differences over even stretches is regressed on the speed's square; samples that move less than
    1.5 steps are left out, since rounding is no noise at rest.
    """
    intervals = np.diff(time)
    usual = float(np.median(intervals))
    third = third_differences(time, values)
    even = np.abs(np.stack([intervals[:-2], intervals[1:-1], intervals[2:]]) - usual).max(axis=0) < 0.5 * usual
    speed = np.abs(values[3:] - values[:-3]) / (3.0 * usual)
    good = even & np.isfinite(third) & (speed * usual > 1.5 * step) & (speed > 0.0)
    if good.sum() < FEWEST:
        return None
    pairs = good[:-1] & good[1:]
    square = third**2 / SQUARE
    if np.sum(third[:-1][pairs] * third[1:][pairs]) > ALTERNATES * np.sum(square[good]) * SQUARE:
        return None
    order = np.argsort(speed[good])
    parts = np.array_split(order, GROUPS)
    v2 = np.array([np.mean(speed[good][part] ** 2) for part in parts])
    # Outliers would speak louder than all the rest.
    level = np.array([float(np.mean(np.minimum(square[good][p], OUTLIER * np.median(square[good][p])))) for p in parts])
    # Third differences overlap: about a third of them are independent.
    error = level * np.sqrt(2.0 * 3.0 / np.array([len(part) for part in parts]))
    error = np.maximum(error, 1e-3 * float(level.max()))
    design = np.stack([np.ones(GROUPS), v2], axis=1) / error[:, None]
    covariance = np.linalg.pinv(design.T @ design)
    floor, slope = covariance @ design.T @ (level / error)
    if slope <= SIGMAS * np.sqrt(covariance[1, 1]) or slope * v2[-1] < (WORTH**2) * max(level[0], step**2 / 12.0):
        return None
    return Jitter(float(np.sqrt(slope)), float(np.sqrt(max(floor, 0.0))))


def jitter_note(name: str, unit: str, time: Array, values: Array, step: float) -> QualityNote | None:
    """The same as a line of the quality table."""
    found = timing_jitter(time, values, step)
    if found is None:
        return None
    moving = np.abs(np.diff(values)) / np.diff(time)
    fast = float(np.nanpercentile(moving, 90))
    return QualityNote(
        "timing_jitter",
        name,
        f"readings are late by a time that varies by {1e3 * found.lateness:.2g} ms: noise grows with speed, "
        f"to {found.lateness * fast:.2g} {unit}",
        "counted as noise of the channel; stamp samples when they are read",
        size=found.lateness,
    )
