"""A late letting go acts where a recording begins: windows within it, from states of their own, are as they are without it."""

from __future__ import annotations

import numpy as np
from simulated_recordings import nominal, recording

from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import ChannelInfo, Problem, Run
from harness.diagnose.problem.windows import Window

INTERVAL, LATE = 0.01, 0.03


def test_only_the_beginning_of_a_recording_waits() -> None:
    time = INTERVAL * np.arange(400)
    system, read = nominal(), recording("run", time, {"pivot.position": np.cos(6.0 * time)})
    run = Run("run", time, np.cos(6.0 * time)[None], None, INTERVAL)
    problem = Problem(system, (ChannelInfo("pivot.position", "pivot", "position", "rad"),), (run,), (run,))
    predictor = Predictor(problem)
    (late,) = (c for c in candidates(system, [read]) if c.effect.name == "late_release")
    hypothesis, x = Hypothesis((late,)), np.zeros(len(predictor.nominal))
    own = np.concatenate([x, to_internal(late, np.array([LATE]))])
    state = np.array([0.4, 1.0])

    def seen(window: Window, h: Hypothesis, at: np.ndarray) -> np.ndarray:
        return predictor.predict(h, at[None], [(0, window, state)])[0][0]

    within = Window(0, 100, 300)
    assert np.array_equal(seen(within, hypothesis, own), seen(within, Hypothesis(), x))
    first = Window(0, 0, 200)
    waits = seen(first, hypothesis, own)
    assert np.abs(waits[:3] - 0.4).max() < 1e-12
    free = seen(first, Hypothesis(), x)
    assert np.abs(waits[3:] - free[:-3]).max() < 1e-9
