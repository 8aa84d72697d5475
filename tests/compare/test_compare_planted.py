"""Planted disagreements are found, named and placed; each plant is a change that an engine could really have wrong."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from harness.compare.attribution import attribute
from harness.engines import registry
from harness.engines.protocol import EngineModel
from harness.system import System
from harness.system.random_systems import random_chain, random_tree


def arm() -> System:
    system = random_chain(5, 11, prismatic=0.2, armature=True, damping=True)
    joints = tuple(replace(j, stiffness=1.0 + k, rest_position=0.1 * k) for k, j in enumerate(system.joints))
    return replace(system, joints=joints)


def models(changed: System) -> tuple[EngineModel, EngineModel]:
    return registry.engine("pinocchio").build(arm()), registry.engine("mujoco").build(changed)


def states(n: int = 5, count: int = 6) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    q, qd, tau = np.random.default_rng(3).normal(size=(3, count, n))
    return q, qd, tau


def joint(system: System, k: int, **change: float) -> System:
    return system.replace_joint(replace(system.joints[k], **change))


def test_nothing_is_found_where_nothing_is_planted() -> None:
    found = attribute(*models(arm()), *states())
    assert found.blames == ()
    assert found.culprit is None
    assert found.sentence() == "the accelerations agree"


def test_one_link_with_other_mass() -> None:
    link = arm().links[2]
    found = attribute(*models(arm().replace_link(replace(link, mass=1.01 * link.mass))), *states())
    assert found.culprit is not None
    assert found.culprit.term == "mass_matrix"
    assert found.culprit.coordinate == "joint3"
    assert "joint3 carries" in found.sentence()
    assert {blame.term for blame in found.blames} == {"mass_matrix", "coriolis", "gravity"}
    # To first order the shares make up the whole difference.
    assert sum(blame.share for blame in found.blames) == pytest.approx(1.0, abs=0.05)


def test_one_branch_of_a_tree_with_other_inertia() -> None:
    system = random_tree(6, 4, prismatic=0.0)
    for k, name in enumerate(system.joint_names):
        link = system.links[k]
        other = system.replace_link(replace(link, inertia=link.inertia * 1.02))
        pair = registry.engine("pinocchio").build(system), registry.engine("mujoco").build(other)
        found = attribute(*pair, *states(6))
        assert found.culprit is not None
        # On a joint that the base carries, a change of inertia alone can look like one of its armature.
        assert found.culprit.term in ("mass_matrix", "armature")
        assert found.culprit.coordinate == name


def test_gravity_with_the_other_sign() -> None:
    found = attribute(*models(replace(arm(), gravity=-arm().gravity)), *states())
    assert [blame.term for blame in found.blames] == ["gravity"]
    assert found.sentence() == "gravity has the other sign"
    assert found.blames[0].share == pytest.approx(1.0, abs=1e-9)


def test_gravity_of_another_place() -> None:
    found = attribute(*models(replace(arm(), gravity=arm().gravity * 9.80665 / 9.81)), *states())
    assert found.sentence() == f"gravity is {9.80665 / 9.81:.6g} times the reference's"


def test_armature_left_out_at_one_joint() -> None:
    found = attribute(*models(joint(arm(), 3, armature=0.0)), *states())
    assert [blame.term for blame in found.blames] == ["armature"]
    assert found.blames[0].coordinate == "joint4"
    assert f"joint4 by -{arm().joints[3].armature:.3g}" in found.sentence()


def test_damping_left_out_everywhere_and_at_one_joint() -> None:
    system = arm()
    everywhere = replace(system, joints=tuple(replace(j, damping=0.0) for j in system.joints))
    assert attribute(*models(everywhere), *states()).sentence() == "the damping is missing"
    found = attribute(*models(joint(system, 1, damping=0.0)), *states())
    assert [blame.term for blame in found.blames] == ["damping"]
    assert found.sentence() == "the damping differs at joint2 alone"


def test_spring_with_another_rest_position() -> None:
    found = attribute(*models(joint(arm(), 4, rest_position=0.5)), *states())
    assert [blame.term for blame in found.blames] == ["stiffness"]
    assert found.sentence() == "the joint stiffness differs at joint5 alone"


@dataclass(frozen=True, eq=False)
class Faulty:
    """An engine with one fault in how it computes, around one that is sound."""

    inner: Any
    fault: str

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.inner.names)

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        return np.asarray(self.inner.mass_matrix(q))

    def gravity(self, q: np.ndarray) -> np.ndarray:
        return np.asarray(self.inner.gravity(q))

    def bias(self, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        bias = self.inner.bias(q, qd)
        if self.fault == "coriolis missing":
            return self.gravity(q)
        if self.fault == "coriolis doubled":
            return np.asarray(2.0 * bias - self.gravity(q))
        return np.asarray(bias)

    def inverse_dynamics(self, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        lost = self.inner.bias(q, qd) - self.bias(q, qd)
        return np.asarray(self.inner.inverse_dynamics(q, qd, qdd) - lost)

    def forward_dynamics(self, q: np.ndarray, qd: np.ndarray, tau: np.ndarray) -> np.ndarray:
        lost = self.inner.bias(q, qd) - self.bias(q, qd)
        qdd = np.array(self.inner.forward_dynamics(q, qd, tau + lost))
        if self.fault == "recursion":
            qdd[2] *= 1.001
        return qdd


@pytest.mark.parametrize(
    ("fault", "term", "sentence"),
    [
        ("coriolis missing", "coriolis", "the Coriolis and centrifugal force is missing"),
        ("coriolis doubled", "coriolis", "the Coriolis and centrifugal force is 2 times the reference's"),
        (
            "recursion",
            "solution",
            "the forward dynamics of the other engine does not solve its own equation of motion, most at joint3",
        ),
    ],
)
def test_fault_of_the_algorithm(fault: str, term: str, sentence: str) -> None:
    sound, other = models(arm())
    found = attribute(sound, Faulty(other, fault), *states())
    assert [blame.term for blame in found.blames] == [term]
    assert found.sentence() == sentence
    assert found.blames[0].share == pytest.approx(1.0, abs=1e-6)
    # The same seen from the other side.
    back = attribute(Faulty(sound, fault), other, *states())
    assert back.culprit is not None
    assert back.culprit.term == term
