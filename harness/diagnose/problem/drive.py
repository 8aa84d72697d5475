"""How a recorded effort acts between its samples: smoothly through them, or held from each to the next.

A measured torque passes smoothly through its samples. A controller's command is held until the next one, which for what a
mechanism can follow is the smooth effort half an interval late.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from harness.diagnose.problem.constants import EFFORT_GAP_INTERVALS, EFFORT_PARTS, MOST_EFFORT_POINTS
from harness.diagnose.problem.problem import Run

Array = NDArray[np.float64]


class Drive:
    """Recorded efforts of one run as they act: on a grid of a simulation, to be joined by straight lines or kept for a step.

    signal: at the run's samples, (B, T); or at ``times`` from its first one, where they are finer, and laws have bent it since.
    """

    def __init__(self, run: Run, signal: Array, *, held: bool, times: Array | None = None) -> None:
        stamps = run.time - run.time[0]
        self.held = held
        # Averaging in blocks h apart has lost this share, times (ω h)², of a wave.
        averaging = (1.0 - 1.0 / run.averaged**2) / 24.0
        if not held:
            self.bent = times is not None
            self._curves: dict[int, CubicSpline] = {}
            if times is not None:
                self._times, self._values = times, signal
                self._parts = run.interval / float(np.median(np.diff(times))) if len(times) > 1 else 1.0
            else:
                self._times, self._values = _bridged(
                    stamps, _given_back(stamps, signal, averaging), EFFORT_GAP_INTERVALS * run.interval
                )
            return
        # Of a block the first sample was held from its own time on. Holding for a block's h loses a twenty-fourth, of which holding
        # for the interval of recording did lose a part.
        signal = _given_back(stamps, signal, 2.0 * averaging)
        begins = stamps - 0.5 * (1.0 - 1.0 / run.averaged) * run.interval
        # What was applied before the first sample, and is after the last one, is what these say.
        far = stamps[-1] + run.interval
        self._times = np.concatenate([[begins[0] - far], begins, [begins[-1] + far]])
        self._forces = np.concatenate([signal[:, :1], signal], axis=1)
        # What they have done to a free unit mass by the time of every change: its speed and its place.
        lasts = np.diff(self._times)
        self._impulse = _added(self._forces * lasts)
        self._moved = _added(0.5 * (self._impulse[:, 1:] + self._impulse[:, :-1]) * lasts)

    def at(self, when: Array, row: int = 0) -> Array:
        """One of the efforts on an even grid ``when`` [s] from the run's first sample, (G,).

        Held ones are the mean over the step that a point begins, so that none of their impulse is lost. What a change within a step
        would do to the motion by its place there is made up for by the next step.
        """
        if not self.held:
            # Straight lines between points h apart lose a twelfth of (ω h)². Samples lie anywhere between the points.
            if not self.bent:
                return _given_back(when, self._curve(when, row), 1.0 / 12.0)
            # Where a law has bent the curve between points, its mean over the hat of each keeps the impulse. That loses as much,
            # and the lines between the finer times a little.
            mean = _over_hats(when, lambda t: np.interp(t, self._times, self._values[row]))
            return _given_back(when, mean, (2.0 - 1.0 / EFFORT_PARTS**2 + 1.0 / self._parts**2) / 12.0)
        return self._held(when, row)

    def finer(self) -> tuple[Array, Array]:
        """Times from the first sample, several to every interval, and a smooth effort there, (1, T)."""
        times, parts = self._times, int(np.clip(MOST_EFFORT_POINTS // len(self._times), 1, EFFORT_PARTS))
        places = np.arange((len(times) - 1) * parts + 1) / parts
        fine = np.interp(places, np.arange(len(times)), times)
        return fine, self._curve(fine, 0)[None]

    def _curve(self, when: Array, row: int) -> Array:
        if len(self._times) < 2:
            return np.full(len(when), self._values[row, 0])
        if row not in self._curves:
            self._curves[row] = CubicSpline(self._times, self._values[row])
        return np.asarray(self._curves[row](np.clip(when, self._times[0], self._times[-1])))

    def _held(self, when: Array, row: int) -> Array:
        step = when[1] - when[0]
        edges = np.append(when, when[-1] + step)
        last = np.clip(np.searchsorted(self._times, edges, side="right") - 1, 0, len(self._times) - 2)
        since = edges - self._times[last]
        force, before = self._forces[row][last], self._impulse[row][last]
        impulse = before + force * since
        moved = np.diff(self._moved[row][last] + before * since + 0.5 * force * since**2)
        forces = np.diff(impulse) / step
        delayed = 0.5 * (impulse[1:] + impulse[:-1]) / step - moved / step**2
        forces -= delayed
        forces[1:] += delayed[:-1]
        return forces


def _over_hats(when: Array, curve: Callable[[Array], Array]) -> Array:
    """The mean of a curve over the hat function of every point of an even grid."""
    step = (when[1] - when[0]) / EFFORT_PARTS
    fine = when[0] + step * np.arange(-EFFORT_PARTS, EFFORT_PARTS * len(when) + 1)
    hat = EFFORT_PARTS - np.abs(np.arange(-EFFORT_PARTS, EFFORT_PARTS + 1))
    return np.convolve(curve(fine), hat / hat.sum(), mode="same")[
        EFFORT_PARTS : EFFORT_PARTS * (len(when) + 1) : EFFORT_PARTS
    ]


def _bridged(time: Array, signal: Array, longest: float) -> tuple[Array, Array]:
    """Samples (B, T) with points on straight lines across gaps, over which slopes of noisy samples would lead a curve astray."""
    missing = np.maximum(np.ceil(np.diff(time) / longest).astype(int) - 1, 0)
    if not missing.any():
        return time, signal
    within = [np.linspace(a, b, n + 2)[:-1] for a, b, n in zip(time[:-1], time[1:], missing, strict=True)]
    filled = np.append(np.concatenate(within), time[-1])
    return filled, np.array([np.interp(filled, time, own) for own in signal])


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


def _added(parts: Array) -> Array:
    """Sums of the first 0, 1, 2 … of parts (B, T), (B, T + 1)."""
    return np.concatenate([np.zeros((len(parts), 1)), np.cumsum(parts, axis=1)], axis=1)
