"""Frequencies from the equations against characteristic equations and published rotating beams."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from harness.denoc import Denoc
from harness.system import Beam, Joint, JointType, Link, System
from harness.system.flexible_link import flexible_link

L, RHO, EI, HUB = 0.3, 7850.0 * 0.025 * 0.001, 2.0e11 * 0.025 * 0.001**3 / 12, 2e-5


def beam_system(modes: int, joint: JointType, hub: float = 0.0, gravity: float = 0.0, **changes: object) -> System:
    beam = Beam(
        length=L,
        direction=np.array([0.0, 0.0, -1.0]),
        bending=np.array([1.0, 0.0, 0.0]),
        mass=RHO * L,
        bending_stiffness=EI,
        modes=modes,
    )
    beam = replace(beam, **changes)
    hinge = Joint("pivot", joint, "base", "rod", axis=np.array([0.0, 1.0, 0.0]), armature=hub)
    return System("beam", (hinge,), (flexible_link("rod", beam),), gravity=np.array([0.0, 0.0, -gravity]))


def to_hertz(z: float) -> float:
    return z**2 / L**2 * np.sqrt(EI / RHO) / (2 * np.pi)


def test_clamped_free_beam() -> None:
    """cos z cosh z = -1 (Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1)."""
    roots = [brentq(lambda z: np.cos(z) + 1 / np.cosh(z), a, b, xtol=1e-14) for a, b in ((1, 3), (4, 6), (7, 9))]
    found = Denoc(beam_system(3, JointType.FIXED)).frequencies()
    assert found == pytest.approx([to_hertz(z) for z in roots], rel=1e-8)
    assert found == pytest.approx([9.0598, 56.777, 158.98], rel=1e-4)


def test_hinged_beam_with_hub_inertia() -> None:
    """EI w'''(0)-free root with J ω² w' = -EI w'': z³ J/(ρl³) (1 + cos z cosh z) = sinh z cos z - cosh z sin z."""
    ratio = HUB / (RHO * L**3)

    def characteristic(z: float) -> float:
        return ratio * z**3 * (np.cos(z) + 1 / np.cosh(z)) - (np.tanh(z) * np.cos(z) - np.sin(z))

    roots = [brentq(characteristic, a, b, xtol=1e-14) for a, b in ((3.2, 4.2), (5.5, 7.2), (8.0, 9.6))]
    found = Denoc(beam_system(3, JointType.REVOLUTE, HUB)).frequencies()
    assert found == pytest.approx([to_hertz(z) for z in roots], rel=1e-7)
    assert found == pytest.approx([37.540, 103.08, 186.29], rel=1e-4)


def test_rigid_pendulum_and_springs() -> None:
    """Bare rod: √(3g/2l); a mass on a slide with a spring: √(k/m)."""
    rod = Denoc(beam_system(1, JointType.REVOLUTE, gravity=9.81).rigid())
    assert rod.frequencies() == pytest.approx([np.sqrt(3 * 9.81 / (2 * L)) / (2 * np.pi)], rel=1e-10)
    # Upside down it does not swing.
    assert rod.frequencies([np.pi]).size == 0
    slide = Joint("slide", JointType.PRISMATIC, "base", "block", stiffness=40.0, rest_position=0.3)
    spring = Denoc(System("spring", (slide,), (Link("block", 2.5),), gravity=np.zeros(3)))
    assert spring.frequencies() == pytest.approx([4.0 / (2 * np.pi)], rel=1e-12)


@pytest.mark.parametrize(
    ("spin", "flapwise"), [(2.0, 4.1373), (4.0, 5.5850), (6.0, 7.3603), (8.0, 9.2568), (10.0, 11.2023)]
)
def test_rotating_cantilever_flapwise(spin: float, flapwise: float) -> None:
    """Hub radius 0; γ = Ω T and λ = ω T with T = √(ρ l⁴ / EI) (Wright et al., J. Appl. Mech. 49 (1982) 197-202)."""
    scale = np.sqrt(RHO * L**4 / EI)
    system = beam_system(16, JointType.REVOLUTE, shapes="clamped_free")
    # The hinge turns about the bending direction: the beam flaps along the axis of rotation.
    joint = replace(system.joints[0], axis=np.array([1.0, 0.0, 0.0]))
    model = Denoc(replace(system, joints=(joint,)))
    speed = np.zeros(model.n)
    speed[0] = spin / scale
    found = 2 * np.pi * scale * model.frequencies(qd=speed)
    assert found[0] == pytest.approx(flapwise, abs=1.5e-4)


def test_rotation_without_stiffening_does_not_stiffen_flapwise() -> None:
    system = beam_system(2, JointType.REVOLUTE, shapes="clamped_free", geometric_stiffening=False)
    model = Denoc(replace(system, joints=(replace(system.joints[0], axis=np.array([1.0, 0.0, 0.0])),)))
    standing = Denoc(beam_system(2, JointType.FIXED, shapes="clamped_free")).frequencies()
    assert model.frequencies(qd=[20.0, 0.0, 0.0]) == pytest.approx(standing, rel=1e-9)
