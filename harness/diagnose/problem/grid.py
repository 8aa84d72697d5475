"""Even times at which free runs hand over states, and a window's samples among them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from harness.diagnose.problem.problem import Run
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]

EVENLY = 8  # points of a grid are a multiple of this


@dataclass(frozen=True, eq=False)
class Grid:
    """Even times at which lanes hand over states, and how a window's samples lie among them.

    time, stamps: of the grid's points (G,) and of the samples (T,) [s] from the window's first sample; index, weight: sample =
    grid[index] + weight · step, (T,).
    exact: every sample is a grid point; stride: and they are this many points apart, from the first point on (0 if not).
    """

    time: Array
    stamps: Array
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


def _stamps(run: Run, window: Window, margin: float) -> Array:
    """Times of the window's samples from its first one [s], carried on beyond its end by ``margin`` seconds."""
    stamps = run.time[window.first : window.last] - run.time[window.first]
    beyond = int(np.ceil(margin * stamps[-1] / run.interval)) if margin > 0.0 else 0
    return np.concatenate([stamps, stamps[-1] + run.interval * np.arange(1, beyond + 1)])


def make_grid(run: Run, window: Window, finest: float, margin: float = 0.0) -> Grid:
    """The coarsest even grid of at most ``finest`` seconds that samples of the window can be taken from."""
    stamps = _stamps(run, window, margin)
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
    return Grid(np.asarray(time, dtype=np.float64), stamps, index, weight, exact, stride)


def hermite(grid: Grid, position: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array, Array]:
    """Positions, velocities, accelerations (B, G, n) at the window's samples, by quintic Hermite interpolation."""
    if grid.stride > 0:
        part = slice(0, grid.stride * (len(grid.index) - 1) + 1, grid.stride)
        return position[:, part], velocity[:, part], acceleration[:, part]
    if grid.exact:
        return position[:, grid.index], velocity[:, grid.index], acceleration[:, grid.index]
    return _quintic(position, velocity, acceleration, grid.index, grid.weight, grid.step)


def cubic(grid: Grid, position: Array, velocity: Array, count: int) -> Array:
    """Columns (G, K) with their rates at the window's first ``count`` samples, (count, K), by cubic Hermite interpolation."""
    if grid.exact:
        return position[grid.index[:count]]
    s = grid.weight[:count]
    weights = np.array([
        (1.0 - s) ** 2 * (1.0 + 2.0 * s), grid.step * s * (1.0 - s) ** 2,
        s**2 * (3.0 - 2.0 * s), grid.step * s**2 * (s - 1.0),
    ])  # fmt: skip
    return np.asarray(_cubic(position, velocity, grid.index[:count], weights))


@njit(cache=True, error_model="numpy")
def _cubic(position: Any, velocity: Any, index: Any, weights: Any) -> Any:
    count, columns = len(index), position.shape[1]
    out = np.empty((count, columns))
    for t in range(count):
        i = index[t]
        a, b, c, d = weights[0, t], weights[1, t], weights[2, t], weights[3, t]
        for k in range(columns):
            out[t, k] = a * position[i, k] + b * velocity[i, k] + c * position[i + 1, k] + d * velocity[i + 1, k]
    return out


@njit(cache=True, error_model="numpy")
def _quintic(position: Any, velocity: Any, acceleration: Any, index: Any, weight: Any, h: Any) -> Any:
    lanes, _, n = position.shape
    count = len(index)
    q, qd, qdd = (np.empty((lanes, count, n)), np.empty((lanes, count, n)), np.empty((lanes, count, n)))
    for lane in range(lanes):
        for t in range(count):
            i, s = index[t], weight[t]
            for j in range(n):
                p0, v0, a0 = position[lane, i, j], velocity[lane, i, j] * h, acceleration[lane, i, j] * (h * h)
                v1, a1 = velocity[lane, i + 1, j] * h, acceleration[lane, i + 1, j] * (h * h)
                d = position[lane, i + 1, j] - p0
                # p(s) = p0 + v0 s + a0/2 s² + c3 s³ + c4 s⁴ + c5 s⁵ matching value, slope and curvature at both ends
                c3 = 10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1
                c4 = -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1
                c5 = 6.0 * d - 3.0 * (v0 + v1) - 0.5 * (a0 - a1)
                q[lane, t, j] = p0 + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5))))
                qd[lane, t, j] = (v0 + s * (a0 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / h
                qdd[lane, t, j] = (a0 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / (h * h)
    return q, qd, qdd
