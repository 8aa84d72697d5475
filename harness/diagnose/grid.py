"""Even times at which free runs hand over states, and a window's samples among them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.problem import Run
from harness.diagnose.windows import Window

Array = NDArray[np.float64]

EVENLY = 8  # points of a grid are a multiple of this


@dataclass(frozen=True, eq=False)
class Grid:
    """Even times at which lanes hand over states, and how a window's samples lie among them.

    time: [s] from the window's first sample, shape (G,); index, weight: sample = grid[index] + weight · step, shape (T,).
    exact: every sample is a grid point; stride: and they are this many points apart, from the first point on (0 if not).
    """

    time: Array
    index: NDArray[np.intp]
    weight: Array
    exact: bool
    stride: int = 0

    @property
    def step(self) -> float:
        return float(self.time[1] - self.time[0])

    @property
    def own(self) -> Array:
        """The times that the samples need, without those that only let other windows run along."""
        return self.time[: int(self.index[-1]) + 2]


def window_stamps(run: Run, window: Window, margin: float) -> Array:
    """Times of the window's samples from its first one [s], carried on beyond its end by ``margin`` seconds."""
    stamps = run.time[window.first : window.last] - run.time[window.first]
    beyond = int(np.ceil(margin * stamps[-1] / run.interval)) if margin > 0.0 else 0
    return np.concatenate([stamps, stamps[-1] + run.interval * np.arange(1, beyond + 1)])


def make_grid(run: Run, window: Window, finest: float, margin: float = 0.0) -> Grid:
    """The coarsest even grid of at most ``finest`` seconds that samples of the window can be taken from."""
    stamps = window_stamps(run, window, margin)
    spacing = np.diff(stamps)
    even = bool(np.all(np.abs(spacing - run.interval) < 1e-6 * run.interval + 2e-7))
    step = run.interval / max(1, int(np.ceil(run.interval / finest - 1e-9))) if even else min(finest, run.interval)
    count = int(np.ceil(stamps[-1] / step - 1e-9)) + 1
    # Windows that differ by a sample or two run on the same times, and so together.
    time = step * np.arange(-(-(count + 1) // EVENLY) * EVENLY)
    place = stamps / step
    index = np.minimum(np.floor(place + 1e-6).astype(np.intp), count - 1)
    weight = np.clip(place - index, 0.0, 1.0)
    exact = bool(np.all(np.abs(place - np.round(place)) < 1e-3)) and even
    stride = 0
    if exact:
        index, weight = np.round(place).astype(np.intp), np.zeros(len(stamps))
        stride = int(index[1] - index[0]) if len(index) > 1 else 1
        if stride <= 0 or not np.array_equal(index, stride * np.arange(len(index))):
            stride = 0
    return Grid(np.asarray(time, dtype=np.float64), index, weight, exact, stride)


def hermite(grid: Grid, position: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array, Array]:
    """Positions, velocities, accelerations (B, G, n) at the window's samples, by quintic Hermite interpolation."""
    if grid.stride > 0:
        part = slice(0, grid.stride * (len(grid.index) - 1) + 1, grid.stride)
        return position[:, part], velocity[:, part], acceleration[:, part]
    if grid.exact:
        return position[:, grid.index], velocity[:, grid.index], acceleration[:, grid.index]
    i, s, h = grid.index, grid.weight[None, :, None], grid.step
    p0, v0, a0 = position[:, i], velocity[:, i] * h, acceleration[:, i] * (h * h)
    p1, v1, a1 = position[:, i + 1], velocity[:, i + 1] * h, acceleration[:, i + 1] * (h * h)
    d = p1 - p0
    # p(s) = p0 + v0 s + a0/2 s² + c3 s³ + c4 s⁴ + c5 s⁵ matching value, slope and curvature at both ends
    c3 = 10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1
    c4 = -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1
    c5 = 6.0 * d - 3.0 * (v0 + v1) - 0.5 * (a0 - a1)
    q = p0 + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5))))
    qd = (v0 + s * (a0 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / h
    qdd = (a0 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / (h * h)
    return q, qd, qdd
