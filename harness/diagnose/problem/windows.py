"""Stretches of recordings over which the model runs freely, each from an initial state of its own."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.problem.problem import Run

Array = NDArray[np.float64]


class Window(NamedTuple):
    """Samples ``first`` (included) to ``last`` (excluded) of run number ``run`` of a problem's ``runs``."""

    run: int
    first: int
    last: int

    @property
    def size(self) -> int:
        return self.last - self.first


def contains(window: Window, piece: Window) -> bool:
    """Whether a piece lies within a window."""
    return piece.run == window.run and window.first <= piece.first and piece.last <= window.last


def whole(runs: Sequence[Run], which: Sequence[int]) -> tuple[Window, ...]:
    """One window a run."""
    return tuple(Window(k, 0, len(runs[k].time)) for k in which)


def cut(runs: Sequence[Run], which: Sequence[int], length: float) -> tuple[Window, ...]:
    """Windows of about ``length`` seconds, all of nearly the same size within a run."""
    windows = []
    for k in which:
        run = runs[k]
        pieces = max(1, round(run.duration / length))
        edges = np.round(np.linspace(0, len(run.time), pieces + 1)).astype(int)
        windows += [Window(k, int(a), int(b)) for a, b in pairwise(edges)]
    return tuple(windows)


def equal_parts(window: Window, count: int) -> tuple[Window, ...]:
    """A window cut into ``count`` parts of nearly the same size."""
    edges = window.first + (window.size * np.arange(count + 1)) // count
    return tuple(Window(window.run, int(a), int(b)) for a, b in pairwise(edges))


def merge(windows: Sequence[Window], groups: Sequence[Sequence[int]]) -> tuple[Window, ...]:
    """Windows joined by groups of consecutive indices."""
    return tuple(Window(windows[g[0]].run, windows[g[0]].first, windows[g[-1]].last) for g in groups)


def local_state(run: Run, channel: int, first: int, span: float) -> tuple[float, float]:
    """Value and slope of a channel at sample ``first`` from a local cubic over ``span`` seconds around it."""
    t0 = run.time[first]
    # Only samples nearby are looked at; at the edges rounding decides as it would among all.
    begin, end = np.searchsorted(run.time, (t0 - span, t0 + span))
    around = slice(max(int(begin) - 1, 0), int(end) + 2)
    close = (np.abs(run.time[around] - t0) <= span) & np.isfinite(run.values[channel, around])
    near = around.start + np.flatnonzero(close)
    if len(near) < 8:
        near = np.argsort(np.abs(run.time - t0))[:12]
        near = near[np.isfinite(run.values[channel, near])]
    if len(near) == 0:
        return 0.0, 0.0
    x = (run.time[near] - t0) / span
    order = min(3, len(near) - 1)
    coefficients = np.polynomial.polynomial.polyfit(x, run.values[channel, near], order)
    slope = float(coefficients[1] / span) if order >= 1 else 0.0
    return float(coefficients[0]), slope
