"""The force over the state in parts of the windows that it is known along: to learn from some stretches and be tried on others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.linear_response import Response
from harness.diagnose.estimation.state_force import StateForce
from harness.diagnose.problem.problem import Run
from harness.diagnose.problem.windows import Window, contains

Array = NDArray[np.float64]


def in_parts(force: StateForce, runs: Sequence[Run], parts: Sequence[Window]) -> StateForce:
    """The same forces in parts of its windows, with nothing worked out beside them yet; windows of its own stay as they are.

    What a force did before a part begins reaches into it through the state there, and a part's initial state is free: so the
    readings of the part answer as they do in the whole window. Raises StopIteration for a part that lies in none of the windows.
    """
    answers: dict[Window, Array] = {}
    motions: dict[Window, Response] = {}
    shares: dict[Window, Array] = {}
    for part in parts:
        window = next(w for w in force.answers if contains(w, part))
        inside = slice(part.first - window.first, part.last - window.first)
        whole = force.answers[window]
        by_channel = whole.reshape(force.channels, window.size, whole.shape[1])
        answers[part] = by_channel[:, inside].reshape(-1, whole.shape[1])
        if window in force.motions:
            motion, time = force.motions[window], runs[part.run].time
            begins, ends = (float(time[k] - time[window.first]) for k in (part.first, part.last - 1))
            first = max(int(np.searchsorted(motion.time, begins, side="right")) - 1, 0)
            last = int(np.searchsorted(motion.time, ends)) + 1 if part.last < window.last else len(motion.time)
            motions[part] = motion.within(part, slice(first, last), begins)
            shares[part] = force.shares[window][:, first:last]
    return replace(force, answers=answers, motions=motions, shares=shares, known={}, begun={})
