"""A model that leaves a force out says so, how large it is, and keeps its intervals honest; an exact one says nothing.

The truth: one pendulum (Goldstein, Classical Mechanics, ch. 3) with viscous damping and, beside it, a torque that is an
Ornstein-Uhlenbeck process of known size and memory, drawn exactly (Gillespie, Phys. Rev. E 54 (1996) 2084) and held over steps of
a millisecond in a classical Runge-Kutta integration.
"""

from __future__ import annotations

import numpy as np
import pytest
from simulated_recordings import Rig, nominal, recording

from harness import diagnose
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.recording import Recording

NOISE, RATE, LENGTH, STEP = 2e-4, 100.0, 12.0, 1e-3
VISCOUS = 0.004
ONLY = ["viscous_damping", "coulomb_friction", "joint_stiffness", "sensor_offset"]


def _run(name: str, size: float, memory: float, angle: float, seed: int) -> Recording:
    """A release at rest; size [N·m] and memory [s] of the torque that is left out."""
    rng = np.random.default_rng(seed)
    rig = Rig(viscous=VISCOUS)
    steps = round(LENGTH / STEP)
    keep = np.exp(-STEP / memory)
    push = np.empty(steps)
    push[0] = size * rng.standard_normal()
    for k in range(1, steps):
        push[k] = keep * push[k - 1] + size * np.sqrt(1.0 - keep**2) * rng.standard_normal()

    def rate(y: np.ndarray, torque: float) -> np.ndarray:
        pull = torque - rig.viscous * y[1] - rig.moment * np.sin(y[0])
        return np.array([y[1], pull / rig.about_joint])

    y, found = np.array([angle, 0.0]), []
    every = round(1.0 / RATE / STEP)
    for k in range(steps):
        if k % every == 0:
            found.append(y[0])
        a = rate(y, push[k])
        b = rate(y + 0.5 * STEP * a, push[k])
        c = rate(y + 0.5 * STEP * b, push[k])
        d = rate(y + STEP * c, push[k])
        y = y + STEP / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    values = np.array(found) + NOISE * rng.standard_normal(len(found))
    return recording(name, np.arange(len(found)) / RATE, {"pivot.position": values})


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    size, memory = 0.004 * Rig().moment, 0.15
    runs = [_run(f"run{k}", size, memory, angle, 11 + k) for k, angle in enumerate((1.2, 0.9, 0.6, 1.0))]
    return diagnose(runs, model=nominal(), only=ONLY)


def test_the_force_is_told_with_its_size_and_memory(found: Diagnosis) -> None:
    (row,) = found.to_json()["discrepancy"]
    assert (row["joint"], row["unit"]) == ("pivot", "N*m")
    # Estimated from some 300 memories: a tenth of the size, a third of the memory.
    assert row["size"] == pytest.approx(0.004 * Rig().moment, rel=0.3)
    assert row["memory"] == pytest.approx(0.15, rel=0.7)
    assert found.verdict == "partly_explained"
    assert "a force of" in found.summary


def test_what_acts_beside_it_is_found_and_nothing_else(found: Diagnosis) -> None:
    told = [f for f in found.findings if f["grade"] != "possible"]
    assert [(f["effect"], f["grade"]) for f in told] == [("viscous_damping", "established")]
    low, high = told[0]["parameters"]["coefficient"]["ci95"]
    assert low <= VISCOUS <= high
    # Least squares of 20 such sets of recordings, dry friction fitted beside it (scipy.optimize), scatter so that 95 % of them lie
    # within 0.31 of the coefficient; Student's quantile for four recordings widens that by a fifth, and other laws reach further.
    assert high - low < 1.6 * 0.31 * VISCOUS
    assert [row["recording"] for row in told[0]["repeatability"]] == ["run0", "run1", "run2", "run3"]
    assert found.explained_share is not None and found.explained_share > 0.8


def test_an_exact_model_leaves_no_force() -> None:
    runs = [_run(f"run{k}", 0.0, 0.15, angle, 31 + k) for k, angle in enumerate((1.2, 0.9))]
    found = diagnose(runs, model=nominal(), only=ONLY)
    assert found.verdict == "explained"
    assert found.to_json()["discrepancy"] == []
    assert [f["grade"] for f in found.findings] == ["established"]
