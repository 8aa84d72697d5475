"""The full self-test's faults: enough of them, over everything, each still where its patch looks for it."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.cases.discover import built_in
from harness.cases.gate.planted.blamed import Blamed, places, terms
from harness.cases.gate.planted.copy import PACKAGE, spoiled_copy
from harness.cases.gate.planted.full import Fault, faults, try_fault
from harness.cases.gate.planted.patch import expected
from harness.cases.gate.planted.patches import PATCHES


def test_there_are_enough_and_each_has_a_name_of_its_own():
    names = [fault.name for fault in faults()]
    assert len(names) >= 150
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.name)
def test_every_patch_finds_its_line_once(patch):
    hits = [path.read_text("utf-8").count(patch.old) for path in PACKAGE.rglob(patch.file)]
    assert sum(hits) == 1
    assert patch.old != patch.new
    assert set(patch.cases) <= set(built_in())


def test_a_copy_is_wrong_in_one_file_and_keeps_what_is_compiled_of_the_others(tmp_path):
    patch = next(patch for patch in PATCHES if patch.file == "laws.py")
    place = spoiled_copy(patch, tmp_path)
    changed = [
        path for path in (place / "harness").rglob("*.py")
        if path.read_bytes() != (PACKAGE / path.relative_to(place / "harness")).read_bytes()
    ]  # fmt: skip
    assert [path.name for path in changed] == ["laws.py"]
    kept = {path.name.split("-")[0].split(".")[0] for path in Path(place).rglob("*.nbi")}
    assert not kept & {"lanes_integrate", "lanes_address", "batch_kernels"}
    there = {path.name.split("-")[0].split(".")[0] for path in PACKAGE.rglob("*.nbi")}
    assert ("rigid" in kept) == ("rigid" in there)


def test_a_copy_leaves_the_checkouts_kernels_alone_and_keeps_its_own(tmp_path):
    from harness.denoc.compiling.compiled import STAMP, versions_of

    stamps = list(PACKAGE.rglob(STAMP))
    before = [stamp.read_text() for stamp in stamps]
    place = spoiled_copy(next(patch for patch in PATCHES if patch.file == "beam/integrals.py"), tmp_path)
    copied = list((place / "harness").rglob(STAMP))
    assert len(copied) == len(stamps)
    # No kernel is made of the integrals, which are plain Python: all that were kept are kept.
    kept, there = (sorted(path.name for path in root.rglob("*.nbi")) for root in (place / "harness", PACKAGE))
    assert kept == there
    for stamp in copied:
        assert stamp.read_text() == versions_of(place / "harness" / "denoc")
        # What a run writes there must not reach the checkout through a link.
        stamp.write_text("another")
    assert [stamp.read_text() for stamp in stamps] == before


@pytest.mark.parametrize("name", ["tree: mass of link 'link3'", "chain: rotation of joint 'joint2'", "clean 3"])
def test_a_fault_closes_the_gate_and_is_named_and_none_leaves_it_open(name):
    fault = Fault(name, seed=3) if name.startswith("clean") else next(f for f in faults() if f.name == name)
    fate = try_fault(fault)
    assert (fate.closed, fate.named) == ((False, False) if name.startswith("clean") else (True, True)), fate.said


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["rotation.py: roll, pitch and yaw in the other order", "lanes/model.py: armature forgotten"]
)
def test_a_fault_in_the_code_closes_the_gate_and_is_named(name):
    fate = try_fault(next(fault for fault in faults() if fault.name == name))
    assert fate.closed and fate.named, fate.said


@pytest.mark.parametrize("patch", PATCHES, ids=lambda patch: patch.name)
def test_what_must_be_blamed_is_a_term_and_a_place_or_none(patch):
    assert patch.expected.rows and all(patch.expected.rows)
    assert patch.expected.terms and all(patch.expected.terms)
    assert all(patch.expected.places)


def row(key, **where):
    return Blamed(key, terms(where), places(where), "")


def test_a_fault_is_named_by_its_term_and_its_place_in_most_of_the_rows_it_is_looked_for_in():
    hinge = expected("acceleration; damping @ joint2|joint3")
    right = row("case/acceleration/denoc+mujoco", term="damping", at="joint2", coordinate="joint7")
    elsewhere = row("case/acceleration/denoc+pinocchio", term="damping", at="joint7", coordinate="joint2")
    other = row("case/acceleration/denoc+exudyn", term="gravity", at="joint2")
    assert hinge.met([right])
    assert not hinge.met([elsewhere]) and not hinge.met([other])
    # A row that says nothing speaks for nobody; one of another quantity is not asked.
    assert hinge.met([right, row("case/acceleration/denoc+exudyn"), row("case/gravity/denoc+mujoco", term="gravity")])
    assert not hinge.met([right, other])
    assert not hinge.met([])


def test_a_fault_that_is_at_no_joint_is_named_by_its_term_alone():
    assert expected("rk4_error; position_rates @ -").met([row("c/rk4_error/denoc", term="position_rates", at="pivot")])


def test_several_numbers_that_do_the_same_are_all_named_and_a_coordinate_is_of_its_link():
    where = {"link": "rod", "value": "mass", "or": "payload, bending_stiffness", "mode": 2}
    assert terms(where) == ("mass", "payload", "bending_stiffness")
    assert places({"at": "rod.mode1"}) == ("rod.mode1", "rod")
