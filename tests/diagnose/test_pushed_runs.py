"""Further forces along windows act in every prediction, and a set of laws is fitted beside those that it leaves out."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import Rig, nominal, recording

from harness.diagnose.estimation.beside_state_force import along_the_recordings, beside
from harness.diagnose.estimation.least_squares import fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.objective import Objective
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.prediction.predictor import Predictor, Push
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import Window, whole
from harness.effects.scale import pull
from harness.recording import Recording

RIG = Rig()
TIME = np.arange(0.0, 4.0, 0.01)


def pendulum(angle: float, torque, noise: float = 0.0, seed: int = 0) -> np.ndarray:
    """Angles of a pendulum from rest under a torque of time, angle and speed, by SciPy."""

    def slope(t: float, y: np.ndarray) -> list[float]:
        return [y[1], (torque(t, *y) - RIG.moment * np.sin(y[0])) / RIG.about_joint]

    found = solve_ivp(slope, (0.0, TIME[-1]), [angle, 0.0], method="DOP853", rtol=1e-11, atol=1e-12, t_eval=TIME)
    return found.y[0] + noise * np.random.default_rng(seed).normal(size=len(TIME))


@pytest.mark.parametrize("driven", [False, True])
def test_a_push_adds_to_what_acts_in_its_window_only(driven: bool) -> None:
    push, effort = 0.05 * np.sin(3.0 * TIME), 0.04 * np.cos(2.0 * TIME)
    acting = effort if driven else 0.0 * TIME
    with_push = pendulum(0.4, lambda t, *_: np.interp(t, TIME, push + acting))
    without = pendulum(0.4, lambda t, *_: np.interp(t, TIME, acting))
    columns = {"pivot.position": without, **({"pivot.effort": effort} if driven else {})}
    plain = Predictor(pose(nominal(), [recording(f"run{k}", TIME, columns) for k in range(2)]))
    one, other = Window(0, 0, len(TIME)), Window(1, 0, len(TIME))
    pushed = plain.pushed({one: Push(TIME, {"pivot": push})})
    lanes = [(0, window, np.array([0.4, 0.0])) for window in (one, other)]
    x = np.zeros((1, plain.size(Hypothesis())))
    here, there = pushed.predict(Hypothesis(), x, lanes)
    moved = np.abs(with_push - without).max()
    assert moved > 0.05
    # SciPy integrates the same straight lines between the samples.
    assert np.abs(here[0] - with_push).max() < 2e-4 * moved
    assert np.abs(there[0] - without).max() < 2e-4 * moved
    again, _ = plain.predict(Hypothesis(), x, lanes)
    assert np.abs(again - with_push).max() > 0.9 * moved  # what pushes one is nothing to the other


def test_a_set_that_moves_far_from_the_recordings_is_fitted_beside_the_force_that_it_leaves_out() -> None:
    # A force over angle and speed that the model lacks makes the pendulum swing half a turn out of step within four seconds.
    scale = 9.81 * RIG.moment / 9.81

    def torque(_: float, q: float, qd: float) -> float:
        return scale * (-0.25 * np.sin(q) + 0.05 * np.cos(2.0 * q) - 0.01 * qd)

    noise = 1e-3
    runs: list[Recording] = [
        recording(f"run{k}", TIME, {"pivot.position": pendulum(angle, torque, noise, k)})
        for k, angle in enumerate((0.5, 1.0, 1.4))
    ]
    posed = pose(nominal(), runs)
    predictor, likelihood = Predictor(posed), Likelihood(posed, crude_colours(posed))
    windows = whole(posed.runs, range(3))
    objective = Objective(predictor, likelihood, Hypothesis(), windows)
    held = np.ones(predictor.size(Hypothesis()), dtype=bool)
    states = {w: np.array([angle, 0.0]) for w, angle in zip(windows, (0.5, 1.0, 1.4), strict=True)}
    alone = fit(objective, np.zeros(len(held)), states, fixed=held)
    size = likelihood.samples(windows)
    assert alone.cost > 1e4 * size
    force = along_the_recordings(objective, alone, held, pull(posed.system), 1.0)
    assert force is not None
    found = beside(force, objective, alone, held)
    left = sum(float(r @ r) for r in found.residuals)
    assert left < 1.3 * size
