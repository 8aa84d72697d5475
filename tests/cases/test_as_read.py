"""A user's file is read once more by Pinocchio and MuJoCo themselves; what they read otherwise is named."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import harness
from harness.cases.case import Bench, Row
from harness.cases.checks import as_read
from harness.cases.checks.as_read import AsRead, told
from harness.cases.run import Task, run_task
from harness.cases.users import case_of
from harness.cli.validate import validate
from harness.compare.readings import differences
from harness.engines.readers import placed_bodies, read_by
from harness.engines.registry import engine
from harness.system import random_chain, random_tree, write
from harness.system.description import constant

QUATERNIONS = """<robot name="q" version="1.1"><link name="base"/>
<link name="arm"><inertial><origin xyz="0.2 0 0" quat_xyzw="0 0 0.7071067811865476 0.7071067811865476"/><mass value="1.5"/>
<inertia ixx="0.002" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.021"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/>
<origin xyz="0 0 0.1" quat_xyzw="0.7071067811865476 0 0 0.7071067811865476"/><axis xyz="0 1 1"/>
<limit lower="-2" upper="2" effort="5" velocity="5"/></joint></robot>"""
TWO_ROOTS = """<mujoco><worldbody><body name="p"><joint name="h" axis="0 1 0"/><geom size=".1" pos="0 0 -.2"/></body>
<body name="q" pos="0 1 0"><joint name="i" axis="0 1 0"/><geom size=".1" pos="0 0 -.2"/></body></worldbody></mujoco>"""


def file(folder: Path, text: str, name: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path


def rows_of(path: Path, system: harness.System | None = None) -> list[Row]:
    case = case_of("model", path)
    system = system or case.system()
    bench = Bench(case, system, {"denoc": engine("denoc").build(system)})
    return [row for row in AsRead(path).run(bench) if isinstance(row, Row)]


@pytest.mark.parametrize("ending", ["urdf", "xml"])
def test_readers_agree_on_random_mechanisms(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"tree.{ending}"
    draw = random_tree if ending == "urdf" else random_chain  # Pinocchio keeps one root body of an MJCF
    write(draw(7, seed=5, fixed=0.3, damping=True), path)
    rows = rows_of(path)
    assert {row.engines[-1] for row in rows} == {"pinocchio", "mujoco"}
    own = "pinocchio" if ending == "urdf" else "mujoco"
    assert [row.verdict for row in rows if row.engines[-1] == own] == ["pass"] * 4
    assert [row.verdict for row in rows if row.engines[-1] != own] == ["pass"] * 4


FLOATING = """<mujoco><compiler angle="degree"/><worldbody><body name="trunk" pos="0.3 0 0.7" euler="10 20 30">
<freejoint name="root"/><inertial pos="0.02 0.01 0" mass="4" fullinertia="0.05 0.07 0.06 0.002 0.001 -0.003"/>
<body name="arm" pos="0.2 0.05 0" euler="0 40 10"><joint name="shoulder" type="ball" pos="0 0.01 0.02"/>
<inertial pos="0 0.02 -0.2" mass="0.7" fullinertia="0.011 0.012 0.003 0.0004 0.0002 0.0001"/>
<body name="fore" pos="0.1 0.02 -0.3"><joint name="elbow" axis="0 1 0.2" pos="0.01 0 0"/>
<inertial pos="0 0.01 -0.1" mass="0.3" fullinertia="0.004 0.005 0.002 0.0002 0.0001 0"/></body></body></body>
</worldbody></mujoco>"""


def test_floating_bodies_and_balls_are_read_again_too(tmp_path: Path) -> None:
    path = file(tmp_path, FLOATING, "floating.xml")
    rows = rows_of(path)
    assert [(row.engines[-1], row.verdict) for row in rows] == [("mujoco", "pass")] * 4 + [("pinocchio", "pass")] * 4
    assert max(row.difference or 0.0 for row in rows) < 1e-12


def test_a_ball_that_is_elsewhere_fails_and_is_named(tmp_path: Path) -> None:
    path = file(tmp_path, FLOATING, "floating.xml")
    system = harness.load(path)
    ball = system.joint("shoulder")
    moved = system.replace_joint(replace(ball, xyz=constant(np.asarray(ball.xyz) + np.array([0.0, 0.0, 1e-3]))))
    failed = [row for row in rows_of(path, moved) if row.verdict == "fail"]
    assert failed and all("joint 'shoulder': origin" in row.note for row in failed)


def test_a_root_that_is_asked_to_float_is_read_so(tmp_path: Path) -> None:
    path = tmp_path / "tree.urdf"
    write(random_tree(6, seed=8, damping=True), path)
    case = case_of("model", path, floating=True)
    system = case.system()
    assert (system.nq, system.nv) == (13, 12)
    bench = Bench(case, system, {"denoc": engine("denoc").build(system)})
    rows = [row for row in AsRead(path).run(bench) if isinstance(row, Row)]
    assert [row.verdict for row in rows if row.engines[-1] == "pinocchio"] == ["pass"] * 4


def test_a_misreading_fails_and_names_the_joint(tmp_path: Path) -> None:
    """Our own former reading of this file, its quaternions passed over: the file's own reader says otherwise."""
    path = file(tmp_path, QUATERNIONS, "quat.urdf")
    old = harness.load(file(tmp_path, QUATERNIONS.replace(' version="1.1"', ""), "old.urdf"))
    rows = rows_of(path, old)
    failed = [row for row in rows if row.verdict == "fail"]
    assert {row.engines for row in failed} == {("denoc", "pinocchio")}
    assert any("joint 'j': axis" in row.note for row in failed)


