"""Rubber that relaxes is no law over position and velocity: it is named as what is left, and nothing else is told for it.

A pendulum with a spring in series with a dashpot (Maxwell's element) at its joint, integrated by SciPy:
I q̈ = τ(t) − m g l sin q − r, ṙ = k q̇ − r/T. Then a disc on a spring with three such elements beside it, all of it linear, where a
high-pass and a low-pass on the sensor make nearly the same of its decay.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import Rig, nominal, recording

from harness import diagnose
from harness.diagnose.criticism.checks.relaxing_force import RELAXES, _forces
from harness.recording import Recording
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

RIG = Rig()
SWING = float(np.sqrt(RIG.moment / RIG.about_joint))  # rad/s
NOISE = 1e-3
STIFFNESS, TIME, DAMPING = 0.05 * RIG.moment, 0.3 / SWING, 0.002


def _driven(t: float) -> float:
    beat = np.sin(5.1 * t) + 0.5 * np.sin(2.3 * t + 1.0)
    return float(RIG.moment * (0.15 * beat + 0.1 * np.sin(11.0 * t)))


def _run(number: int, release: float) -> Recording:
    time = np.arange(0.0, 12.0, 0.01)

    def rate(t: float, y: np.ndarray) -> list[float]:
        force = _driven(t) - RIG.moment * np.sin(y[0]) - y[2] - DAMPING * y[1]
        return [y[1], force / RIG.about_joint, STIFFNESS * y[1] - y[2] / TIME]

    course = solve_ivp(rate, (0.0, 12.0), [release, 0.0, 0.0], t_eval=time, rtol=1e-10, atol=1e-12, max_step=0.01).y[0]
    angle = course + NOISE * np.random.default_rng(number).standard_normal(len(time))
    efforts = np.array([_driven(t) for t in time])
    return recording(f"run{number}", time, {"pivot.position": angle, "pivot.effort": efforts})


def test_an_element_answers_an_even_motion_as_in_the_textbook() -> None:
    # r = v T (1 − e^(−t/T)), Tschoegl (1989), for a rate v from rest on.
    time, rate, times = np.linspace(0.0, 3.0, 301), 0.7, np.array([0.02, 0.5, 40.0])
    forces = _forces(time, rate * time, np.full_like(time, rate), times)
    expected = -rate * times[:, None] * -np.expm1(-time / times[:, None])
    np.testing.assert_allclose(forces, expected, rtol=1e-9, atol=1e-12)


def test_rubber_that_relaxes_is_what_is_left() -> None:
    found = diagnose([_run(k, release) for k, release in enumerate((0.9, -0.6, 1.2))], model=nominal())
    assert found.verdict in ("unexplained", "partly_explained")
    # A damper is part of it, and there is one beside it; neither the base nor a sensor has to do with it.
    assert {finding["effect"] for finding in found.findings} <= {"viscous_damping"}
    (test,) = (t for t in found.remainder["tests"] if t["what"] == f"{RELAXES} at pivot")
    assert test["chance"] < 1e-5
    assert RELAXES in found.summary
    # Beside the damping that is told a little of it is missing, so that the time is off by as much.
    told = float(test["where"][1].split()[1])
    assert told == pytest.approx(TIME, rel=0.25)


DISC_INERTIA, DISC_STIFFNESS = 0.04, 1.5
DISC_SWING = float(np.sqrt(DISC_STIFFNESS / DISC_INERTIA))
ELEMENTS = (
    (0.06, 0.1),
    (0.04, 1.0),
    (0.05, 10.0),
)  # stiffness over the spring's, time times the swing's angular frequency


def _disc(number: int, release: float) -> Recording:
    time = np.arange(0.0, 30.0, 0.02)
    stiffness, times = np.array(ELEMENTS).T
    stiffness, times = stiffness * DISC_STIFFNESS, times / DISC_SWING

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        force = -DISC_STIFFNESS * y[0] - stiffness @ y[2:]
        return np.concatenate([[y[1], force / DISC_INERTIA], y[1] - y[2:] / times])

    start = np.array([release, 0.0, 0.0, 0.0, 0.0])
    course = solve_ivp(rate, (0.0, 30.0), start, t_eval=time, rtol=1e-10, atol=1e-12).y[0]
    angle = course + NOISE * np.random.default_rng(number).standard_normal(len(time))
    return recording(f"run{number}", time, {"disc.position": angle})


def test_filters_of_a_sensor_that_a_relaxing_force_explains_are_not_told() -> None:
    joint = Joint(
        "disc", JointType.CONTINUOUS, "base", "plate", axis=constant([0.0, 0.0, 1.0]), stiffness=DISC_STIFFNESS
    )
    plate = Link("plate", 2.0, constant([0.0, 0.0, 0.0]), constant(np.diag([0.02, 0.02, DISC_INERTIA])))
    model = System("torsion", (joint,), (plate,), tolerance=0.01)
    found = diagnose([_disc(k, release) for k, release in enumerate((-1.34, 1.63))], model=model)
    assert found.verdict in ("unexplained", "partly_explained")
    assert {finding["effect"] for finding in found.findings} <= {"viscous_damping"}
    assert RELAXES in found.summary
