"""Stretches in which dry friction holds the model, and what readings do there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.criticism.constants import HELD_CHANGE, HELD_STRETCH_SAMPLES
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.study import Study

Array = NDArray[np.float64]


def predicted(study: Study, fitted: Fit) -> Iterator[tuple[Window, Array, Array]]:
    """Every window with how far the prediction goes to the next sample and what it leaves, in deviations of the noise, (C, T)."""
    lanes = [(0, window, fitted.states[window]) for window in fitted.windows]
    predicted = study.predictor.predict(fitted.hypothesis, fitted.x[None], lanes)
    noise = np.array([[colour.std] for colour in study.likelihood.colours])
    for window, channels, left in zip(fitted.windows, predicted, fitted.linear.residuals, strict=True):
        steps = np.abs(np.diff(channels, axis=1)) / noise
        yield window, np.hstack([steps, steps[:, -1:]]), left.reshape(len(channels), -1)


def still(steps: Array) -> NDArray[np.bool_]:
    """Where a prediction stands still, (T,)."""
    return np.asarray(np.all(steps <= HELD_CHANGE, axis=0))


def stretches(resting: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First sample of every stretch that is still, and the one after its last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], resting, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2) if b - a >= HELD_STRETCH_SAMPLES]


def variation(rows: Array) -> float:
    """Squares of what changes within a stretch, (C, T)."""
    return float(np.sum((rows - rows.mean(axis=1, keepdims=True)) ** 2))
