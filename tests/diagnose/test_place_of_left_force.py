"""Where most of a force lies that a fit leaves out; nowhere, where the most is elsewhere and spread evenly."""

from __future__ import annotations

import numpy as np

from harness.diagnose.criticism.left_force import LeftForce, place_of
from harness.system import Joint, JointType, Link, System


def arm() -> System:
    """Two joints about the vertical, alike, so that forces at both weigh alike."""
    joints, links, below = [], [], "base"
    for name in ("first", "second"):
        joints.append(Joint(name, JointType.CONTINUOUS, below, f"{name}_link", axis=np.array([0.0, 0.0, 1.0])))
        links.append(Link(f"{name}_link", 1.0, np.zeros(3), np.diag([1e-2] * 3)))
        below = f"{name}_link"
    return System("arm", tuple(joints), tuple(links))


def left(joint: str, size: float, *, forwards_alone: bool) -> LeftForce:
    """A force of one size in a swing that was recorded for ten whole periods, or while it moves forwards."""
    time = np.arange(0.0, 10.0, 0.01)
    q, qd = np.sin(2.0 * np.pi * time), 2.0 * np.pi * np.cos(2.0 * np.pi * time)
    force = np.where((qd > 0.0) | (not forwards_alone), size, 0.0)
    return LeftForce(joint, 0, time, q, qd, force)


def test_a_place_that_holds_most_is_told() -> None:
    parts = [left("first", 1.0, forwards_alone=True), left("second", 0.1, forwards_alone=False)]
    found = place_of(arm(), ["run"], parts)
    assert found is not None
    assert (found.joint, found.where) == ("first", "moving forwards")
    assert found.share > 0.9 and abs(found.of_time - 0.5) < 0.01


def test_a_place_that_holds_less_than_its_share_of_the_time_is_not() -> None:
    parts = [left("first", 1.0, forwards_alone=True), left("second", 40.0, forwards_alone=False)]
    assert place_of(arm(), ["run"], parts) is None
