"""Joints that follow others and move are diagnosed; the truth is the gears' one equation of motion, integrated by SciPy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness import diagnose
from harness.diagnose.problem.acting import coupled
from harness.errors import UnsupportedError
from harness.recording import Channel, Recording
from harness.system import Coupling, System, load
from harness.system.lowering import freed

RATIO, OFFSET, GRAVITY = -2.0, 0.1, 9.81
# Mass, distance of its centre from the axis, and inertia about the centre: of an arm, and of a wheel that is out of balance.
ARM, WHEEL = (0.5, 0.2, 0.004), (0.3, 0.03, 0.0006)
LINK = """<link name="{name}"><inertial><origin xyz="0 0 -{distance}"/><mass value="{mass}"/>
<inertia ixx="{inertia}" ixy="0" ixz="0" iyy="{inertia}" iyz="0" izz="{inertia}"/></inertial></link>"""
URDF = """<robot name="gears"><link name="base"/>{links}
<joint name="driver" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
<joint name="driven" type="continuous"><parent link="base"/><child link="wheel"/><origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
<mimic joint="driver" multiplier="{ratio}" offset="{offset}"/></joint></robot>"""
ASKED = ("viscous_damping", "coulomb_friction", "added_inertia", "payload_mass", "sensor_gain", "transmission_ratio")


@pytest.fixture
def gears(tmp_path: Path) -> System:
    links = "".join(
        LINK.format(name=name, mass=mass, distance=distance, inertia=inertia)
        for name, (mass, distance, inertia) in (("arm", ARM), ("wheel", WHEEL))
    )
    file = tmp_path / "gears.urdf"
    file.write_text(URDF.format(links=links, ratio=RATIO, offset=OFFSET))
    return load(file)


def swings(*, both: bool = False, damping: float = 0.0, ratio: float = RATIO, noise: float = 5e-4) -> list[Recording]:
    """Three releases of the gears; damping: of the wheel's joint [N·m·s/rad]."""
    (m1, l1, i1), (m2, l2, i2) = ARM, WHEEL
    inertia = m1 * l1**2 + i1 + ratio**2 * (m2 * l2**2 + i2)

    def rates(_: float, x: np.ndarray) -> list[float]:
        weight = m1 * l1 * np.sin(x[0]) + ratio * m2 * l2 * np.sin(ratio * x[0] + OFFSET)
        return [x[1], (-GRAVITY * weight - ratio**2 * damping * x[1]) / inertia]

    time = np.arange(500) * 0.01
    out = []
    for k, start in enumerate((1.2, 0.8, 1.0)):
        q = solve_ivp(rates, (0.0, time[-1]), [start, 0.0], t_eval=time, rtol=1e-10, atol=1e-12).y[0]
        rng = np.random.default_rng(k)
        courses = {"driver": q} | ({"driven": ratio * q + OFFSET} if both else {})
        channels = tuple(
            Channel(f"{name}.position", name, "position", "rad", course + noise * rng.standard_normal(len(q)))
            for name, course in courses.items()
        )
        out.append(Recording(f"run{k}", f"run{k}", time, channels))
    return out


def test_gears_that_are_as_modelled_lack_nothing(gears: System) -> None:
    found = diagnose(swings(both=True), gears, only=ASKED)
    assert found.verdict == "consistent"
    assert not found.findings


def test_damping_of_a_joint_that_follows_is_a_class_with_its_leader(gears: System) -> None:
    """A constant ratio makes r² times the damping at the leader the same motion."""
    found = diagnose(swings(damping=0.002), gears, only=ASKED)
    assert found.verdict == "explained"
    (finding,) = found.findings
    assert finding["effect"] == "viscous_damping"
    (other,) = finding["indistinguishable_from"]
    assert {f"viscous_damping@{finding['site']}", other} == {"viscous_damping@driver", "viscous_damping@driven"}
    low, high = finding["parameters"]["coefficient"]["ci95"]
    assert low <= 0.002 * (1.0 if finding["site"] == "driven" else RATIO**2) <= high


@pytest.mark.parametrize("both", [False, True])
def test_a_wrong_ratio_is_told_as_one(gears: System, both: bool) -> None:
    found = diagnose(swings(both=both, ratio=1.03 * RATIO), gears, only=ASKED)
    assert found.verdict == "explained"
    assert [f"{f['effect']}@{f['site']}" for f in found.findings] == ["transmission_ratio@driven"]
    low, high = found.findings[0]["parameters"]["factor"]["ci95"]
    assert low <= 1.03 <= high


def test_efforts_are_not_fitted_to_gears(gears: System) -> None:
    with pytest.raises(UnsupportedError, match="none of which follows another"):
        diagnose(swings(), gears, fit_effort=True)


def test_what_follows_is_a_coupling_where_it_moves(gears: System) -> None:
    whole, (kept, *_) = coupled(gears, freed(gears), swings(both=True))
    (coupling,) = whole.loops
    assert isinstance(coupling, Coupling)
    assert (coupling.joint, coupling.leader) == ("driven", "driver")
    assert coupling.coefficients == (OFFSET, RATIO, 0.0, 0.0, 0.0)
    assert kept.channel_names == ("driver.position", "driven.position")
