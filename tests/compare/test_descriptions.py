"""Two descriptions of one mechanism: what differs is found where it is, what is only written otherwise is no difference."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.cases.descriptions import pairs_of
from harness.compare.descriptions import TOLERANCE, alike, compare, costs
from harness.compare.descriptions.bodies import assembled, bodies
from harness.engines.registry import engine
from harness.system import Joint, JointType, Link, System, load
from harness.system.description import constant
from harness.system.random_systems import random_chain, random_tree
from harness.system.rotation import about_axis

MODELS = Path(__file__).parent / "descriptions"
ARM = load(MODELS / "arm.urdf")


def differing(first: System, second: System, tolerance: float = TOLERANCE) -> dict[tuple[str, str], float]:
    """Field and site to size, of what differs beyond the tolerance."""
    return {(d.field, d.site): d.size for d in compare(first, second).differences if not d.size <= tolerance}


def with_other_frames(system: System, seed: int) -> System:
    """The same mechanism with every link frame turned at random, and the origin slid along the joint's axis."""
    rng = np.random.default_rng(seed)
    turns = {system.base: (np.eye(3), np.zeros(3))}
    joints, links = [], []
    for joint, link in zip(system.joints, system.links, strict=True):
        axis = rng.normal(size=3)
        turn = about_axis(axis / np.linalg.norm(axis), rng.uniform(0.3, 3.0))
        slid = rng.uniform(-0.2, 0.2) * np.asarray(joint.axis)
        # A point x of the old frame is turnᵀ (x - slid) in the new one.
        above, shift = turns[joint.parent]
        turns[link.name] = (turn, slid)
        joints.append(
            replace(
                joint,
                xyz=constant(above.T @ (joint.xyz + joint.rotation @ slid - shift)),
                rotation=constant(above.T @ joint.rotation @ turn),
                axis=constant(turn.T @ joint.axis),
            )
        )
        com = turn.T @ (link.com - slid)
        links.append(replace(link, com=constant(com), inertia=constant(turn.T @ link.inertia @ turn)))
    return replace(system, joints=tuple(joints), links=tuple(links))


def renamed(system: System) -> System:
    """The same mechanism with other names throughout."""
    joints = tuple(
        replace(
            joint, name=f"axis_{k}", child=f"body_{joint.child}",
            parent="world" if joint.parent == system.base else f"body_{joint.parent}",
        )
        for k, joint in enumerate(system.joints)
    )  # fmt: skip
    links = tuple(replace(link, name=f"body_{link.name}") for link in system.links)
    return replace(system, joints=joints, links=links, base="world")


@pytest.mark.parametrize("seed", range(6))
def test_frames_chosen_otherwise_and_other_names_are_no_difference(seed):
    system = random_tree(9, seed)
    other = renamed(with_other_frames(system, seed))
    assert alike(system, other)
    # Rounding of a dozen rotations, one after the other.
    assert max(d.size for d in compare(system, other).differences) < 1e-9


def changed(system: System, field: str, k: int) -> tuple[System, str, float]:
    """A system with one field of its k-th body changed, where that is, and the size of the change by its definition."""
    joint, link = system.joints[k], system.links[k]
    if field == "mass":
        return system.replace_link(replace(link, mass=1.25 * link.mass)), link.name, 0.2
    if field == "com":
        size = max(float(np.linalg.norm(link.com)), float(np.sqrt(np.linalg.eigvalsh(link.inertia)[-1] / link.mass)))
        shifted = constant(np.asarray(link.com) + 0.02 * size * np.array([0.6, 0.0, 0.8]))
        return system.replace_link(replace(link, com=shifted)), link.name, 0.02
    if field == "inertia":
        return system.replace_link(replace(link, inertia=constant(1.25 * np.asarray(link.inertia)))), link.name, 0.2
    if field == "axis":
        axis = np.asarray(joint.axis)
        aside = np.cross(axis, [0.3, -0.5, 0.8])
        aside /= np.linalg.norm(aside)
        turned = constant(np.cos(0.1) * axis + np.sin(0.1) * aside)
        return system.replace_joint(replace(joint, axis=turned)), joint.name, 0.1
    if field == "frame's direction":
        turn = about_axis(np.array([0.0, 0.6, 0.8]), 0.07)
        return system.replace_joint(replace(joint, rotation=constant(joint.rotation @ turn))), joint.name, 0.07
    if field in ("armature", "damping", "friction", "stiffness"):
        before = system.replace_joint(replace(joint, **{field: 0.3}))
        return before, joint.name, 1.0
    raise ValueError(field)


FIELDS = ("mass", "com", "inertia", "axis", "frame's direction", "armature", "damping", "friction", "stiffness")


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("k", (0, 3))
def test_the_field_that_was_changed_is_the_one_that_is_told(field, k):
    system = random_tree(7, 4)
    bare = replace(system.joints[k], armature=0.0, damping=0.0, friction=0.0, stiffness=0.0)
    system = system.replace_joint(bare)
    other, site, size = changed(system, field, k)
    other = with_other_frames(other, 8) if field != "frame's direction" else other
    found = differing(system, other)
    assert set(found) == {(field, site)}
    assert found[field, site] == pytest.approx(size, rel=1e-6)


def test_a_joint_that_was_moved_does_not_blame_what_hangs_on_it():
    elbow = ARM.joint("elbow")
    other = ARM.replace_joint(replace(elbow, xyz=constant(np.asarray(elbow.xyz) + np.array([0.0, 0.0, 0.006]))))
    # 6 mm of the longest link, which is 0.30 m.
    assert differing(ARM, other) == {("frame", "elbow"): pytest.approx(0.02)}


