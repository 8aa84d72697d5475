"""A spring that carries most of an arm's weight is no other body: what does for it is told as one force over the position."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import recording

from harness.diagnose.diagnose import diagnose
from harness.recording import Recording
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

MASS, LENGTH, SLENDER, GRAVITY, DAMPING = 3.0, 0.4, 0.02, 9.81, 0.4  # kg, m, kg·m², m/s², N·m·s/rad
STIFFNESS, SLACK, ALONG, ABOVE = 600.0, 0.1, 0.08, 0.2  # N/m, m, m along the arm, m above the pivot


def arm() -> System:
    joint = Joint("joint", JointType.REVOLUTE, "base", "arm", axis=constant([0.0, 1.0, 0.0]), damping=DAMPING)
    link = Link("arm", MASS, constant([0.0, 0.0, LENGTH]), constant(np.diag([SLENDER, SLENDER, 1e-3])))
    return System("arm", (joint,), (link,), tolerance=0.01)


def balancing(q: float) -> float:
    """Torque of a spring from the arm to a point above the pivot [N·m], the angle from upright: k r h (1 − l₀/D) sin q."""
    apart = np.sqrt(ALONG**2 + ABOVE**2 - 2.0 * ALONG * ABOVE * np.cos(q))
    return -STIFFNESS * ALONG * ABOVE * (1.0 - SLACK / apart) * float(np.sin(q))


def spring(q: float) -> float:
    """Of a joint's own spring."""
    return -4.0 * q


def driven(seed: int, torque) -> Recording:
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 10.0, 0.005)
    size, phase = rng.uniform(0.2, 0.5, 4), rng.uniform(0.0, 2.0 * np.pi, 4)
    rate = 2.0 * np.pi * np.array([0.2, 0.45, 0.8, 1.3])
    about = SLENDER + MASS * LENGTH**2

    def sent(t: float, q: float, v: float) -> float:
        return float(
            40.0 * (np.sin(rate * t + phase) @ size - q) + 8.0 * (np.cos(rate * t + phase) @ (rate * size) - v)
        )

    def change(t: float, y: np.ndarray) -> list[float]:
        weight = MASS * GRAVITY * LENGTH * np.sin(y[0])
        return [y[1], (sent(t, *y) + weight + torque(y[0]) - DAMPING * y[1]) / about]

    q, v = solve_ivp(change, (0.0, time[-1]), [0.3, 0.0], t_eval=time, rtol=1e-9, atol=1e-10, max_step=0.02).y
    effort = np.array([sent(*row) for row in zip(time, q, v, strict=True)]) + 0.05 * rng.standard_normal(len(time))
    return recording(
        f"run{seed}", time, {"joint.position": q + 2e-4 * rng.standard_normal(len(time)), "joint.effort": effort}
    )


def test_bodies_that_make_up_for_one_another_are_no_more_than_possible() -> None:
    told = diagnose([driven(seed, balancing) for seed in (1, 2, 3)], arm(), fit_effort=True)
    assert told.findings
    assert {f["grade"] for f in told.findings} == {"possible"}
    assert "one force over the position that nobody has named" in told.summary


def test_a_spring_at_the_joint_stands() -> None:
    told = diagnose([driven(seed, spring) for seed in (1, 2, 3)], arm(), fit_effort=True)
    (found,) = told.findings
    assert (found["effect"], found["grade"]) == ("joint_stiffness", "established")
    assert found["parameters"]["stiffness"]["value"] == pytest.approx(4.0, rel=0.02)
