"""Windows so short that the vibrations of a model within its tolerance cannot slip by a cycle, and how they grow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.denoc import Denoc
from harness.diagnose.estimation.constants import FEWEST_WINDOW_SAMPLES, SAMPLES_A_CYCLE, VIBRATION_SLIP, WINDOW_GROWTH
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window, equal_parts


def stages(problem: Problem, windows: Sequence[Window]) -> list[tuple[Window, ...]]:
    """Cuts of the windows, finest first; none where the windows are short enough, as those of rigid mechanisms are.

    A model that vibrates at f [Hz], within a tolerance τ, is off by up to f τ L cycles after L seconds. Beyond a quarter of a
    cycle the best fit nearby counts one vibration too many or too few.
    """
    if not problem.system.flexible:
        return []
    slowest_sampling = max(run.interval for run in problem.runs)
    found = Denoc(problem.system).frequencies(np.zeros(len(problem.system.coordinate_names)))
    seen = found[found < 1.0 / (SAMPLES_A_CYCLE * slowest_sampling)]
    slipping = float(seen.max(initial=0.0)) * max(problem.system.tolerance, *problem.system.tolerances.values(), 0.0)
    if slipping <= 0.0:
        return []
    longest = max(float(_duration(problem, window)) for window in windows)
    out: list[tuple[Window, ...]] = []
    parts = WINDOW_GROWTH
    while longest / (parts / WINDOW_GROWTH) > VIBRATION_SLIP / slipping:
        cuts = tuple(piece for window in windows for piece in _split(window, parts))
        if out and cuts == out[-1]:  # samples are too few to go on
            break
        out.append(cuts)
        parts *= WINDOW_GROWTH
    return out[::-1]


def _duration(problem: Problem, window: Window) -> float:
    time = problem.runs[window.run].time
    return float(time[window.last - 1] - time[window.first])


def _split(window: Window, parts: int) -> tuple[Window, ...]:
    """Equal parts of a window, fewer where they would hold too few samples."""
    while parts > 1 and window.size < parts * FEWEST_WINDOW_SAMPLES:
        parts //= WINDOW_GROWTH
    return equal_parts(window, parts)
