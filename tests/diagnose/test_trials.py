"""What is proposed as the next experiment can be done on the mechanism at hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.diagnose.experiment.trials import directly, trials
from harness.effects.effect import Family
from harness.system import Joint, JointType, Link, System

DURATION, PERIOD = 10.0, 1.2


def system(*joints: Joint) -> System:
    links = [Link(j.child, mass=0.5, com=np.array([0.0, 0.0, -0.2]), inertia=1e-3 * np.eye(3)) for j in joints]
    return System("rig", links=tuple(links), joints=joints, gravity=np.array([0.0, 0.0, -9.81]))


def joint(
    name: str = "pivot", axis: tuple[float, float, float] = (0.0, 1.0, 0.0), parent: str = "base", **more
) -> Joint:
    return Joint(name, more.pop("type", JointType.REVOLUTE), parent, f"{name}_link", axis=np.array(axis), **more)


def test_a_pendulum_is_released_driven_and_given_a_further_sensor() -> None:
    found = trials(system(joint()), "pivot", DURATION, PERIOD, 1.0, 5.0)
    words = [t.what for t in found]
    assert "release from 0.15 rad and record for 10 s" in words
    assert "release from 1.5 rad and record for 30 s, or until rest" in words
    assert sum("N·m" in w for w in words) == 3
    assert [t.link for t in found if t.link] == ["pivot_link"]
    # Largest torque of gravity: m g l = 0.5 · 9.81 · 0.2 N·m.
    assert max(np.abs(t.effort).max() for t in found if t.effort is not None) == pytest.approx(0.15 * 0.981, rel=1e-3)


def test_nothing_goes_beyond_the_limits_that_the_model_states() -> None:
    limited = joint(lower=-0.5, upper=0.5, effort=0.05)
    found = trials(system(limited), "pivot", DURATION, PERIOD, 0.4, 2.0)
    assert max(abs(t.state[0]) for t in found) == 0.5
    assert max(np.abs(t.effort).max() for t in found if t.effort is not None) <= 0.05


def test_a_slide_is_moved_by_metres_and_newtons() -> None:
    inclined = joint("slide", (0.0, 0.6, -0.8), type=JointType.PRISMATIC)
    found = trials(system(inclined), "slide", DURATION, PERIOD, 0.2, 0.5)
    assert all("rad" not in t.what and "N·m" not in t.what for t in found)
    assert any("release from 0.2 m and" in t.what for t in found)
    assert any(" N at " in t.what for t in found)


def test_what_stays_where_it_is_let_go_is_pushed() -> None:
    upright = joint(axis=(0.0, 0.0, 1.0))
    found = trials(system(upright), "pivot", DURATION, PERIOD, 3.0, 4.0)
    moved = [t for t in found if t.effort is None and not t.link]
    assert all(t.what.startswith("push by hand to about ") and t.state[1] > 0.0 for t in moved)
    assert {t.state[1] for t in moved} == {1.0, 2.0, 4.0, 8.0}


def test_of_several_joints_the_one_that_is_moved_is_named() -> None:
    first, second = joint(), replace(joint("elbow", parent="pivot_link"), xyz=np.array([0.0, 0.0, -0.4]))
    found = trials(system(first, second), "elbow", DURATION, PERIOD, 1.0, 5.0)
    assert all("elbow" in t.what for t in found)
    assert all(t.state[0] == 0.0 for t in found)


def test_what_no_motion_parts_is_measured_directly() -> None:
    assert directly([Family.DISSIPATION, Family.DISSIPATION]).count("sets the joint moving") == 1
    both = directly([Family.SENSOR, Family.BASE])
    assert "the sensor against a reference" in both and "the base's inclination" in both