def test_what_a_foreign_reader_makes_of_it_is_told_and_does_not_fail(tmp_path: Path) -> None:
    rows = rows_of(file(tmp_path, QUATERNIONS, "quat.urdf"))
    assert not [row for row in rows if row.verdict == "fail"]
    (note,) = told(rows)
    assert "as read by mujoco" in note
    assert "joint 'j': axis (0, 0.7071, 0.7071) for (0, -0.7071, 0.7071) here" in note


def test_joints_that_a_reader_passes_over_are_named(tmp_path: Path) -> None:
    """Pinocchio's reader of MJCF keeps one of several bodies on the world."""
    (note,) = told(rows_of(file(tmp_path, TWO_ROOTS, "two.xml")))
    assert "passes over joint 'i'" in note


def test_a_wrong_number_of_a_joint_is_named(tmp_path: Path) -> None:
    path = tmp_path / "tree.urdf"
    write(random_tree(3, seed=2, damping=True), path)
    system = harness.load(path)
    joint = system.joints[1]
    failed = [r for r in rows_of(path, system.replace_joint(replace(joint, damping=0.5))) if r.verdict == "fail"]
    assert {row.quantity for row in failed} == {"joint_fields_as_read"}
    assert f"joint {joint.name!r}: damping {joint.damping:.6g} for 0.5 here" in failed[0].note


