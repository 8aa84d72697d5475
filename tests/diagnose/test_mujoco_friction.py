"""Recordings made by MuJoCo with its own dry friction, a soft constraint at its default settings.

What they were told as before the catalogue had such a law: Stribeck friction with cogging, or dry friction with a remainder.
"""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from simulated_recordings import COM, INERTIA, MASS, nominal, released_in_mujoco

from harness import diagnose
from harness.recording import Recording

LEAD = 0.95 * 0.02 / 2.0  # s: timeconst and dmax of MuJoCo's defaults
NOISE = 1e-3


def made_by_mujoco(loss: float, damping: float, integrator: str) -> tuple[list[Recording], float]:
    """Two recordings, and the inertia that the friction adds while it holds."""
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="0.001" integrator="{integrator}"/><worldbody><body>
        <joint name="pivot" axis="0 1 0" frictionloss="{loss}" damping="{damping}"/>
        <inertial pos="0 0 {-COM}" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} 1e-6"/></body></worldbody></mujoco>"""
    )
    runs = released_in_mujoco(model, (1.2, -0.7), np.arange(0.0, 8.0, 0.01), noise=NOISE, seed=6)
    return runs, 0.9 / (1.0 - 0.9) / float(model.dof_invweight0[0])


@pytest.mark.parametrize("loss, damping, integrator", [(0.03, 0.0, "RK4"), (0.01, 0.002, "implicitfast")])
def test_its_softness_is_told_with_the_friction(loss: float, damping: float, integrator: str) -> None:
    runs, held = made_by_mujoco(loss, damping, integrator)
    found = diagnose(runs, model=nominal()).replayed()
    assert found.verdict == "explained"
    effects = {f["effect"]: f for f in found.findings}
    assert set(effects) == {"coulomb_friction"} | ({"viscous_damping"} if damping else set())
    assert effects["coulomb_friction"]["parameters"]["torque"]["value"] == pytest.approx(loss, rel=0.03)
    (softness,) = effects["coulomb_friction"]["modified_by"]
    assert softness["effect"] == "friction_softness"
    # A step of the engine is a tenth of it.
    assert softness["parameters"]["time"]["value"] == pytest.approx(LEAD, abs=2e-3)
    low, high = softness["parameters"]["inertia"]["ci95"]
    assert low <= held <= high
    (again,) = (row for row in found.replay if row["engine"] == "mujoco")
    assert again["difference"] < 0.1 * NOISE
