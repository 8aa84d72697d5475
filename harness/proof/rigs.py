"""Rigs drawn at random: what the concealed truth is built on, and the nominal model that diagnosis is given.

A rig is a planar pendulum of one or two links that hangs along -z at zero position. The truth deviates from the
nominal model by draws within the stated tolerance, as a real rig deviates from its data sheet.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import tomli_w

JOINT_NAMES = (("pivot", "elbow"), ("shoulder", "elbow"), ("hip", "knee"), ("hinge", "wrist"), ("j1", "j2"))
LINK_NAMES = (("rod", "forearm"), ("arm", "lower"), ("thigh", "shank"), ("bar", "tip"), ("upper", "outer"))
AXES = ((0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0))


@dataclass(frozen=True)
class Segment:
    """One link on its joint.

    length: to the next joint or the tip [m]; mass [kg]; com: distance of the centre of mass below the joint [m];
    inertia: about the centre of mass, transverse [kg·m²]; damping [N·m·s/rad]; armature [kg·m²].
    side: distance of the centre of mass from the link's line, along joint axis × line [m].
    """

    joint: str
    link: str
    length: float
    mass: float
    com: float
    inertia: float
    damping: float
    armature: float
    side: float = 0.0

    @property
    def inertia_about_joint(self) -> float:
        """Inertia about the joint axis, armature included [kg·m²]."""
        return self.inertia + self.mass * (self.com**2 + self.side**2) + self.armature

    @property
    def gravity_moment(self) -> float:
        """m·g·c with standard gravity [N·m], the scale of torques in the rig."""
        return self.mass * 9.81 * self.com


@dataclass(frozen=True)
class Rig:
    """A planar serial pendulum.

    tolerance: what the nominal model states of itself. stated: effects that it states, as (name, site, parameters).
    """

    segments: tuple[Segment, ...]
    axis: tuple[float, float, float]
    tolerance: float
    gravity: float = 9.81
    stated: tuple[tuple[str, str, Mapping[str, float]], ...] = ()

    @property
    def joints(self) -> tuple[str, ...]:
        return tuple(segment.joint for segment in self.segments)

    @property
    def natural_frequency(self) -> float:
        """Small-swing frequency of the first link with all that hangs on it frozen straight [Hz]."""
        moment = inertia = reach = 0.0
        for s in self.segments:
            moment += s.mass * self.gravity * (reach + s.com)
            inertia += s.inertia + s.mass * (reach + s.com) ** 2 + s.armature
            reach += s.length
        return float(np.sqrt(moment / inertia) / (2 * np.pi))

    def toml(self) -> str:
        """The rig as a model file."""
        joints, links = [], []
        for k, s in enumerate(self.segments):
            joints.append(
                {
                    "name": s.joint,
                    "type": "continuous",
                    "parent": "base" if k == 0 else self.segments[k - 1].link,
                    "child": s.link,
                    "origin": {
                        "xyz": [0.0, 0.0, 0.0 if k == 0 else -self.segments[k - 1].length],
                        "rpy": [0.0, 0.0, 0.0],
                    },
                    "axis": list(self.axis),
                    "armature": s.armature,
                    "damping": s.damping,
                }
            )
            links.append({"name": s.link, "mass": s.mass, "com": [0.0, 0.0, -s.com], "inertia": [s.inertia] * 3})
        effects = [
            {"name": name, "site": site, "parameters": dict(parameters)} for name, site, parameters in self.stated
        ]
        return tomli_w.dumps(
            {
                "name": "rig",
                "gravity": [0.0, 0.0, -self.gravity],
                "tolerance": self.tolerance,
                "joint": joints,
                "link": links,
                **({"effect": effects} if effects else {}),
            }
        )


def draw_rig(rng: np.random.Generator, joints: int) -> Rig:
    """A rig of one or two joints with random dimensions, names, axis and tolerance."""
    names = JOINT_NAMES[rng.integers(len(JOINT_NAMES))]
    links = LINK_NAMES[rng.integers(len(LINK_NAMES))]
    base_length = float(np.exp(rng.uniform(np.log(0.15), np.log(0.9))))
    base_mass = float(np.exp(rng.uniform(np.log(0.08), np.log(2.0))))
    segments = []
    for k in range(joints):
        length = base_length * float(rng.uniform(0.7, 1.3))
        rod = base_mass * float(rng.uniform(0.5, 1.5))
        bob = base_mass * float(rng.choice([0.0, rng.uniform(0.1, 2.0)]))
        mass = rod + bob
        com = (rod * length / 2 + bob * length) / mass
        inertia = rod * length**2 / 12 + rod * (com - length / 2) ** 2 + bob * (length - com) ** 2
        about_joint = inertia + mass * com**2
        rate = np.sqrt(mass * 9.81 * com / about_joint)
        # A bearing whose data sheet is known: ratio of viscous damping to critical well below one per cent.
        damping = float(rng.choice([0.0, rng.uniform(2e-4, 3e-3)])) * 2 * about_joint * float(rate)
        armature = float(rng.choice([0.0, rng.uniform(0.002, 0.03)])) * about_joint
        segments.append(Segment(names[k], links[k], length, mass, com, inertia, damping, armature))
    axis = AXES[rng.integers(len(AXES))]
    return Rig(tuple(segments), axis, tolerance=float(rng.choice([0.005, 0.01, 0.02])))


def deviate(rig: Rig, rng: np.random.Generator) -> Rig:
    """The real rig behind the nominal one: masses, lengths and inertias off by draws of the stated tolerance.

    Draws are normal with the tolerance as 1σ, cut at 2σ; damping deviates as much.
    """

    def factor() -> float:
        return 1.0 + rig.tolerance * float(np.clip(rng.normal(), -2.0, 2.0))

    segments = []
    for s in rig.segments:
        stretch, heavier = factor(), factor()
        segments.append(
            replace(
                s,
                length=s.length * stretch,
                com=s.com * stretch,
                mass=s.mass * heavier,
                inertia=s.inertia * heavier * factor(),
                damping=s.damping * factor(),
                armature=s.armature * factor(),
            )
        )
    return replace(rig, segments=tuple(segments))