@pytest.mark.parametrize("field", ["mass", "com", "inertia"])
def test_the_body_and_field_are_named(tmp_path: Path, field: str) -> None:
    path = tmp_path / "tree.urdf"
    write(random_tree(4, seed=3, prismatic=0.0), path)
    system = harness.load(path)
    link = system.links[2]
    value = getattr(link, field)
    changed = replace(link, **{field: value * 1.001 if field == "mass" else constant(np.asarray(value) * 1.001)})
    theirs = read_by("pinocchio", path, system).placed()
    found = differences(placed_bodies(system.replace_link(changed)), theirs)
    words = {"com": "centre of mass"}.get(field, field)
    assert len(found) == 1
    assert found[0].words.startswith(f"body {link.name!r}: {words}")
    assert found[0].place == {"link": link.name, "value": field}


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda inertia: np.diag(np.diag(inertia)), "products of inertia"),
        # Two of three with the other sign is the same body turned by half a turn; one of them alone is another body.
        (lambda inertia: inertia * [[1, 1, 1], [1, 1, -1], [1, -1, 1]], "products of inertia"),
        (lambda inertia: inertia * [[1, -1, -1], [-1, 1, 1], [-1, 1, 1]], "axes of inertia"),
        (lambda inertia: inertia + np.diag([1e-3, 0.0, 0.0]), "inertia, most in"),
    ],
)
def test_what_of_an_inertia_is_read_otherwise_is_told_in_whatever_axes(tmp_path: Path, spoil, words: str) -> None:
    path = tmp_path / "tree.urdf"
    system = random_tree(4, seed=3, prismatic=0.0)
    link = system.links[2]
    own = np.array([[0.03, 0.004, -0.003], [0.004, 0.04, 0.002], [-0.003, 0.002, 0.05]])
    write(system.replace_link(replace(link, inertia=constant(own))), path)
    system = harness.load(path)
    misread = system.replace_link(
        replace(system.link(link.name), inertia=constant(np.asarray(spoil(own), dtype=float)))
    )
    (found,) = differences(placed_bodies(misread), read_by("pinocchio", path, system).placed())
    assert found.words.startswith(f"body {link.name!r}: {words}")


def test_a_limit_that_is_lost_is_told(tmp_path: Path) -> None:
    path = tmp_path / "tree.urdf"
    system = random_tree(3, seed=2)
    joint = replace(system.joints[1], lower=-1.0, upper=2.0)
    write(system.replace_joint(joint), path)
    system = harness.load(path)
    lost = system.replace_joint(replace(system.joint(joint.name), lower=-np.inf))
    failed = [row for row in rows_of(path, lost) if row.verdict == "fail"]
    assert failed and {row.quantity for row in failed} == {"joint_fields_as_read"}
    assert f"joint {joint.name!r}: lower -1 for -inf here" in failed[0].note
    assert failed[0].first_divergence == {"joint": joint.name, "value": "lower"}


def test_notes_reach_the_user_in_every_way(tmp_path: Path) -> None:
    path = file(tmp_path, TWO_ROOTS.replace("<worldbody>", '<option density="1.2"/><worldbody>'), "two.xml")
    result = CliRunner().invoke(
        validate,
        [str(path), "--engine", "pinocchio", "--workers", "1", "--out", str(tmp_path / "out"), "--json", "-"],
        standalone_mode=False,
    )
    assert result.exception is None
    notes = json.loads(result.stdout)["notes"]
    for words in ("fluid", "passes over joint 'i'"):
        assert any(words in note for note in notes)
        assert sum("denoc: note: two: " in line and words in line for line in result.stderr.splitlines()) == 1
        for name in ("report.html", "results.md", "junit.xml", "results.json"):
            assert words.split("'")[0] in (tmp_path / "out" / name).read_text(), name


def test_notes_survive_saving(tmp_path: Path) -> None:
    from harness.cases.results import from_dict
    from harness.cases.run import run

    path = file(tmp_path, TWO_ROOTS, "two.xml")
    results = run([Task("two", ("denoc",), path)], workers=1)
    assert from_dict(results.to_json()).notes == results.notes
    assert run_task(Task("two", ("denoc",), path)).notes == results.notes["two"]


def test_one_reader_missing_is_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from harness.errors import EngineUnavailableError

    def missing(name: str, *_: object, **__: object) -> object:
        raise EngineUnavailableError(f"{name} is not installed")

    monkeypatch.setattr(as_read, "read_by", missing)
    rows = rows_of(file(tmp_path, QUATERNIONS, "quat.urdf"))
    assert [row.verdict for row in rows] == ["skipped", "skipped"]
