"""One answer of an engine is wrong while it accelerates as it should: the term in it is named, and the joint it is at.

The wrong answer is MuJoCo's of a mechanism with one thing changed; all other answers, and the reference, are of the mechanism.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from harness.compare.single_answer import blame_answer, blame_momentum
from harness.denoc import Denoc
from harness.engines import registry
from harness.system import System, random_chain

Q, QD = np.random.default_rng(3).normal(size=(2, 6, 5))
CHAIN = random_chain(5, 11, prismatic=0.0, armature=True, damping=True)


@dataclass(frozen=True, eq=False)
class OneAnswerOff:
    """An engine that gives one answer of another mechanism."""

    right: Any
    wrong: Any
    answer: str

    def __getattr__(self, name: str) -> Any:
        return getattr(self.wrong if name == self.answer else self.right, name)


def joint(k: int, **change: float) -> System:
    return CHAIN.replace_joint(replace(CHAIN.joints[k], **change))


def heavier(k: int) -> System:
    return CHAIN.replace_link(replace(CHAIN.links[k], mass=1.01 * CHAIN.links[k].mass))


def blamed(answer: str, changed: System, system: System = CHAIN):
    reference = registry.engine("pinocchio").build(system)
    build = registry.engine("mujoco").build
    return blame_answer(answer, reference, OneAnswerOff(build(system), build(changed), answer), Q, QD)


@pytest.mark.parametrize("answer", ["inverse_dynamics", "mass_matrix", "bias", "gravity", "energy"])
def test_nothing_is_blamed_where_answers_agree(answer: str) -> None:
    assert blamed(answer, CHAIN) is None


@pytest.mark.parametrize(
    ("answer", "changed", "term", "at"),
    [
        ("inverse_dynamics", joint(3, armature=0.0), "armature", "joint4"),
        ("inverse_dynamics", joint(1, damping=0.0), "damping", "joint2"),
        ("inverse_dynamics", heavier(2), "mass_matrix", "joint3"),
        ("energy", joint(3, armature=0.0), "armature", "joint4"),
        ("energy", heavier(2), "mass_matrix", "joint3"),
        ("mass_matrix", joint(3, armature=0.0), "armature", "joint4"),
        ("mass_matrix", heavier(2), "mass_matrix", "joint3"),
    ],
)
def test_the_term_and_the_joint_that_were_changed_are_named(answer: str, changed: System, term: str, at: str) -> None:
    found = blamed(answer, changed)
    assert (found.term, found.coordinate) == (term, at)


@pytest.mark.parametrize("answer", ["inverse_dynamics", "bias", "gravity", "energy"])
def test_weight_of_another_place_is_told_with_its_factor(answer: str) -> None:
    found = blamed(answer, replace(CHAIN, gravity=CHAIN.gravity * 9.80665 / 9.81))
    assert found.term == "gravity"
    # Energy tells weight by differences, of which six digits are sure.
    assert found.words == f"gravity is {9.80665 / 9.81:.6g} times the reference's"


@pytest.mark.parametrize("answer", ["inverse_dynamics", "energy"])
@pytest.mark.parametrize("wrong", [{"stiffness": 2.0, "rest_position": 0.5}, {"stiffness": 2.1, "rest_position": 0.3}])
def test_a_spring_is_told_from_weight_by_the_one_position_that_it_hangs_on(
    answer: str, wrong: dict[str, float]
) -> None:
    found = blamed(answer, joint(4, **wrong), joint(4, stiffness=2.0, rest_position=0.3))
    assert (found.term, found.coordinate) == ("stiffness", "joint5")


@pytest.mark.parametrize("answer", ["inverse_dynamics", "energy"])
def test_weight_beside_springs_is_one_of_both(answer: str) -> None:
    sprung = joint(4, stiffness=2.0, rest_position=0.3)
    found = blamed(answer, replace(sprung, gravity=1.01 * sprung.gravity), sprung)
    assert found.term == "gravity_or_stiffness"


@pytest.mark.parametrize(("k", "part", "changes"), [(2, "linear", {"mass": 1.01}), (1, "angular", {"inertia": 1.01})])
def test_momentum_is_blamed_on_the_joint_that_carries_the_body(k: int, part: str, changes: dict[str, float]) -> None:
    link = CHAIN.links[k]
    changed = CHAIN.replace_link(replace(link, **{key: factor * getattr(link, key) for key, factor in changes.items()}))

    def by_unit_velocities(system: System) -> np.ndarray:
        model = Denoc(system)
        return np.array([[model.momentum(q, unit) for unit in np.eye(5)] for q in Q]).swapaxes(1, 2)

    own, other = by_unit_velocities(CHAIN), by_unit_velocities(changed)
    said, place = blame_momentum(CHAIN.coordinate_names, own, other, 1e-10)
    assert place == {"term": "momentum", "at": f"joint{k + 1}", "part": part}
    assert f"what joint{k + 1} carries" in said
    assert blame_momentum(CHAIN.coordinate_names, own, own, 1e-10) == ("", {})


class BackwardsCoriolis:
    """Bias with the Coriolis force of one joint's motion alone forgotten."""

    def __init__(self, right: Any, forgotten: int) -> None:
        self.right, self.forgotten = right, forgotten

    def __getattr__(self, name: str) -> Any:
        return getattr(self.right, name)

    def bias(self, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        still = qd.copy()
        still[self.forgotten] = 0.0
        return self.right.bias(q, still)


def test_a_coriolis_force_is_named_with_the_joint_whose_motion_it_lacks() -> None:
    reference = registry.engine("pinocchio").build(CHAIN)
    found = blame_answer("bias", reference, BackwardsCoriolis(registry.engine("mujoco").build(CHAIN), 2), Q, QD)
    assert (found.term, found.coordinate) == ("coriolis", "joint3")
