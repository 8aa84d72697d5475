"""A stop that is met in the first swing and again later carries nothing: no hand comes back to the same place."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import Rig, nominal, recording

from harness.diagnose.conditioning.free_motion import carried_start

TIME = np.arange(0.0, 12.0, 0.005)


def read(angle: float, speed: float, stop: float, stiffness: float, hand: float = 0.0):
    """A pendulum that swings into a soft stop, or that a hand carries for 0.5 s with a torque of ``hand`` [N·m]."""
    rig = Rig(viscous=0.004)

    def change(t: float, y: np.ndarray) -> list[float]:
        met = stiffness * max(y[0] - stop, 0.0) - hand * (t < 0.5)
        return [y[1], (-rig.moment * np.sin(y[0]) - met - rig.viscous * y[1]) / rig.about_joint]

    q = solve_ivp(change, (0.0, TIME[-1]), [angle, speed], t_eval=TIME, rtol=1e-9, atol=1e-11, max_step=5e-3).y[0]
    return recording("run", TIME, {"pivot.position": q + 5e-4 * np.random.default_rng(1).standard_normal(len(TIME))})


@pytest.mark.parametrize("stiffness", [0.5, 1.0, 2.0, 5.0])
@pytest.mark.parametrize(
    ("angle", "speed", "stop"), [(0.1, 3.0, 0.3), (0.0, 4.0, 0.3), (0.3, 0.5, 0.2), (0.45, 0.0, 0.25)]
)
def test_a_stop_that_is_met_again_is_no_hand(angle: float, speed: float, stop: float, stiffness: float) -> None:
    assert carried_start(nominal(), read(angle, speed, stop, stiffness)) is None


def test_a_hand_is_one() -> None:
    found = carried_start(nominal(), read(-0.6, 0.0, 9.0, 0.0, hand=0.4))
    assert found is not None and 0.3 < found.time < 1.5
