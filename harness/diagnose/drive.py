"""How a recorded effort acts between its samples: smoothly through them, or held from each to the next.

A measured torque passes smoothly through its samples. A controller's command is held until the next one, which for what a
mechanism can follow is the smooth effort half an interval late.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.problem import Run

Array = NDArray[np.float64]


class Drive:
    """Recorded efforts of one run as they act: on a grid of a simulation, to be joined by straight lines or kept for a step.

    signal: at the run's samples, (B, T).
    """

    def __init__(self, run: Run, signal: Array, *, held: bool) -> None:
        stamps = run.time - run.time[0]
        self.held = held
        if not held:
            # Straight lines between samples h apart lose the share (ω h)²/12 of a wave.
            self._times, self._values = stamps, _given_back(stamps, signal, 1.0 / 12.0)
            return
        # Of blocks that samples were averaged in, the first one was held from its own time on. Holding for a block's h loses the
        # share (ω h)²/24, of which holding for the interval of recording did lose a part.
        signal = _given_back(stamps, signal, (1.0 - 1.0 / run.averaged**2) / 24.0)
        begins = stamps - 0.5 * (1.0 - 1.0 / run.averaged) * run.interval
        # What was applied before the first sample, and is after the last one, is what these say.
        far = stamps[-1] + run.interval
        self._times = np.concatenate([[begins[0] - far], begins, [begins[-1] + far]])
        steps = np.concatenate([signal[:, :1], signal], axis=1) * np.diff(self._times)
        self._values = np.concatenate([np.zeros((len(signal), 1)), np.cumsum(steps, axis=1)], axis=1)

    def at(self, when: Array, row: int = 0) -> Array:
        """One of the efforts on an even grid ``when`` [s] from the run's first sample, (G,).

        Held ones are the mean over the step that a point begins, so that none of their impulse is lost.
        """
        if not self.held:
            return np.asarray(np.interp(when, self._times, self._values[row]))
        step = when[1] - when[0]
        edges = np.append(when, when[-1] + step)
        return np.asarray(np.diff(np.interp(edges, self._times, self._values[row])) / step)


def joined(steps: Array) -> Array:
    """Forces (B, G, n) to be joined by straight lines that act as ones that are kept from each point to the next."""
    out = steps.copy()
    out[:, 1:] = 0.5 * (steps[:, 1:] + steps[:, :-1])
    return out


def kept(straight: Array) -> Array:
    """Forces (B, G, n) to be kept from each point to the next that act as ones joined by straight lines."""
    out = straight.copy()
    out[:, :-1] = 0.5 * (straight[:, 1:] + straight[:, :-1])
    return out


def _given_back(time: Array, signal: Array, share: float) -> Array:
    """Samples (B, T) with (ω h)² times ``share`` added to their waves; a mechanism does not follow what lies far above."""
    if len(time) < 3 or share == 0.0:
        return signal
    spacing = np.diff(time)
    before, after = spacing[:-1], spacing[1:]
    slopes = np.diff(signal, axis=-1) / spacing
    out = signal.astype(np.float64, copy=True)
    out[..., 1:-1] -= np.diff(slopes, axis=-1) * 2.0 / (before + after) * before * after * share
    return out
