"""Recordings made by MuJoCo with a joint limit, a soft constraint at its default settings.

What they were told as before the catalogue had such a law: a stop twenty times too soft, cogging and a shaken base, and a
remainder.
"""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from simulated_recordings import COM, INERTIA, MASS, nominal, released_in_mujoco

from harness import diagnose
from harness.recording import Recording

NOISE = 1e-3
LIMIT = 0.6
TIME_CONSTANT, IMPEDANCE = 0.02, 0.95  # of the limit, MuJoCo's defaults


def made_by_mujoco(damping: float, least: float) -> tuple[list[Recording], float]:
    """Two recordings, and the inertia that the limit adds while it pushes.

    Steps are so short that what a blow takes does not depend on where in a step it falls: at 0.2 ms that is a hundredth.
    """
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><compiler angle="radian"/><option timestep="0.00002" integrator="RK4"/><worldbody><body>
        <joint name="pivot" axis="0 1 0" range="-9 {LIMIT}" limited="true" damping="{damping}"
          solimplimit="{least} {IMPEDANCE} 0.001"/>
        <inertial pos="0 0 {-COM}" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} 1e-6"/></body></worldbody></mujoco>"""
    )
    runs = released_in_mujoco(model, (-1.6, -1.1), np.arange(0.0, 6.0, 0.01), noise=NOISE, seed=8)
    return runs, IMPEDANCE / (1.0 - IMPEDANCE) / float(model.dof_invweight0[0])


# Undamped, an impedance that grows with the depth, as MuJoCo's does by default, leaves a remainder of a hundredth.
@pytest.mark.parametrize("damping, least", [(0.0, IMPEDANCE), (0.002, 0.9)])
def test_its_limit_is_told_as_a_stop(damping: float, least: float) -> None:
    runs, inertia = made_by_mujoco(damping, least)
    found = diagnose(runs, model=nominal()).replayed()
    assert found.verdict == "explained"
    effects = {f["effect"]: f for f in found.findings}
    assert set(effects) == {"end_stop"} | ({"viscous_damping"} if damping else set())
    stop = effects["end_stop"]["parameters"]
    # Its impedance grows over the first milliradian: by as much the angle may be off.
    assert stop["angle"]["value"] == pytest.approx(LIMIT, abs=2e-3)
    (heavy,) = effects["end_stop"]["modified_by"]
    assert heavy["effect"] == "stop_inertia"
    # What the inertia is hardly shows: it takes out of account what acts beside the stop; how the joint is slowed does.
    own = heavy["parameters"]["inertia"]["value"]
    assert own > inertia / 4.0
    assert stop["stiffness"]["value"] / own == pytest.approx(IMPEDANCE / (IMPEDANCE * TIME_CONSTANT) ** 2, rel=0.1)
    assert stop["damping"]["value"] / own == pytest.approx(2.0 / (IMPEDANCE * TIME_CONSTANT), rel=0.1)
    (again,) = (row for row in found.replay if row["engine"] == "mujoco")
    assert again["difference"] < 0.5 * NOISE
