"""Random mechanisms with joints of several degrees of freedom and joints that follow others."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from harness.system.description import Array, Joint, JointType, Link, Mimic, System, constant
from harness.system.lowering import neutral_position
from harness.system.manifold import integrate
from harness.system.rotation import from_quaternion


def link(name: str, rng: np.random.Generator) -> Link:
    """A body of random mass, centre and possible inertia."""
    points = rng.standard_normal((3, 6))
    spread = points @ points.T * 0.01
    return Link(
        name,
        mass=float(rng.uniform(0.5, 2.0)),
        com=constant(0.2 * rng.standard_normal(3)),
        inertia=constant(np.trace(spread) * np.eye(3) - spread),
    )


def joint(name: str, kind: JointType, parent: str, child: str, rng: np.random.Generator, **more: Any) -> Joint:
    """A joint at a random place."""
    axis, axis2 = rng.standard_normal((2, 3))
    axis /= np.linalg.norm(axis)
    axis2 = np.cross(axis, axis2)
    return Joint(
        name,
        kind,
        parent,
        child,
        xyz=constant(0.3 * rng.standard_normal(3)),
        rotation=constant(from_quaternion(rng.standard_normal(4))),
        axis=constant(axis),
        axis2=constant(axis2 / np.linalg.norm(axis2)),
        **more,
    )


def in_space(seed: int = 1) -> System:
    """A free body that carries a ball, a planar and a universal joint, and a revolute one with spring and armature."""
    rng = np.random.default_rng(seed)
    joints = (
        Joint("root", JointType.FREE, "base", "a", armature=0.1),
        joint("hip", JointType.BALL, "a", "b", rng, armature=0.3, damping=0.2),
        joint("knee", JointType.REVOLUTE, "b", "c", rng, stiffness=3.0, rest_position=0.2, armature=0.05),
        joint("table", JointType.PLANAR, "a", "d", rng, damping=0.1),
        joint("cardan", JointType.UNIVERSAL, "d", "e", rng),
    )
    return System("in space", joints, tuple(link(name, rng) for name in "abcde"))


def following(seed: int = 2) -> System:
    """A ball that carries a helical joint, and joints that follow others, one before what it follows."""
    rng = np.random.default_rng(seed)
    joints = (
        joint("ball", JointType.BALL, "base", "a", rng),
        joint("screw", JointType.HELICAL, "a", "b", rng, pitch=0.1, damping=0.3, armature=0.02),
        joint("finger", JointType.PRISMATIC, "a", "c", rng, mimic=Mimic("thumb", -0.5, 0.2)),
        joint("thumb", JointType.REVOLUTE, "b", "d", rng, armature=0.1),
        joint("tip", JointType.HELICAL, "d", "e", rng, pitch=0.3, mimic=Mimic("finger", 2.0, -0.1)),
    )
    return System("following", joints, tuple(link(name, rng) for name in "abcde"))


def floating_tree(seed: int = 14) -> System:
    """A damped free body, placed askew, with branches of hinges and slides, springs and armature among them."""
    rng = np.random.default_rng(seed)
    hinge, slide = JointType.REVOLUTE, JointType.PRISMATIC
    joints = (
        joint("root", JointType.FREE, "base", "a", rng, damping=0.3),
        joint("hip", hinge, "a", "b", rng, armature=0.05, damping=0.1),
        joint("knee", hinge, "b", "c", rng, stiffness=3.0, rest_position=0.2),
        joint("shoulder", slide, "a", "d", rng, armature=0.2),
        joint("mount", JointType.FIXED, "a", "e", rng),
        joint("elbow", hinge, "e", "f", rng),
        joint("grip", slide, "d", "g", rng, damping=0.2),
    )
    return System("floating tree", joints, tuple(link(name, rng) for name in "abcdefg"))


def free_of_a_link(seed: int = 12) -> System:
    """A free joint between two moving links, which MuJoCo's own free joint is not."""
    rng = np.random.default_rng(seed)
    joints = (
        joint("hinge", JointType.REVOLUTE, "base", "a", rng),
        joint("loose", JointType.FREE, "a", "b", rng),
        joint("slide", JointType.PRISMATIC, "b", "c", rng),
    )
    return System("loose", joints, tuple(link(name, rng) for name in "abc"))


def spinning_freely(system: System) -> System:
    """The system without the armature that resists the spin of a joint that turns in space."""
    joints = tuple(replace(one, armature=0.0) if one.turns_in_space else one for one in system.joints)
    return replace(system, joints=joints)


def random_position(system: System, rng: np.random.Generator) -> Array:
    """Positions (nq,) away from the neutral ones, quaternions unit."""
    return integrate(system, neutral_position(system), rng.standard_normal(system.nv))
