"""How fast joints swing by themselves: gravity and springs of their own pull them back, and some have neither."""

from __future__ import annotations

import numpy as np
import pytest

from harness.effects.scale import references, swing, swings
from harness.recording import Channel, Recording
from harness.system import Joint, JointType, Link, System

INERTIA, MASS, LENGTH = 2e-3, 0.3, 0.2


def _joint(name: str, parent: str, axis: tuple[float, float, float], stiffness: float = 0.0) -> Joint:
    return Joint(name, JointType.CONTINUOUS, parent, f"{name}_link", axis=np.array(axis), stiffness=stiffness)


def _disc(name: str) -> Link:
    return Link(f"{name}_link", MASS, np.zeros(3), np.diag([INERTIA] * 3))


def test_a_torsion_pendulum_swings_by_its_spring() -> None:
    stiffness = 5.0
    system = System("wire", (_joint("wire", "base", (0.0, 0.0, 1.0), stiffness),), (_disc("wire"),))
    assert swings(system) == pytest.approx([np.sqrt(stiffness / INERTIA)])
    assert references(system, "wire").frequency == pytest.approx(np.sqrt(stiffness / INERTIA))


def test_a_spring_adds_to_what_gravity_pulls() -> None:
    stiffness = 0.4
    bob = Link("pivot_link", MASS, np.array([0.0, 0.0, -LENGTH]), np.zeros((3, 3)))
    system = System("pendulum", (_joint("pivot", "base", (0.0, 1.0, 0.0), stiffness),), (bob,))
    weight = MASS * 9.81 * LENGTH
    assert swings(system) == pytest.approx([np.sqrt((weight + stiffness) / (MASS * LENGTH**2))])
    # Torques are counted in what the weight asks for, with a spring beside it or without.
    assert references(system, "pivot").torque == pytest.approx(weight)


def test_motion_is_counted_in_the_first_joint_that_anything_pulls_back() -> None:
    stiffness = 3.0
    hub, bend = _joint("hub", "base", (0.0, 0.0, 1.0)), _joint("bend", "hub_link", (0.0, 0.0, 1.0), stiffness)
    system = System("hub and beam", (hub, bend), (_disc("hub"), _disc("bend")))
    assert swing(system) == pytest.approx(np.sqrt(stiffness / INERTIA))
    loose = System("hub", (hub,), (_disc("hub"),))
    assert swing(loose) == pytest.approx(2.0 * np.pi)


@pytest.mark.parametrize(("read", "over"), [("wire.position", 1.4), ("wire.velocity", 1.0)])
def test_a_joints_torques_are_counted_in_what_its_spring_makes_over_the_motion(read: str, over: float) -> None:
    """Closed form: k · q, where that is more than the (2π)² J of a disc that nothing is known to pull back."""
    stiffness = 5.0
    system = System("wire", (_joint("wire", "base", (0.0, 0.0, 1.0), stiffness),), (_disc("wire"),))
    time = np.linspace(0.0, 3.0, 301)
    angle = Channel(read, "wire", read.removeprefix("wire."), "rad", 0.3 + 1.4 * np.cos(2.0 * np.pi * time))
    sizes = references(system, "wire", Recording("run", "run", time, (angle,), ()))
    assert sizes.torque == pytest.approx(stiffness * over)
    # The spring pulls the disc back once.
    assert sizes.frequency == pytest.approx(np.sqrt(stiffness / INERTIA))
    assert stiffness * over > INERTIA * (2.0 * np.pi) ** 2


def test_a_weak_spring_counts_for_less_than_the_weight() -> None:
    bob = Link("pivot_link", MASS, np.array([0.0, 0.0, -LENGTH]), np.zeros((3, 3)))
    system = System("pendulum", (_joint("pivot", "base", (0.0, 1.0, 0.0), 0.4),), (bob,))
    time = np.linspace(0.0, 3.0, 301)
    run = Recording(
        "run", "run", time, (Channel("pivot.position", "pivot", "position", "rad", 0.5 * np.cos(5.0 * time)),), ()
    )
    assert references(system, "pivot", run).torque == pytest.approx(MASS * 9.81 * LENGTH)
