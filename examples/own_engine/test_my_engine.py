"""Run with ``pytest``; the plugin comes with denoc-harness."""

import pytest
from my_engine import MyEngine


@pytest.mark.dynamics("pendulum.urdf")
def test_my_engine_has_the_dynamics_of_the_robot(dynamics_agree):
    dynamics_agree(MyEngine)


@pytest.mark.dynamics("pendulum.urdf")
def test_by_hand(dynamics_system, native_dynamics):
    model = MyEngine().build(dynamics_system)
    assert model.mass_matrix([0.0])[0, 0] == pytest.approx(native_dynamics.mass_matrix([0.0])[0, 0], rel=1e-12)