def test_what_is_welded_may_be_one_link_or_two():
    tool = Link("tool", 0.2, constant([0.0, 0.0, 0.03]), constant(np.diag([1e-4, 1e-4, 5e-5])))
    flange = Joint("flange", JointType.FIXED, "hand", "tool", xyz=constant([0.0, 0.0, 0.1]))
    apart = replace(ARM, joints=(*ARM.joints, flange), links=(*ARM.links, tool))
    one = assembled(bodies(apart), apart)
    assert [link.name for link in one.links] == ["upper", "fore", "hand"]
    assert differing(apart, one) == {}
    # Both name the tool: then the tool is told, not all that moves with it.
    heavier = apart.replace_link(replace(tool, mass=0.25))
    assert differing(apart, heavier) == {("mass", "tool"): pytest.approx(0.2)}
    # One names it, the other does not: 0.05 kg of 0.65 kg.
    assert differing(one, heavier)["mass", "hand"] == pytest.approx(0.05 / 0.65)


def test_gravity_a_limit_and_a_body_that_only_one_has():
    wrist = ARM.joint("wrist")
    assert differing(ARM, replace(ARM, gravity=constant([0.0, 0.0, -1.62]))) == {
        ("gravity", "base"): pytest.approx(1.0 - 1.62 / 9.81)
    }
    moon = compare(ARM, replace(ARM, gravity=constant([0.0, 0.0, -1.62]))).differences
    assert next(d.stated for d in moon if d.field == "gravity") == "(0, 0, -9.81) against (0, 0, -1.62) m/s²"
    assert differing(ARM, ARM.replace_joint(replace(wrist, upper=2.0))) == {
        ("position limit", "wrist"): pytest.approx(1 / 3)
    }
    # MJCF has no word for it.
    assert differing(ARM, ARM.replace_joint(replace(wrist, velocity=np.inf))) == {}
    handless = replace(ARM, joints=ARM.joints[:2], links=ARM.links[:2])
    assert set(differing(ARM, handless)) == {("body", "hand")}
    assert set(differing(handless, ARM)) == {("body", "hand")}


@pytest.mark.parametrize(
    ("file", "field", "site", "size"),
    [
        ("arm_damping.xml", "damping", "elbow", 0.03 / 0.08),  # 0.05 against 0.08 N·m·s/rad
        ("arm_inertia.xml", "inertia", "fore", 0.0005 / 0.0105),  # 0.0100 against 0.0105 kg·m²
    ],
)
def test_a_file_in_another_format_is_told_with_its_cost_as_mujoco_has_it(file, field, site, size):
    other = load(MODELS / file)
    comparison = compare(ARM, other)
    (found,) = [d for d in comparison.differences if d.size > TOLERANCE]
    assert (found.field, found.site) == (field, site)
    assert found.size == pytest.approx(size, rel=1e-9)
    (alone,), together = costs(comparison, [found])
    assert str(alone) == str(together)
    # The same second of both files in an engine of its own.
    runs = []
    for system in (ARM, other):
        model = engine("mujoco").build(system)
        runs.append(model.simulate(np.full(3, 0.5), np.ones(3), np.linspace(0.0, 1.0, 101)))
    column = runs[0].names.index(alone.joint)
    apart = float(np.abs(runs[0].position[:, column] - runs[1].position[:, column]).max())
    # MuJoCo's dry friction at the shoulder creeps where ours sticks.
    assert alone.apart == pytest.approx(apart, rel=0.1)
    assert alone.travelled == pytest.approx(float(np.ptp(runs[0].position[:, column])), rel=0.05)
    if field == "damping":
        speed = float(np.abs(runs[0].velocity[:, column]).max())
        assert (alone.forced, alone.force) == ("elbow", pytest.approx(0.03 * speed, rel=0.1))


def test_two_models_are_held_against_one_another_and_of_more_those_that_share_names():
    inertia, strange = load(MODELS / "arm_inertia.xml"), random_chain(5, 1)
    assert pairs_of({"a": ARM, "b": strange}) == [("a", "b")]
    assert pairs_of({"a": ARM, "s": strange, "b": inertia}) == [("a", "b")]
    assert pairs_of({"a": ARM}) == []
    assert not alike(ARM, strange)


def test_a_rotor_told_as_inertia_costs_no_more_than_rounding():
    """Armature of a joint and inertia about its axis are one number to a pendulum: both differ, together they cost nothing."""
    hinge = Joint("pivot", JointType.REVOLUTE, "base", "rod", axis=constant([0.0, 1.0, 0.0]), armature=2e-5)
    rod = Link("rod", 0.2, constant([0.0, 0.0, -0.165]), constant(np.diag([1.755e-3, 1.755e-3, 5.1e-6])))
    first = System("first", (hinge,), (rod,))
    turned = replace(rod, inertia=constant(rod.inertia + np.diag([0.0, 2e-5, 0.0])))
    second = System("second", (replace(hinge, armature=0.0),), (turned,))
    comparison = compare(first, second)
    found = [d for d in comparison.differences if d.size > TOLERANCE]
    assert sorted(d.field for d in found) == ["armature", "inertia"]
    alone, together = costs(comparison, found)
    assert all("N·m more or less" in str(cost) for cost in alone)
    assert str(together) == "costs nothing in free motion"
