"""Waves of a residual over the angle that it was read at: errors of an encoder or of a motor's poles, which are no noise.

A wave of many periods a turn swings as fast as the samples follow one another, at a frequency that goes with the speed; over
time its spectrum is that of coloured noise, over the angle it is one line. So before a residual's noise is estimated, lines of its
spectrum over the angle are taken out of it.

Source: Scargle, Studies in astronomical time series analysis II, Astrophys. J. 263 (1982) 835–853 (chance that noise has a line).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import (
    ANGLE_BLOCK_PERIODS,
    ANGLE_LINE_EVIDENCE,
    ANGLE_OVERSAMPLING,
    FEWEST_ANGLE_PERIODS,
    MOST_ANGLE_LINES,
    MOST_PERIODS_A_TURN,
    ROUNDING_OVERTONES,
)

Array = NDArray[np.float64]


def without_waves(
    residuals: Sequence[Array], angles: Sequence[Array], step: float = 0.0, most: int = MOST_ANGLE_LINES
) -> tuple[list[Array], list[float]]:
    """Residuals without their significant lines over the angle, and the lines' periods a turn, strongest first.

    residuals: pieces [channel unit], each shape (T,); angles: where each sample was read [rad], the same shapes.
    step: of the reading's quantisation [rad], whose error is a wave over the angle too, but one that belongs to the noise.
    most: lines taken out at most.
    """
    edges = np.cumsum([len(piece) for piece in residuals])[:-1]
    left, angle = np.concatenate(residuals), np.concatenate(angles)
    extent = float(np.ptp(angle)) if len(angle) else 0.0
    if extent <= 0.0 or not np.isfinite(extent):
        return list(residuals), []
    lines: list[float] = []
    for _ in range(most):
        found = _line(left, angle, min(extent, 2.0 * np.pi), step)
        if found is None:
            break
        lines.append(found)
        wave = np.stack([np.cos(found * angle), np.sin(found * angle)], axis=1)
        left = left - wave @ np.linalg.lstsq(wave, left, rcond=None)[0]
    return np.split(left, edges), lines


def _line(values: Array, angle: Array, extent: float, step: float) -> float | None:
    """Periods a turn of the strongest line, if noise does not have one so strong.

    A joint that turns more than once reads the same error every turn, so angles are taken within one.
    """
    first = FEWEST_ANGLE_PERIODS * 2.0 * np.pi / extent
    if first > MOST_PERIODS_A_TURN:
        return None
    spacing = 2.0 * np.pi / extent / ANGLE_OVERSAMPLING
    if extent >= 2.0 * np.pi:
        angle = np.mod(angle, 2.0 * np.pi)
    size = int(2 ** np.ceil(np.log2(2.0 * MOST_PERIODS_A_TURN / spacing)))
    turn = 2.0 * np.pi / spacing
    place = np.mod(np.round((angle - angle.min()) / turn * size).astype(np.int64), size)
    power: Array = np.abs(np.fft.rfft(np.bincount(place, weights=values, minlength=size))) ** 2
    periods = spacing * np.arange(len(power), dtype=np.float64)
    usable = (periods >= first) & (periods <= MOST_PERIODS_A_TURN)
    if step > 0.0:
        # Rounding is a sawtooth over the angle, whose overtones beyond what the places resolve come back lower.
        overtones = 2.0 * np.pi / step * np.arange(1, ROUNDING_OVERTONES + 1)
        folded = np.abs(overtones - size * spacing * np.round(overtones / (size * spacing)))
        for overtone in folded:
            usable &= np.abs(periods - overtone) > 2.0 * ANGLE_OVERSAMPLING * spacing
    periods, power = periods[usable], power[usable]
    if len(periods) < ANGLE_BLOCK_PERIODS * ANGLE_OVERSAMPLING:
        return None
    ratio = power / _level(periods, power, spacing)
    best = int(np.argmax(ratio))
    trials = len(periods) / ANGLE_OVERSAMPLING
    return float(periods[best]) if ratio[best] > np.log(trials) + ANGLE_LINE_EVIDENCE else None


def _level(periods: Array, power: Array, spacing: float) -> Array:
    """Mean power of noise about each number of periods, from medians over blocks that widen with it."""
    width = np.maximum(0.5 * periods, ANGLE_BLOCK_PERIODS * ANGLE_OVERSAMPLING * spacing)
    block = np.zeros(len(periods), dtype=np.int64)
    first, number = 0, 0
    while first < len(periods):
        last = int(np.searchsorted(periods, periods[first] + width[first]))
        if len(periods) - last < 0.5 * (last - first):
            last = len(periods)
        block[first:last] = number
        first, number = last, number + 1
    medians = np.array([np.median(power[block == k]) for k in range(number)])
    return np.asarray(np.maximum(medians, 1e-300)[block] / np.log(2.0))
