"""Terms of what runs many copies at once, told apart by its accelerations alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.cases.case import NATIVE, Bench, Case
from harness.cases.checks.batch import in_rows
from harness.cases.checks.lane_motion import in_lanes
from harness.cases.checks.states import random_states
from harness.denoc import Denoc
from harness.denoc.lanes.model import LaneModel
from harness.engines import registry
from harness.system import random_chain
from harness.system.description import constant

SYSTEM = random_chain(3, seed=64, prismatic=0.0, armature=True, damping=True)


def of_joint(member, by):
    def spoil(system):
        joint = system.joints[1]
        return system.replace_joint(replace(joint, **{member: getattr(joint, member) + by}))

    return spoil


def bench_of(system, *names):
    models = {name: registry.engine(name).build(system) for name in names}
    return Bench(Case("many", "many", "", lambda: system, ()), system, models)


SPOILT = [
    (of_joint("armature", 0.01), "armature", "armature of joint 'joint2'"),
    (of_joint("damping", 0.2), "damping", "damping of joint 'joint2'"),
    (lambda system: replace(system, gravity=constant(1.01 * system.gravity)), "gravity", "gravity"),
    (lambda system: system.replace_link(replace(system.links[2], mass=2.0)), "mass_matrix", "mass of link 'link3'"),
]


@pytest.mark.parametrize(("spoil", "term", "words"), SPOILT)
def test_the_term_and_the_number_that_the_lanes_have_wrong_are_named(spoil, term, words):
    rng = np.random.default_rng(3)
    q, qd = rng.standard_normal((2, 8, 3))
    said, place = in_lanes(bench_of(SYSTEM, NATIVE), LaneModel(spoil(SYSTEM)), q, qd)
    assert place["term"] == term
    assert words in said


def test_lanes_that_accelerate_as_they_should_are_told_to_be_integrated_wrongly():
    q, qd = np.random.default_rng(3).standard_normal((2, 8, 3))
    said, place = in_lanes(bench_of(SYSTEM, NATIVE), LaneModel(SYSTEM), q, qd)
    assert (said, place) == ("their accelerations agree, so it is how they are integrated", {"term": "integration"})


@pytest.mark.parametrize("of", ["acceleration", "inverse_dynamics"])
@pytest.mark.parametrize(("spoil", "term", "words"), SPOILT)
def test_the_term_that_a_batch_has_wrong_is_named(of, spoil, term, words):
    bench = bench_of(SYSTEM, "pinocchio")
    states = random_states(bench, 19, 1.0, 1.0, 0.0)
    said, place = in_rows(bench, of, Denoc(spoil(SYSTEM)), "pinocchio", states)
    assert place["term"] == term
    assert {"armature": "joint2", "damping": "joint2", "mass_matrix": "joint3", "gravity": "gravity"}[term] in said


def test_rows_that_are_right_alone_are_told_to_stand_together_wrongly():
    bench = bench_of(SYSTEM, "pinocchio")
    states = random_states(bench, 19, 1.0, 1.0, 0.0)
    said, place = in_rows(bench, "acceleration", Denoc(SYSTEM), "pinocchio", states)
    assert (said, place) == ("equal rows are right, so it is how different ones stand together", {"term": "rows"})
