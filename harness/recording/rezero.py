"""An angle that jumps while the joint stands still: a counter that was set to zero, or recordings joined into one.

A mechanism at rest cannot be elsewhere a sample later and still be at rest. What was read before and after differs by a zero, and
the later readings are put onto the zero of the earlier ones.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from harness.recording.recording import QualityNote
from harness.system.description import Array

STILL = 10  # samples on either side that stand still
LARGE = 4.0  # quantisation steps that a jump has at least
ABOVE = 12.0  # times what the readings vary on either side
MOST = 8  # jumps; beyond, the readings stick and slip


def undo_rezeroing(
    name: str, unit: str, time: Array, values: Array, step: float
) -> tuple[Array, tuple[QualityNote, ...]]:
    """Readings made continuous where they jump at rest, and a note for each jump.

    values: shape (T,), nan where missing. step: quantisation step of the channel, 0 if none. A jump counts if the ten samples on
    either side vary by less than a twelfth of it and by less than one step. Where more than eight would, none is undone: friction
    that holds and lets go looks alike.
    """
    present = np.flatnonzero(np.isfinite(values))
    reading, stamps = values[present], time[present]
    if len(reading) < 4 * STILL:
        return values, ()
    change = np.diff(reading)
    noise = float(np.median(np.abs(np.diff(reading, 2)))) / 0.6745 / np.sqrt(6.0)
    least = max(LARGE * step, ABOVE * noise, 1e-9 * float(np.ptp(reading)))
    # A jump after sample k; the last and the next ten samples of it must be there.
    jumps = np.flatnonzero(np.abs(change) > least)
    jumps = jumps[(jumps + 1 >= STILL) & (jumps + 1 + STILL <= len(reading))]
    windows = sliding_window_view(reading, STILL)
    before, after = (np.ptp(windows[jumps + first], axis=1) for first in (1 - STILL, 1))
    varies = np.maximum(before, after)
    # The step itself is no motion: the interval must be an ordinary one.
    intervals = np.diff(stamps)
    usual = intervals[jumps] < 3.0 * float(np.median(intervals))
    still = (varies < np.abs(change[jumps]) / ABOVE + 1e-15) & (varies <= max(1.01 * step, 6.0 * noise))
    found = jumps[usual & still].tolist()
    if not found or len(found) > MOST:
        return values, ()
    mended = values.copy()
    notes = []
    for at in found:
        jump = float(change[at])
        mended[present[at + 1 :]] -= jump
        notes.append(
            QualityNote(
                "rezeroed",
                name,
                f"jumps by {jump:+.3g} {unit} at {stamps[at + 1]:.4g} s while standing still: its zero was set anew, or recordings "
                "were joined",
                "later readings put onto the earlier zero",
                1,
                ((float(stamps[at]), float(stamps[at + 1])),),
                abs(jump),
            )
        )
    return mended, tuple(notes)
