"""Mechanisms that several cases share: pendulums, hanging straight down at zero."""

from __future__ import annotations

import math

import numpy as np

from harness.system import Joint, JointType, Link, System
from harness.system.description import constant
from harness.system.inertia import combine

# Table 1 of the paper, with the hub inertia's exponent mended (2e-5; 2e5 kg·m² is printed).
LENGTH, MASS, PAYLOAD, HUB = 0.30, 0.180, 0.020, 2e-5
GRAVITY = 9.81


def bar(name: str, length: float, mass: float, payload: float = 0.0) -> Link:
    """A slender uniform bar along -z from its joint, with a point mass at its tip."""
    line = np.diag([1.0, 1.0, 0.0]) * mass * length**2 / 12.0
    total, com, inertia = combine(
        (mass, np.array([0.0, 0.0, -length / 2.0]), line), (payload, np.array([0.0, 0.0, -length]), np.zeros((3, 3)))
    )
    return Link(name, total, constant(com), constant(inertia))


def hinge(name: str, parent: str, child: str, drop: float = 0.0, armature: float = 0.0, damping: float = 0.0) -> Joint:
    """A hinge about y, ``drop`` below the parent's origin."""
    return Joint(
        name,
        JointType.REVOLUTE,
        parent,
        child,
        xyz=constant([0.0, 0.0, -drop]),
        axis=constant([0.0, 1.0, 0.0]),
        armature=armature,
        damping=damping,
    )


def paper_pendulum(damping: float = 0.0) -> System:
    """The paper's rigid pendulum: 0.30 m, 0.180 kg and 0.020 kg at the tip, hub inertia 2e-5 kg·m²."""
    return System(
        "rigid pendulum",
        (hinge("pivot", "base", "rod", armature=HUB, damping=damping),),
        (bar("rod", LENGTH, MASS, PAYLOAD),),
        gravity=constant([0.0, 0.0, -GRAVITY]),
    )


def paper_small_frequency() -> float:
    """Frequency of vanishing swings [Hz]: √((ρl²/2 + m_p l) g / (ρl³/3 + m_p l² + I_h)) / 2π."""
    return math.sqrt(paper_restoring() / paper_inertia()) / (2.0 * math.pi)


def paper_inertia() -> float:
    """ρl³/3 + m_p l² + I_h [kg·m²], the paper's equation (7), corrected."""
    return MASS * LENGTH**2 / 3.0 + PAYLOAD * LENGTH**2 + HUB


def paper_restoring() -> float:
    """(ρl²/2 + m_p l) g [N·m]."""
    return (MASS * LENGTH / 2.0 + PAYLOAD * LENGTH) * GRAVITY


def chain_of_bars(name: str, joints: tuple[str, ...], length: float = 0.30, mass: float = 0.180) -> System:
    """Equal bars hinged end to end."""
    links = tuple(bar(f"rod{k + 1}", length, mass) for k in range(len(joints)))
    parents = ("base", *(link.name for link in links[:-1]))
    hinges = tuple(
        hinge(joint, parent, link.name, drop=0.0 if parent == "base" else length)
        for joint, parent, link in zip(joints, parents, links, strict=True)
    )
    return System(name, hinges, links, gravity=constant([0.0, 0.0, -GRAVITY]))
