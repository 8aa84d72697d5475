"""Kinds of faults that no single term of the equation of motion is: each is told from the others by what it does."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from harness.cases.beams import cantilever, strip, two_strips
from harness.cases.case import NATIVE, Bench, Case
from harness.cases.checks.batch import of_row
from harness.cases.checks.beam_blame import by_frequencies
from harness.cases.checks.closed_form_blame import by_truth
from harness.cases.checks.equation_blame import blamed
from harness.cases.four_bar import crank_rocker
from harness.compare.beam_numbers import explain, place_of, sentence
from harness.compare.closed_blame import blame_closed
from harness.compare.single_answer import blame_answer
from harness.denoc import Denoc
from harness.denoc.motion import frequencies
from harness.engines import registry
from harness.system import random_chain

CHAIN = random_chain(4, seed=6, prismatic=0.0, armature=True, damping=True)
RNG = np.random.default_rng(8)
Q, QD, TAU = RNG.standard_normal((3, 6, 4))


def pinocchio(system=CHAIN):
    return registry.engine("pinocchio").build(system)


def with_answers(model, **wrong):
    """A model some of whose answers are others."""
    names = ("names", "mass_matrix", "gravity", "bias", "inverse_dynamics", "forward_dynamics", "energy")
    return SimpleNamespace(**{name: getattr(model, name) for name in names} | wrong)


def test_forces_that_count_otherwise_are_told_from_masses():
    right = pinocchio()
    said, place = of_row(
        "acceleration", lambda q, qd, tau: right.forward_dynamics(q, qd, 0.5 * tau), "pinocchio", right, Q, QD, TAU
    )
    assert place == {"term": "applied_force", "at": ""}
    assert "counted 0.5 times" in said


def test_forward_dynamics_that_are_wrong_alone_are_taken_apart():
    joint = CHAIN.joints[1]
    heavier = pinocchio(CHAIN.replace_joint(replace(joint, armature=joint.armature + 0.01)))
    native = registry.engine(NATIVE).build(CHAIN)
    models = {NATIVE: with_answers(native, forward_dynamics=heavier.forward_dynamics), "pinocchio": pinocchio()}
    told = blamed(Bench(Case("c", "c", "", lambda: CHAIN, ()), CHAIN, models), "pinocchio", Q, QD, TAU)
    assert (told.place["term"], told.place["part"], told.place["at"]) == ("solution", "armature", joint.name)
    assert not told.agree


def test_inverse_dynamics_with_a_sign_wrong_are_told_so():
    right = pinocchio()

    def turned(q, qd, qdd):
        return 2.0 * right.mass_matrix(q) @ qdd - right.inverse_dynamics(q, qd, qdd)

    found = blame_answer("inverse_dynamics", right, with_answers(right, inverse_dynamics=turned), Q, QD)
    assert found.term == "bias" and "other sign" in found.words


def test_energies_that_are_exchanged_are_none():
    right = pinocchio()
    found = blame_answer("energy", right, with_answers(right, energy=lambda q, qd: right.energy(q, qd)[::-1]), Q, QD)
    assert found.term == "energy"


@pytest.mark.parametrize("wrong_first", [False, True])
def test_a_weight_wrong_in_the_energy_alone_is_no_spring_whoever_has_it(wrong_first):
    right = pinocchio()
    light = with_answers(right, energy=lambda q, qd: (right.energy(q, qd)[0], 0.999 * right.energy(q, qd)[1]))
    held = with_answers(
        right, inverse_dynamics=lambda q, qd, qdd: right.inverse_dynamics(q, qd, qdd) - 0.001 * right.gravity(q)
    )
    for quantity, wrong in (("energy", light), ("inverse_dynamics", held)):
        found = blame_answer(quantity, *((wrong, right) if wrong_first else (right, wrong)), Q, QD)
        assert found.term == "gravity" and "spring" not in found.words


def test_masses_that_all_count_otherwise_are_no_single_bodys():
    right = pinocchio()
    heavy = with_answers(right, mass_matrix=lambda q: 1.01 * right.mass_matrix(q))
    found = blame_answer("mass_matrix", right, heavy, Q, QD)
    assert (found.term, found.words) == ("mass_matrix", "the mass matrix is 1.01 times the reference's")
    swift = with_answers(right, energy=lambda q, qd: (0.5 * right.energy(q, qd)[0], right.energy(q, qd)[1]))
    assert "0.5 times" in blame_answer("energy", right, swift, Q, QD).words


@pytest.mark.parametrize(
    ("spoil", "term"),
    [
        (lambda a: a, ""),
        (lambda a: lambda q, qd, tau: a(q, qd, 1.01 * tau), "mass_matrix"),
        (lambda a: lambda q, qd, tau: a(q, qd, tau) + 0.01 * a(q, 0.0 * qd, 0.0 * tau), "gravity"),
        (lambda a: lambda q, qd, tau: a(q, 1.001 * qd, tau), "coriolis"),
        (lambda a: lambda q, qd, tau: a(q, qd, tau - 0.01 * qd), "damping"),
        (lambda a: lambda q, qd, tau: a(q, qd, tau) + 0.01 * a(q, qd, 0.0 * tau), "bias"),
    ],
)
def test_what_a_closed_mechanism_has_wrong_is_told_by_what_its_accelerations_hang_on(spoil, term):
    model = Denoc(crank_rocker())
    q = np.array([model.assemble(np.array([x, 0.0, 0.0]), held=["crank"]) for x in (0.3, 1.1, 2.0)])
    qd = np.array([model.closed_velocity(x, np.array([5.0, 0.0, 0.0])) for x in q])
    tau = np.random.default_rng(1).standard_normal(q.shape)
    other = SimpleNamespace(forward_dynamics=spoil(model.forward_dynamics))
    assert blame_closed(model, other, q, qd, tau, allowed=1e-10).term == term


def test_frequencies_of_other_derivatives_than_those_of_the_forces_are_the_linearization_s(monkeypatch):
    monkeypatch.setattr(frequencies, "CENTRAL", ((1, 45.0 / 60.0), (2, -8.0 / 60.0), (3, 1.0 / 60.0)))
    hanging = replace(cantilever(strip(modes=3)), gravity=np.array([0.0, 0.0, -9.81]))
    said, place = by_frequencies(hanging, NATIVE, np.array([1.0, 2.0]), {0: 1.01, 1: 1.01})
    assert place == {"term": "linearization"} and "linearized" in said


def test_a_closed_form_says_which_of_its_numbers_is_off_and_which_do_the_same():
    def truth(times):
        return np.array([3.0, 5.0]) * np.sqrt(
            times("stiffness") / (times("mass") * (1.0 + np.array([0.2, 0.4]) * times("payload")))
        )

    names = ("payload", "stiffness", "mass")
    assert by_truth("rod", truth, names, truth(lambda name: 0.0 if name == "payload" else 1.0)) == (
        "as with payload 0 times as large", {"link": "rod", "value": "payload"},
    )  # fmt: skip
    said, place = by_truth("rod", truth, names, truth(lambda name: 1.0404 if name == "stiffness" else 1.0))
    assert place == {"link": "rod", "value": "stiffness", "or": "mass"}
    assert "stiffness 1.0404 times" in said and "mass 0.961169 times" in said
    assert by_truth("rod", truth, names, np.array([3.3, 4.9]))[1] == {"link": "rod", "term": "shapes"}


def test_what_is_wrong_at_every_joint_alike_is_told_of_all():
    system = two_strips(1)
    system = replace(system, joints=tuple(replace(joint, damping=0.01) for joint in system.joints))

    def forces(of):
        model = Denoc(of)
        return np.concatenate([model.inverse_dynamics(0.0 * QD[k], QD[k], 0.0 * QD[k]) for k in range(4)])

    damped = replace(system, joints=tuple(replace(joint, damping=0.011) for joint in system.joints))
    found = explain(system, forces, forces(damped) - forces(system))
    assert place_of(found) == {"value": "damping"}
    assert "damping of every joint 1.1 times" in sentence(found, "other")


def test_a_rotor_that_is_forgotten_is_told_however_much_it_does():
    system = two_strips(2)
    system = system.replace_joint(replace(system.joint("elbow"), armature=3e-4))
    start = (np.array([0.5, 0.2, 0.0, 0.0, 0.0, 0.0]), np.zeros(6), np.linspace(0.0, 0.1, 41))

    def motion(of):
        return Denoc(of).simulate(*start).position[:, :2].ravel()

    without = system.replace_joint(replace(system.joint("elbow"), armature=0.0))
    found = explain(system, motion, motion(without) - motion(system))
    assert place_of(found) == {"joint": "elbow", "value": "armature"}
    assert sentence(found, "other") == "other answers as with no armature of joint 'elbow'"
