"""The steel strip that Exudyn's two kinds of beams are tried on, on a hinge and clamped."""

from __future__ import annotations

from harness.system import Beam, Joint, JointType, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link

HUB = 2e-5


def strip(thickness=0.001, modes=1, **changes):
    facts = {
        "length": 0.3,
        "direction": constant([0.0, 0.0, -1.0]),
        "bending": constant([1.0, 0.0, 0.0]),
        "mass": 7850.0 * 0.025 * thickness * 0.3,
        "bending_stiffness": 2.0e11 * 0.025 * thickness**3 / 12.0,
        "modes": modes,
        "width": 0.025,
        "thickness": thickness,
        "youngs_modulus": 2.0e11,
    }
    return Beam(**(facts | changes))


def pendulum(*, gravity=9.81, joint=JointType.REVOLUTE, armature=HUB, damping=0.0, axis=(0.0, 1.0, 0.0), **changes):
    pivot = Joint("pivot", joint, "base", "rod", axis=constant(axis), armature=armature, damping=damping)
    rod = flexible_link("rod", strip(**changes))
    return System("pendulum", (pivot,), (rod,), gravity=constant([0.0, 0.0, -gravity]))


def cantilever(**changes):
    """A horizontal strip of 2 mm, clamped at its root, and its tip's static deflection ρ g l⁴ / (8 EI) [m]."""
    system = pendulum(
        joint=JointType.FIXED,
        armature=0.0,
        direction=constant([1.0, 0.0, 0.0]),
        bending=constant([0.0, 0.0, 1.0]),
        thickness=0.002,
        **changes,
    )
    beam = system.link("rod").beam
    return system, -beam.mass / beam.length * 9.81 * beam.length**4 / (8.0 * beam.bending_stiffness)
