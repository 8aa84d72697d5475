"""Readings that stand still while the joint moves: a sensor that was not asked again, a message that was lost."""

from __future__ import annotations

import numpy as np

from harness.recording.clean import runs_of
from harness.recording.differences import white_noise
from harness.recording.recording import QualityNote
from harness.system.description import Array

EXACT = 1e-6  # of the signal's extent: computed signals are no noisier, and may stand still in truth
FINE = 0.01  # of the noise, that readings must resolve: of coarser ones neighbours are equal by chance
MOST = 0.3  # of the samples; a sensor slower than its logger repeats most of them, which is left as it is


def find_stale(name: str, time: Array, values: Array, step: float) -> tuple[Array, QualityNote | None]:
    """Repeated readings of a noisy signal set to nan, the first of each stretch kept.

    time, values: shape (T,), values nan where missing. step: quantisation step of the channel: with one, equal readings are as they
    should be, and so they are at the signal's extremes (saturation).
    """
    noise = white_noise(time, values)
    if step > 0.0 or np.isnan(noise):
        return values, None
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    levels = np.unique(values[np.isfinite(values)])
    if noise <= EXACT * (high - low) or float(np.diff(levels).min(initial=np.inf)) > FINE * noise:
        return values, None
    repeats = np.zeros(len(values), dtype=bool)
    repeats[1:] = (np.diff(values) == 0.0) & (values[1:] != low) & (values[1:] != high)
    count = int(repeats.sum())
    if count == 0 or count > MOST * len(values):
        return values, None
    mended = np.where(repeats, np.nan, values)
    stretches = runs_of(repeats)
    note = QualityNote(
        "stale",
        name,
        f"{count} readings in {len(stretches)} places repeat the one before to the last digit",
        "left out",
        count,
        tuple((float(time[first]), float(time[last - 1])) for first, last in stretches[:16]),
    )
    return mended, note
