"""Dissipation that a model states too much of may be taken away, and no more than that."""

from dataclasses import replace

import pytest

from harness.effects.attach import apply
from harness.errors import InputError
from harness.system import Attachment
from harness.system.random_systems import random_chain


def test_dissipation_may_be_taken_away_down_to_nothing() -> None:
    chain = random_chain(1, 3)
    joint = replace(chain.movable_joints[0], damping=0.4, friction=0.3)
    system = chain.replace_joint(joint)
    less = apply(system, Attachment("viscous_damping", joint.name, {"coefficient": -0.1}))
    assert less.joint(joint.name).damping == pytest.approx(0.3)
    none = apply(system, Attachment("coulomb_friction", joint.name, {"torque": -0.3}))
    assert none.joint(joint.name).friction == pytest.approx(0.0)
    with pytest.raises(InputError, match="not possible"):
        apply(system, Attachment("viscous_damping", joint.name, {"coefficient": -0.5}))
    with pytest.raises(InputError, match="not possible"):
        apply(
            chain.replace_joint(replace(joint, friction=0.0)),
            Attachment("coulomb_friction", joint.name, {"torque": -0.1}),
        )
