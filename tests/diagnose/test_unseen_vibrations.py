"""Initial states of vibrations that die out before a sensor sees them: noise alone must not lead them astray."""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, releases

from harness.diagnose.estimation.gauss_newton import following
from harness.diagnose.estimation.window_states import loosely_held
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose

STRONG, WEAK = 1e3, 1e-3  # sensitivities of two states [noise standard deviations]
NOISE = 2.0


def steps(stiff: float, begun: float = 0.0) -> np.ndarray:
    """What one window's two states do about a residual of ``NOISE`` along each."""
    triangle = (np.diag([STRONG, WEAK]), np.zeros((2, 0)), np.full(2, NOISE))
    held = np.array([0.0, stiff])
    return following([triangle], np.zeros(0), 0.0, held, np.array([[0.0, begun]]))[0]


def test_what_is_seen_follows_and_what_is_not_stays_near_zero() -> None:
    free, held = steps(0.0), steps(10.0)
    assert free == pytest.approx([-NOISE / STRONG, -NOISE / WEAK], rel=1e-6)
    assert held[0] == pytest.approx(-NOISE / STRONG, rel=1e-6)
    # Ridge regression: s r / (s² + w²).
    assert held[1] == pytest.approx(-WEAK * NOISE / (WEAK**2 + 100.0), rel=1e-6)


def test_it_is_led_back_to_zero() -> None:
    assert steps(10.0, begun=3.0)[1] == pytest.approx(-3.0, rel=1e-4)


def test_joints_are_free_and_vibrations_are_held() -> None:
    system, runs = nominal(), releases(Rig(), (0.8,), 1e-3, seed=3, duration=2.0)
    (bends,) = (c for c in candidates(system, runs) if c.key == "link_flexibility@rod")
    predictor = Predictor(pose(system, runs))
    assert not loosely_held(predictor, Hypothesis()).any()
    held = loosely_held(predictor, Hypothesis((bends,)))
    names = predictor.mechanism(Hypothesis((bends,))).names
    joint = [name == "pivot" for name in names]
    assert ((held == 0.0) == np.array([*joint, *joint])).all()
