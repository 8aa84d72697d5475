"""Laws that only take up what nobody has named are not told, and of laws that do so alike none is told for certain.

Truth: the textbook equations of a rotor and of a pendulum, integrated by SciPy, with a force that the catalogue does not have.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import Rig, nominal, recording, releases

from harness.diagnose.diagnose import diagnose
from harness.recording import Recording
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

INERTIA, ONE_WAY = 6e-3, 0.012  # kg·m², N·m·s/rad
NOISE = 1e-3  # rad
ROTOR_LAWS = ("viscous_damping", "coulomb_friction", "stribeck_friction", "quadratic_drag", "constant_torque")
SWING_LAWS = ("viscous_damping", "coulomb_friction", "dahl_friction", "stribeck_friction", "load_dependent_friction")


def rotor() -> System:
    """A disc on a vertical shaft."""
    joint = Joint("shaft", JointType.REVOLUTE, "base", "disc", axis=constant([0.0, 0.0, 1.0]))
    link = Link("disc", 0.8, constant([0.0, 0.0, 0.0]), constant(np.diag([4e-3, 4e-3, INERTIA])))
    return System("rotor", (joint,), (link,), tolerance=0.01)


def braked_one_way(seed: int) -> Recording:
    """The disc under a torque of six waves, with drag while it turns forwards only."""
    rng = np.random.default_rng(seed)
    frequency, phase = 2.0 * np.pi * rng.uniform(0.2, 1.2, 6), rng.uniform(0.0, 2.0 * np.pi, 6)

    def torque(t: float) -> float:
        return 0.034 * float(np.sum(np.sin(frequency * t + phase))) / np.sqrt(6.0)

    time = np.arange(0.0, 12.0, 1.0 / 125.0)
    found = solve_ivp(
        lambda t, y: [y[1], (torque(t) - ONE_WAY * max(y[1], 0.0)) / INERTIA],
        (0.0, time[-1]), [0.0, 0.0], t_eval=time, method="DOP853", rtol=1e-10, atol=1e-12, max_step=0.05,
    )  # fmt: skip
    noisy = found.y[0] + NOISE * rng.standard_normal(len(time))
    effort = np.array([torque(t) for t in time])
    return recording(f"run{seed}", time, {"shaft.position": noisy, "shaft.effort": effort})


@pytest.mark.slow
def test_drag_in_one_sense_is_not_told_as_a_torque_and_friction() -> None:
    told = diagnose([braked_one_way(seed) for seed in (3, 4, 5)], model=rotor(), only=ROTOR_LAWS)
    assert told.verdict in ("unexplained", "partly_explained")
    assert told.remainder["significant"]
    firmly = {f["effect"] for f in told.findings if f["grade"] != "possible"}
    assert not {"constant_torque", "stribeck_friction"} & firmly


@pytest.mark.slow
def test_beside_a_magnet_no_law_of_friction_is_told_for_certain() -> None:
    rig = Rig(viscous=2e-3, torque=lambda t, q, v: -q * float(np.exp(-((q / 0.12) ** 2))))
    told = diagnose(releases(rig, (0.8, 0.4, 0.6), NOISE, seed=21, duration=16.0), model=nominal(), only=SWING_LAWS)
    assert told.verdict in ("unexplained", "partly_explained")
    assert told.remainder["significant"]
    for finding in told.findings:
        assert "viscous_damping" in {finding["effect"], *finding["indistinguishable_from"]}
