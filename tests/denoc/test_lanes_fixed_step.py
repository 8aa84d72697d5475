"""Classical Runge-Kutta steps of lanes, against MuJoCo's of the same size, a closed form, and the method's order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.denoc.lanes.model import LaneModel
from harness.engines.mujoco import Mujoco
from harness.errors import InputError, UnsupportedError
from harness.system import Joint, JointType, Link, System, random_chain
from harness.system.description import constant


@pytest.mark.parametrize("n", [1, 7])
def test_step_for_step_what_mujoco_does(n: int) -> None:
    # The same method from the same states: what is left is rounding, while the method's own error at 10 ms is far larger.
    system = random_chain(n, 3, prismatic=0.0, armature=True, damping=True)
    rng = np.random.default_rng(n)
    q0, qd0 = 0.3 * rng.normal(size=(11, n)), rng.normal(size=(11, n))
    time = np.arange(201) * 0.01
    lanes = LaneModel(system)
    position, velocity, _ = lanes.simulate(lanes.row(), q0, qd0, time, method="rk4", step=0.01)
    exact = lanes.simulate(lanes.row(), q0, qd0, time)[0]
    for k in (0, 10):
        theirs = Mujoco().build(system).simulate(q0[k], qd0[k], time, step=0.01)
        assert np.abs(position[k] - theirs.position).max() < 1e-10
        assert np.abs(velocity[k] - theirs.velocity).max() < 1e-9
    assert np.abs(position - exact).max() > 1e-8


def test_fourth_order() -> None:
    lanes = LaneModel(random_chain(3, 5, prismatic=0.0))
    q0, time = np.array([[0.4, -0.3, 0.5]]), np.arange(11) * 0.1
    exact = lanes.simulate(lanes.row(), q0, 0.0 * q0, time, tolerance=1e-13)[0]
    coarse, fine = (
        np.abs(lanes.simulate(lanes.row(), q0, 0.0 * q0, time, method="rk4", step=h)[0] - exact).max()
        for h in (0.02, 0.01)
    )
    assert 12.0 < coarse / fine < 20.0


@pytest.fixture
def slider() -> System:
    """A mass of 2 kg on a level rail."""
    joint = Joint("rail", JointType.PRISMATIC, "base", "cart", axis=constant([1.0, 0.0, 0.0]))
    return System("cart", (joint,), (Link("cart", 2.0),))


@pytest.mark.parametrize("inner", [1, 4])
def test_efforts_between_samples(slider: System, inner: int) -> None:
    # Under a force that rises evenly a mass goes as t³/6, and under one that is held as t²/2; the method is exact for both.
    lanes = LaneModel(slider)
    time = np.arange(11) * 0.1
    rising = 3.0 * time[:, None]
    held = np.zeros((11, 1))
    held[3:] = 4.0
    options = {"method": "rk4", "step": 0.1 / inner}
    position, velocity, acceleration = lanes.simulate(lanes.row(), [0.0], [0.0], time, tau=rising, **options)
    assert position[0, :, 0] == pytest.approx(time**3 / 4.0, abs=1e-14)
    assert velocity[0, :, 0] == pytest.approx(3.0 * time**2 / 4.0, abs=1e-14)
    assert acceleration[0, :, 0] == pytest.approx(1.5 * time, abs=1e-14)
    forces = np.stack([held, 2.0 * held])
    position = lanes.simulate(lanes.row(), np.zeros((2, 1)), [0.0], time, tau=forces, hold="zero", **options)[0]
    since = np.maximum(time - 0.3, 0.0)
    assert position[:, :, 0] == pytest.approx(np.outer([1.0, 2.0], since**2), abs=1e-14)


def test_a_copy_depends_neither_on_its_neighbours_nor_on_threads() -> None:
    lanes = LaneModel(random_chain(4, 2, damping=True))
    rng = np.random.default_rng(4)
    q0, qd0, time = rng.normal(size=(19, 4)), rng.normal(size=(19, 4)), np.arange(31) * 0.01
    together = lanes.simulate(lanes.row(), q0, qd0, time, method="rk4", threads=2)
    alone = lanes.simulate(lanes.row(), q0[17], qd0[17], time, method="rk4")
    for one, all_ in zip(alone, together, strict=True):
        assert np.array_equal(one[0], all_[17])


def test_refusals_name_place_and_mend(slider: System) -> None:
    lanes = LaneModel(slider)
    time = np.arange(11) * 0.1
    with pytest.raises(InputError, match="evenly spaced"):
        lanes.simulate(lanes.row(), [0.0], [0.0], time**2, method="rk4")
    joint = replace(slider.joints[0], friction=0.1)
    with pytest.raises(UnsupportedError, match="rail: coulomb_torque"):
        lanes.simulate(lanes.row(slider.replace_joint(joint)), [0.0], [0.0], time, method="rk4")
