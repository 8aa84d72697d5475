"""Joints of several degrees of freedom, and joints that follow others, against Pinocchio, MuJoCo and Exudyn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from harness.engines.registry import engine
from harness.errors import EngineUnavailableError, UnsupportedError
from harness.system import Joint, JointType, System
from harness.system.random_joints import following, free_of_a_link, in_space, joint, random_position


def fixed_base() -> System:
    """What Exudyn's tree has too, once the screw and the mimics are reduced."""
    rng = np.random.default_rng(11)
    rest = following()
    first = joint("ball", JointType.UNIVERSAL, "base", "a", rng)
    return System("fixed base", (first, *rest.joints[1:]), rest.links)


@pytest.mark.parametrize("build", [in_space, following, fixed_base, free_of_a_link])
@pytest.mark.parametrize("name", ["pinocchio", "mujoco", "exudyn"])
def test_every_quantity_agrees_to_rounding(build: Callable[[], System], name: str) -> None:
    system = build()
    other = engine(name)
    try:
        other.version()
    except EngineUnavailableError as error:
        pytest.skip(str(error))
    reason = other.refuses(system)
    if name == "exudyn" and build is not fixed_base:
        assert reason is not None and "does not support yet" in reason
        with pytest.raises(UnsupportedError):
            other.build(system)
        return
    assert reason is None
    ours, theirs = engine("denoc").build(system), other.build(system)
    assert ours.names == theirs.names == system.coordinate_names
    rng = np.random.default_rng(13)
    for _ in range(3):
        q, v, tau = random_position(system, rng), *rng.standard_normal((2, system.nv))
        pairs = [
            (ours.forward_dynamics(q, v, tau), theirs.forward_dynamics(q, v, tau)),
            (ours.inverse_dynamics(q, v, tau), theirs.inverse_dynamics(q, v, tau)),
            (ours.mass_matrix(q), theirs.mass_matrix(q)),
            (ours.bias(q, v), theirs.bias(q, v)),
            (ours.gravity(q), theirs.gravity(q)),
        ]
        if name != "exudyn":
            pairs.append((np.array(ours.energy(q, v)), np.array(theirs.energy(q, v))))
        for a, b in pairs:
            np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-12 * max(1.0, float(np.abs(b).max())))


def test_motion_of_a_thrown_mechanism_is_mujoco_s() -> None:
    system = in_space()
    rng = np.random.default_rng(14)
    q, v = random_position(system, rng), rng.standard_normal(system.nv)
    time = np.linspace(0.0, 0.5, 6)
    ours, theirs = (engine(name).build(system).simulate(q, v, time, step=2e-4) for name in ("denoc", "mujoco"))
    assert ours.position_names == theirs.position_names
    # Both by RK4, ours in components of quaternions, MuJoCo's in rotations: errors of order h⁴.
    np.testing.assert_allclose(ours.position, theirs.position, atol=1e-9)


def test_a_spring_or_a_simple_joint_law_beside_a_free_joint_acts_alike() -> None:
    from harness.system import Attachment

    base = in_space()
    # MuJoCo's springs of a joint have one rest position.
    base = base.replace_joint(replace(base.joint("knee"), rest_position=0.0))
    system = System(
        base.name,
        base.joints,
        base.links,
        attachments=(Attachment("cubic_stiffness", "knee", {"stiffness": 4.0}),),
    )
    assert isinstance(base.joints[0], Joint)
    assert engine("denoc").refuses(system) is None
    rng = np.random.default_rng(15)
    q, v = random_position(system, rng), rng.standard_normal(system.nv)
    time = np.linspace(0.0, 0.3, 4)
    ours, theirs = (engine(name).build(system).simulate(q, v, time, step=2e-4) for name in ("denoc", "mujoco"))
    np.testing.assert_allclose(ours.position, theirs.position, atol=1e-9)
