"""A user's own flexible mechanism: its rigid limit in engines of rigid bodies, and what finite elements cannot express."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.cases.case import Bench, Case
from harness.cases.user_beams import comparable, straight_checks
from harness.engines.denoc_native import Native
from harness.system import Beam, Joint, JointType, Link, System
from harness.system.description import constant
from harness.system.flexible_link import flexible_link

PINOCCHIO = ("pinocchio",)


def spatial_tree() -> System:
    """A slider that bears a beam bending in both planes with a payload; a rigid arm and a second beam at its tip."""
    beam = Beam(
        length=0.4,
        direction=constant([0.0, 0.6, -0.8]),
        bending=constant([1.0, 0.0, 0.0]),
        mass=0.3,
        bending_stiffness=2.0,
        bending2=True,
        bending_stiffness2=5.0,
        modes=2,
        payload=0.05,
        modal_damping=(0.01, 0.02),
    )
    slim = replace(beam, bending2=False, modes=1, mass=0.1, payload=0.0, modal_damping=())
    tip = constant([0.0, 0.24, -0.32])
    joints = (
        Joint("rail", JointType.PRISMATIC, "base", "boom", axis=constant([0.0, 0.0, 1.0]), armature=0.1),
        Joint("wrist", JointType.REVOLUTE, "boom", "arm", xyz=tip, axis=constant([1.0, 0.0, 0.0]), friction=0.1),
        Joint("tail", JointType.REVOLUTE, "boom", "whip", xyz=tip, axis=constant([0.0, 0.8, 0.6]), damping=0.02),
    )
    arm = Link("arm", 0.2, constant([0.0, 0.1, 0.0]), constant(np.diag([3e-4, 2e-4, 4e-4])))
    return System("tree", joints, (flexible_link("boom", beam), arm, flexible_link("whip", slim)))


def rows_of(system: System, native: System):
    case = Case("tree", "tree", "its rigid limit", lambda: system, ())
    bench = Bench(case, system, {"denoc": Native().build(native)}, dict.fromkeys(PINOCCHIO, "no elastic links"))
    return [row for check in straight_checks(system) for row in check.run(bench)]


def test_held_straight_it_is_the_rigid_mechanism():
    pytest.importorskip("pinocchio")
    rows = rows_of(spatial_tree(), spatial_tree())
    assert [row.quantity for row in rows] == [
        "inverse_dynamics_straight",
        "mass_matrix_straight",
        "bias_straight",
        "gravity_straight",
    ]
    assert all(row.verdict == "pass" and row.difference < 1e-13 for row in rows)


def test_a_beam_a_millionth_too_heavy_is_caught():
    pytest.importorskip("pinocchio")
    system = spatial_tree()
    beam = system.link("boom").beam
    heavy = system.replace_link(flexible_link("boom", replace(beam, mass=beam.mass * (1.0 + 1e-6))))
    assert {row.verdict for row in rows_of(system, heavy)} == {"fail"}


def test_a_rigid_mechanism_has_nothing_to_hold_straight():
    assert straight_checks(spatial_tree().rigid()) == ()


def test_modal_damping_is_left_out_and_said():
    system, said = comparable(spatial_tree())
    assert said == "compared without the modal damping of boom"
    assert not any(any(link.beam.modal_damping) for link in system.links if link.beam is not None)
    assert comparable(system) == (system, "")


@pytest.mark.slow
def test_a_model_with_modal_damping_is_compared_all_the_same(tmp_path):
    pytest.importorskip("exudyn")
    shipped = Path(__file__).parents[2] / "models" / "toml" / "flexible_pendulum.toml"
    model = tmp_path / "damped.toml"
    model.write_text(shipped.read_text(encoding="utf-8") + "modal_damping = [0.005, 0.005]\n", encoding="utf-8")
    table = harness.validate([model], engines=["exudyn_ancf"], workers=1)
    compared = [row for row in table.rows if row.verdict != "skipped"]
    assert table.ok
    assert {row.quantity for row in compared} >= {"tip_deflection_5_modes", "joint_angle_5_modes"}
    assert all("without the modal damping of rod" in row.why_allowed for row in compared)
