"""A model that states the wrong kind of damping: too much of one sort and none of the others."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.diagnose.diagnose import diagnose
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.recording import Recording
from harness.recording.recording import Channel
from harness.system import System
from harness.system.description import Joint, JointType, Link, constant

LENGTH, MASS = 0.15, 0.15
INERTIA = MASS * LENGTH**2
STATED = 1.0 * INERTIA * 0.08  # viscous, N·m·s/rad: about what a viscous fit to the decay would give
DRY = 0.2 * INERTIA  # N·m
DRAG = 0.0045 * INERTIA  # N·m·s²/rad²
NOISE = 2e-4


def swing(angle: float, time: np.ndarray) -> np.ndarray:
    """q'' = −g/l sin q − (dry + drag q'²) sign q', half-swing by half-swing between the reversals."""
    out = np.empty_like(time)
    t, y = time[0], [angle, 0.0]
    while t < time[-1]:
        side = -np.sign(y[0])

        def slope(_: float, s: np.ndarray, side: float = side) -> list[float]:
            return [s[1], -9.81 / LENGTH * np.sin(s[0]) - side * (DRY / INERTIA + DRAG / INERTIA * s[1] ** 2)]

        def reversal(at: float, s: np.ndarray, side: float = side, begun: float = t) -> float:
            return float(s[1] * side) if at > begun + 1e-6 else 1.0

        reversal.terminal = True
        reversal.direction = -1.0
        part = solve_ivp(slope, (t, time[-1] + 1.0), y, rtol=1e-10, atol=1e-12, events=reversal, dense_output=True)
        inside = (time >= t) & (time <= part.t[-1])
        out[inside] = part.sol(time[inside])[0]
        t, y = part.t[-1], [part.y[0, -1], 0.0]
    return out


def recording(angle: float, seed: int) -> Recording:
    time = np.arange(0.0, 10.0, 0.008)
    values = swing(angle, time) + NOISE * np.random.default_rng(seed).normal(size=len(time))
    return Recording(f"swing{seed}", "", time, (Channel("pivot.position", "pivot", "position", "rad", values),))


def model() -> System:
    joint = Joint("pivot", JointType.CONTINUOUS, "base", "arm", axis=constant([0.0, 1.0, 0.0]), damping=STATED)
    link = Link("arm", MASS, constant([0.0, 0.0, -LENGTH]), constant(np.diag([1e-8, 1e-8, 1e-9])))
    return System("pendulum", (joint,), (link,), tolerance=0.005)


@pytest.mark.parametrize("deviations", [-30.0, 0.0, 30.0])
def test_no_more_damping_is_taken_away_than_there_is(deviations: float) -> None:
    system = model()
    swings = [recording(1.5, 1), recording(0.9, 2)]
    (viscous,) = candidates(system, swings, only=("viscous_damping",))
    predictor = Predictor(pose(system, swings))
    hypothesis = Hypothesis((viscous,))
    x = np.zeros(predictor.size(hypothesis))
    # The stated number off by so many of its tolerances, and all that is stated taken away.
    x[[quantity.kind for quantity in predictor.nominal].index("damping")] = deviations
    x[-1] = to_internal(viscous, np.array([-STATED]))[0]
    row = predictor.row(hypothesis, x)
    left = STATED * (np.exp(0.005 * deviations) - 1.0)
    assert row[predictor.mechanism(hypothesis).model.slot("pivot", "damping")] == pytest.approx(
        max(left, 0.0), abs=1e-18
    )


@pytest.mark.slow
def test_stated_damping_is_taken_away_and_what_acts_is_named() -> None:
    few = ("viscous_damping", "coulomb_friction", "quadratic_drag", "base_tilt", "sensor_offset", "cogging_torque")
    found = diagnose([recording(1.5, 1), recording(0.9, 2), recording(1.2, 3)], model(), only=few)
    by_name = {f["effect"]: f["parameters"] for f in found.findings}
    assert set(by_name) == {"viscous_damping", "coulomb_friction", "quadratic_drag"}
    # What acts, from the equation integrated above; taken away is all that the model states.
    assert by_name["coulomb_friction"]["torque"]["value"] == pytest.approx(DRY, rel=0.03)
    assert by_name["quadratic_drag"]["coefficient"]["value"] == pytest.approx(DRAG, rel=0.03)
    assert by_name["viscous_damping"]["coefficient"]["value"] == pytest.approx(-STATED, rel=0.03)
    assert found.verdict == "explained"
