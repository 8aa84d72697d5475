"""A number of the description that is off is found by what it does, wherever it stands."""

from __future__ import annotations

import numpy as np
import pytest

from harness.compare.attribution import attribute
from harness.compare.parameters import Group, explain, groups, moved
from harness.engines import registry
from harness.system import random_chain, random_tree

CHAIN = random_chain(3, seed=2, prismatic=0.0, armature=True, damping=True)
BUILD = registry.engine("pinocchio").build
# What is off, and a size that is far from linear.
GROUPS = [group for group in groups(CHAIN) if group.name not in ("link1", "joint1", "base")]


def states(n: int, count: int = 8):
    return np.random.default_rng(5).standard_normal((3, count, n))


@pytest.mark.parametrize("group", GROUPS, ids=lambda group: group.said())
def test_every_number_is_found_and_by_how_much(group):
    by = np.linspace(0.02, 0.03, group.size) * (0.05 if group.member == "inertia" else 1.0)
    wrong = BUILD(moved(CHAIN, group, by))
    found = explain(BUILD, CHAIN, wrong, *states(3))
    assert group in [one.group for one in found]
    (right,) = [one for one in found if one.group == group]
    # Of an axis only what is across it counts, and of what hangs on the first joint only what is across that one's axis.
    if group.member != "axis" and (group.member, group.name) != ("xyz", "joint2"):
        assert right.off == pytest.approx(by, rel=1e-4)
    assert right.place == {group.owner: group.name, "value": group.member}


@pytest.mark.parametrize("seed", [2, 21])
def test_the_inertia_of_a_first_link_is_told_beside_the_armature_of_its_joint(seed):
    """Nothing turns the first joint's axis: of the first link's inertia only the one about it counts, as armature does."""
    system = random_chain(3, seed=seed, prismatic=0.0, armature=True)
    group = Group("link", system.links[0].name, "inertia", 6)
    wrong = BUILD(moved(system, group, np.array([1e-3, 2e-3, 1.5e-3, 1e-4, -2e-4, 3e-4])))
    found = explain(BUILD, system, wrong, *states(3))
    assert {one.group.said() for one in found} == {"armature of joint 'joint1'", "inertia of link 'link1'"}
    assert {one.directions for one in found} == {1}


def test_so_is_that_of_a_link_that_slides_on_it():
    system = random_tree(5, seed=23, prismatic=0.3, armature=True, damping=True)
    wrong = BUILD(
        moved(system, Group("link", "link4", "inertia", 6), np.array([1e-3, 2e-3, 1.5e-3, 1e-4, -2e-4, 3e-4]))
    )
    said = {one.group.said() for one in explain(BUILD, system, wrong, *states(5))}
    assert {"armature of joint 'joint1'", "inertia of link 'link1'", "inertia of link 'link4'"} <= said


def test_what_is_right_needs_no_explanation():
    assert explain(BUILD, CHAIN, BUILD(CHAIN), *states(3)) == []


def test_two_faults_at_two_places_are_not_told_as_one():
    wrong = moved(
        moved(CHAIN, GROUPS[0], np.array([0.1])), Group("link", "link3", "com", 3), np.array([0.01, 0.02, 0.0])
    )
    assert explain(BUILD, CHAIN, BUILD(wrong), *states(3)) == []


def test_a_slider_s_coriolis_force_is_told_at_the_slider():
    system = random_chain(4, seed=9, prismatic=0.0)
    from dataclasses import replace

    from harness.system import JointType

    system = system.replace_joint(replace(system.joints[1], type=JointType.PRISMATIC))
    right = BUILD(system)

    class HalfOfTheSlider:
        """Half of 2 ω × v of joint2: what its speed and the turning of joint1 make together."""

        names = right.names

        def __getattr__(self, name):
            return getattr(right, name)

        def _lost(self, q, qd):
            one, two = np.eye(4)[0] * qd[0], np.eye(4)[1] * qd[1]
            force = [right.bias(q, v) - right.gravity(q) for v in (one + two, one, two)]
            return 0.5 * (force[0] - force[1] - force[2])

        def bias(self, q, qd):
            return right.bias(q, qd) - self._lost(q, qd)

        def inverse_dynamics(self, q, qd, qdd):
            return right.inverse_dynamics(q, qd, qdd) - self._lost(q, qd)

        def forward_dynamics(self, q, qd, tau):
            return right.forward_dynamics(q, qd, tau + self._lost(q, qd))

    q, qd, tau = states(4)
    found = attribute(right, HalfOfTheSlider(), q, qd, tau, called=("pinocchio", "denoc"))
    assert found.culprit.term == "coriolis"
    assert found.culprit.coordinate == "joint2"
    assert "where joint2 moves" in found.sentence()


def test_the_engine_that_does_not_solve_its_own_equation_is_named():
    system = random_tree(4, seed=9, prismatic=0.0)
    right = BUILD(system)

    class Sloppy:
        names = right.names

        def __getattr__(self, name):
            return getattr(right, name)

        def forward_dynamics(self, q, qd, tau):
            return right.forward_dynamics(q, qd, tau) * (1.0 + 1e-6)

    found = attribute(right, Sloppy(), *states(4), called=("pinocchio", "denoc"))
    assert found.culprit.term == "solution"
    assert "forward dynamics of denoc" in found.sentence()


@pytest.mark.parametrize(
    ("group", "times"),
    [
        (Group("joint", "joint2", "axis", 3), -2.0),
        (Group("joint", "joint3", "xyz", 3), -2.0),
        (Group("joint", "joint3", "xyz", 3), -1.0),
        (Group("link", "link2", "com", 3), -2.0),
    ],
)
def test_what_is_turned_round_or_forgotten_is_found_though_no_small_step_leads_there(group, times):
    owner = CHAIN.joint(group.name) if group.owner == "joint" else CHAIN.link(group.name)
    wrong = BUILD(moved(CHAIN, group, times * np.asarray(getattr(owner, group.member))))
    found = explain(BUILD, CHAIN, wrong, *states(3))
    assert group in [one.group for one in found]


def test_ten_numbers_of_a_body_that_are_off_together_are_one_body_s():
    wrong = BUILD(
        moved(CHAIN, Group("link", "link2", "body", 10), 1e-3 * np.array([5, 3, -4, 6, 1, 2, 1.5, 0.1, -0.2, 0.3]))
    )
    found = explain(BUILD, CHAIN, wrong, *states(3, 14))
    assert [one.place for one in found] == [{"link": "link2", "value": "body"}]
