"""Flexible mechanisms that several cases share: strips of steel hanging straight down at zero, turning about y."""

from __future__ import annotations

import math

import numpy as np

from harness.cases.pendulums import GRAVITY, HUB, hinge
from harness.system import Beam, Joint, JointType, Link, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link

# The strip of the closed forms: 0.30 m, 25 x 1 mm of steel.
LENGTH, WIDTH, THICKNESS, YOUNG, STEEL = 0.30, 0.025, 0.001, 2.0e11, 7850.0
# The paper's flexible link as it must have been: its hammer test's 37 Hz fits 1 mm and 0.060 kg.
PAPER_MASS = 0.060
# The table as printed: 2 mm and 0.60 kg, a density of 40 000 kg/m³.
PRINTED_MASS, PRINTED_THICKNESS = 0.60, 0.002


def strip(
    name: str = "rod",
    *,
    thickness: float = THICKNESS,
    mass: float | None = None,
    modes: int = 1,
    payload: float = 0.0,
    stiffening: bool = True,
) -> Link:
    """A strip along -z that bends along x; mass is steel's if not given."""
    return flexible_link(
        name,
        Beam(
            length=LENGTH,
            direction=constant([0.0, 0.0, -1.0]),
            bending=constant([1.0, 0.0, 0.0]),
            mass=STEEL * LENGTH * WIDTH * thickness if mass is None else mass,
            bending_stiffness=YOUNG * WIDTH * thickness**3 / 12.0,
            half_depth=thickness / 2.0,
            modes=modes,
            payload=payload,
            geometric_stiffening=stiffening,
            width=WIDTH,
            thickness=thickness,
            youngs_modulus=YOUNG,
        ),
    )


def flexible_pendulum(link: Link, *, hub: float = HUB, gravity: float = GRAVITY) -> System:
    """One strip on a hinge with hub inertia."""
    return System(
        "flexible pendulum",
        (hinge("pivot", "base", link.name, armature=hub),),
        (link,),
        gravity=constant([0.0, 0.0, -gravity]),
    )


def cantilever(link: Link, *, gravity: float = 0.0) -> System:
    """One strip clamped to the base."""
    clamp = Joint("clamp", JointType.FIXED, "base", link.name)
    return System("cantilever", (clamp,), (link,), gravity=constant([0.0, 0.0, -gravity]))


def closed_form(beta_l: float, link: Link) -> float:
    """Frequency [Hz] of a root β l: (β l)² √(EI / ρ) / (2π l²), ρ the mass per length."""
    beam = link.beam
    assert beam is not None
    return beta_l**2 * math.sqrt(beam.bending_stiffness * beam.length / beam.mass) / (2.0 * math.pi * beam.length**2)


def two_strips(modes: int) -> System:
    """Two strips hinged end to end."""
    return System(
        "two flexible links",
        (hinge("shoulder", "base", "upper"), hinge("elbow", "upper", "lower", drop=LENGTH)),
        (strip("upper", modes=modes), strip("lower", modes=modes)),
        gravity=constant([0.0, 0.0, -GRAVITY]),
    )


def alternating_chain(count: int, modes: int) -> System:
    """Rigid bars and strips in turn, hinged end to end, a bar first; each 0.15 m bar weighs as its strip does."""
    length = LENGTH / 2.0
    joints: list[Joint] = []
    links: list[Link] = []
    drop = 0.0
    for k in range(count):
        parent = links[-1].name if links else "base"
        name = f"{'bar' if k % 2 == 0 else 'strip'}{k + 1}"
        joints.append(hinge(f"joint{k + 1}", parent, name, drop=drop))
        if k % 2 == 0:
            mass = STEEL * LENGTH * WIDTH * THICKNESS
            line = np.diag([1.0, 1.0, 0.0]) * mass * length**2 / 12.0
            links.append(Link(name, mass, constant([0.0, 0.0, -length / 2.0]), constant(line)))
            drop = length
        else:
            links.append(strip(name, modes=modes))
            drop = LENGTH
    return System(
        f"{count} links, rigid and flexible in turn",
        tuple(joints),
        tuple(links),
        gravity=constant([0.0, 0.0, -GRAVITY]),
    )
