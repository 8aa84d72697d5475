"""What a batch of flexible mechanisms has wrong, told by its joints' motion with the beams held straight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.cases.beams import alternating_chain
from harness.cases.checks.batch import BATCHES, of_row
from harness.cases.checks.batch_straight import straight_row
from harness.denoc import Denoc
from harness.engines import registry
from harness.system.description import constant

RIGHT = alternating_chain(3, 2)
RIGHT = RIGHT.replace_joint(replace(RIGHT.joints[1], damping=0.1))


def told(of, spoilt, engine="pinocchio"):
    rigid = RIGHT.rigid()
    model = registry.engine(engine).build(rigid)
    names = RIGHT.coordinate_names
    where = np.array([names.index(name) for name in rigid.coordinate_names])
    q, qd, tau = np.random.default_rng(5).standard_normal((3, 4, len(where)))
    return of_row(of, straight_row(of, Denoc(spoilt), where, 11), engine, model, q, qd, tau)


@pytest.mark.parametrize("of", BATCHES)
def test_equal_rows_that_are_right_leave_how_different_ones_stand_together(of):
    assert told(of, RIGHT)[1] == {"term": "rows"}


@pytest.mark.parametrize("of", ["acceleration", "inverse_dynamics"])
def test_the_term_is_named_with_its_joint(of):
    joint = RIGHT.joints[1]
    said, place = told(of, RIGHT.replace_joint(replace(joint, damping=0.2)))
    assert place == {"term": "damping", "at": joint.name}, said
    said, place = told(of, RIGHT.replace_joint(replace(joint, armature=joint.armature + 0.01)))
    assert place == {"term": "armature", "at": joint.name}, said
    said, place = told(of, replace(RIGHT, gravity=constant(1.01 * RIGHT.gravity)))
    assert place["term"] == "gravity" and "1.01 times" in said


def test_a_body_is_named_by_the_joint_that_carries_it_in_every_answer():
    link = next(link for link in reversed(RIGHT.links) if not link.flexible)  # of the first, an armature is the same
    spoilt = RIGHT.replace_link(replace(link, mass=1.1 * link.mass))
    for of in BATCHES:
        assert told(of, spoilt)[1] == {"term": "mass_matrix", "at": RIGHT.carrier(link.name).name}


@pytest.mark.parametrize("engine", ["pinocchio", "mujoco"])
def test_forces_that_count_half_are_told_though_nothing_is_damped(engine, monkeypatch):
    whole = Denoc.forward_dynamics_batch
    monkeypatch.setattr(Denoc, "forward_dynamics_batch", lambda self, q, qd, tau: whole(self, q, qd, 0.5 * tau))
    plain = alternating_chain(3, 2)
    rigid = plain.rigid()
    where = np.array([plain.coordinate_names.index(name) for name in rigid.coordinate_names])
    q, qd, tau = np.random.default_rng(5).standard_normal((3, 4, len(where)))
    row = straight_row("acceleration", Denoc(plain), where, 11)
    said, place = of_row("acceleration", row, engine, registry.engine(engine).build(rigid), q, qd, tau)
    assert place["term"] == "applied_force" and "0.5 times" in said
