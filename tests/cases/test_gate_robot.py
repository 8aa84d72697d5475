"""The gate on a robot of the user's own: whatever changes in its file closes it, and is pointed at."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from harness.cli.main import status_of
from harness.system.source_lines import line_of

ROBOT = """<robot name="arm">
  <link name="world"/>
  <link name="upper">
    <inertial>
      <origin xyz="0.1 0 0.02"/>
      <mass value="2.0"/>
      <inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <link name="fore">
    <inertial>
      <origin xyz="0.15 0 0"/>
      <mass value="1.0"/>
      <inertia ixx="0.004" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="world"/>
    <child link="upper"/>
    <origin xyz="0 0 0.5" rpy="0.1 0.2 0.3"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="50" velocity="3"/>
    <dynamics damping="0.1" friction="0.0"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/>
    <child link="fore"/>
    <origin xyz="0.3 0 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="20" velocity="3"/>
    <dynamics damping="0.05" friction="0.0"/>
  </joint>
</robot>
"""

ELBOW = '<axis xyz="0 1 0"/>\n    <limit lower="-2" upper="2" effort="20"'

# What is written for what, the row that must say so, words in it, and the line that must be pointed at.
CHANGES = [
    ('<mass value="2.0"/>', '<mass value="2.1"/>', "masses", "mass of link 'upper': 2 → 2.1", 6),
    ('<mass value="1.0"/>', '<mass value="1.0000001"/>', "masses", "mass of link 'fore'", 13),
    ('xyz="0.15 0 0"', 'xyz="0.15 0 0.001"', "centres_of_mass", "com of link 'fore'", 11),
    ('ixx="0.004"', 'ixx="0.0041"', "inertias", "inertia of link 'fore': xx 0.004 → 0.0041", 14),
    ('rpy="0.1 0.2 0.3"', 'rpy="0.3 0.2 0.1"', "frames", "(roll, pitch, yaw): [0.1, 0.2, 0.3] → [0.3, 0.2, 0.1] rad", 20),
    (ELBOW, ELBOW.replace("0 1 0", "0 -1 0"), "frames", "axis of joint 'elbow'", 29),
    ('damping="0.05"', 'damping="0.06"', "joint_laws", "damping of joint 'elbow': 0.05 → 0.06", 31),
    ('damping="0.05" friction="0.0"', 'damping="0.05" friction="0.2"', "joint_laws", "friction of joint 'elbow'", 31),
    ('effort="50"', 'effort="51"', "limits", "effort of joint 'shoulder': 50 → 51", 22),
    ('lower="-2" upper="2" effort="20"', 'lower="-2" upper="2.5" effort="20"', "limits", "upper of joint 'elbow'", 30),
    ('name="fore"', 'name="forearm"', "masses", "link 'fore' is gone", None),
]  # fmt: skip


HINGE = '<mujoco>\n<worldbody>\n<body name="rod">\n<joint name="hinge"\n range="-1 1"/>\n</body></worldbody></mujoco>'
NESTED = (
    '<mujoco>\n<worldbody>\n<body name="a">\n<body name="b">\n<inertial mass="1"/></body></body></worldbody></mujoco>'
)


def gate(*arguments: object) -> int:
    return status_of(["gate", *map(str, arguments)])


@pytest.fixture(scope="module")
def accepted(tmp_path_factory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("robot")
    robot, reference = folder / "arm.urdf", folder / "arm.accepted.json"
    robot.write_text(ROBOT, encoding="utf-8")
    options = ("--engine", "mujoco", "--workers", 1)
    assert gate(robot, "--reference", reference, "--accept", "--new", "--why", "as delivered", *options) == 0
    return robot, reference


def judged(robot: Path, reference: Path, folder: Path) -> tuple[int, dict, dict]:
    answer, sarif = folder / "answer.json", folder / "gate.sarif"
    status = gate(
        robot, "--reference", reference, "--json", answer, "--sarif", sarif, "--engine", "mujoco", "--workers", 1
    )
    return status, json.loads(answer.read_text("utf-8")), json.loads(sarif.read_text("utf-8"))


def test_the_robot_that_was_accepted_holds(accepted, tmp_path):
    robot, reference = accepted
    status, answer, sarif = judged(robot, reference, tmp_path)
    assert status == 0 and answer["ok"]
    assert sarif["runs"][0]["results"] == []
    held = {row["quantity"] for row in answer["rows"] if "recorded" in row["engines"]}
    assert {
        "masses",
        "inertias",
        "frames",
        "joint_laws",
        "limits",
        "recorded_frequencies",
        "recorded_trajectory",
    } <= held
    assert all(row["seconds"] > 0.0 for row in answer["rows"] if "recorded" not in row["engines"])


def test_two_robots_are_guarded_together(tmp_path):
    """They are two robots, and not one of which two descriptions differ: a chain of one and a tree of two."""
    arm, rod, reference = tmp_path / "arm.urdf", tmp_path / "rod.urdf", tmp_path / "both.json"
    arm.write_text(ROBOT, encoding="utf-8")
    rod.write_text((Path(__file__).parents[2] / "models" / "urdf" / "rigid_pendulum.urdf").read_text("utf-8"))
    options = ("--reference", reference, "--engine", "mujoco", "--workers", 1)
    assert gate(arm, rod, *options, "--accept", "--new", "--why", "as delivered") == 0
    assert gate(arm, rod, *options) == 0
    arm.write_text(ROBOT.replace('damping="0.05"', 'damping="0.06"'), encoding="utf-8")
    assert gate(arm, rod, *options) == 1


def test_a_robot_with_dry_friction_can_be_accepted(tmp_path):
    """MuJoCo's friction turns over two steps late, which adds up to more than a fixed step errs by."""
    robot, reference = tmp_path / "arm.urdf", tmp_path / "arm.accepted.json"
    robot.write_text(re.sub(r"<dynamics [^>]*>", '<dynamics damping="0.05" friction="0.4"/>', ROBOT), encoding="utf-8")
    assert '"0.4"' in robot.read_text()
    options = ("--engine", "mujoco", "--workers", 1)
    assert gate(robot, "--reference", reference, "--accept", "--new", "--why", "as delivered", *options) == 0
    status, answer, _ = judged(robot, reference, tmp_path)
    assert status == 0
    (run,) = (
        row for row in answer["rows"] if row["quantity"] == "recorded_trajectory" and row["engines"][0] == "mujoco"
    )
    assert run["difference"] > 1e-5 and run["allowed"] < 0.02


@pytest.mark.parametrize(("old", "new", "quantity", "words", "line"), CHANGES)
def test_every_change_of_the_robot_closes_the_gate_and_is_pointed_at(
    accepted, tmp_path, old, new, quantity, words, line
):
    assert old in ROBOT
    robot = tmp_path / "arm.urdf"
    robot.write_text(ROBOT.replace(old, new), encoding="utf-8")
    if new == 'name="forearm"':
        robot.write_text(ROBOT.replace('"fore"', '"forearm"'), encoding="utf-8")
    status, answer, sarif = judged(robot, accepted[1], tmp_path)
    assert status == 1 and not answer["ok"]
    row = next(row for row in answer["rows"] if row["quantity"] == quantity and "recorded" in row["engines"])
    assert not row["ok"] and words in row["note"]
    result = next(r for r in sarif["runs"][0]["results"] if r["ruleId"] == quantity)
    place = result["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"].endswith("arm.urdf")
    assert place.get("region", {}).get("startLine") == line


def test_dynamics_that_changed_close_the_gate_though_the_description_did_not(accepted, tmp_path):
    # As if the native engine had changed since: what was recorded of its motion is another.
    from harness.cases.gate import read_accepted

    held = read_accepted(accepted[1])
    robots = json.loads(json.dumps(dict(held.robots)))
    robots["arm"]["figures"]["acceleration"][0][1] *= 1.0 + 1e-6
    robots["arm"]["run"]["position"][-1][0] += 1e-4
    reference = tmp_path / "arm.accepted.json"
    from dataclasses import replace

    reference.write_text(replace(held, robots=robots).to_json(), encoding="utf-8")
    status, answer, _ = judged(accepted[0], reference, tmp_path)
    closed = {(row["quantity"], row["engines"][0]) for row in answer["rows"] if not row["ok"]}
    assert status == 1
    wanted = {
        (quantity, engine)
        for quantity in ("recorded_acceleration", "recorded_trajectory")
        for engine in ("denoc", "mujoco")
    }
    assert closed == wanted


def test_of_a_motion_that_changed_it_is_told_from_when_on_how_and_by_what(accepted, tmp_path):
    """As if what was recorded had jumped at half a second: the twenty samples a second are enough to say so."""
    from dataclasses import replace

    from harness.cases.gate import read_accepted

    held = read_accepted(accepted[1])
    robots = json.loads(json.dumps(dict(held.robots)))
    for sample in robots["arm"]["run"]["position"][10:]:
        sample[0] += 1e-4
    reference = tmp_path / "arm.accepted.json"
    reference.write_text(replace(held, robots=robots).to_json(), encoding="utf-8")
    _, answer, _ = judged(accepted[0], reference, tmp_path)
    rows = [row for row in answer["rows"] if row["quantity"] == "recorded_trajectory"]
    assert {row["engines"][0] for row in rows} == {"denoc", "mujoco"}
    for row in rows:
        place = {"time": 0.5, "begins": 0.5, "coordinate": "shoulder", "shape": "offset", "cause": "model"}
        assert row["first_divergence"] == place
        assert "it is the model, not the integration" in row["note"]


def test_what_reading_left_out_is_told(accepted, capsys, tmp_path):
    robot, reference = tmp_path / "arm.urdf", accepted[1]
    old = '<joint name="elbow" type="revolute">'
    robot.write_text(ROBOT.replace(old, old + '<mimic joint="nobody" multiplier="2"/>'), encoding="utf-8")
    _, answer, _ = judged(robot, reference, tmp_path)
    (told,) = (line for line in capsys.readouterr().err.splitlines() if "mimic" in line)
    assert told.startswith("denoc: note: arm: ") and "elbow" in told
    assert any("mimic" in note for note in answer["notes"])


@pytest.mark.parametrize(
    "arguments",
    [
        ["arm.urdf"],
        ["arm.urdf", "--reference", "no.json"],
        ["arm.urdf", "--reference", "no.json", "--results", "r.json"],
        ["--remove", "arm"],
        ["--self-test", "full", "--no-self-test"],
    ],
)
def test_unusable_requests_are_one_line(arguments, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(ROBOT, encoding="utf-8")
    assert gate(*arguments) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("text", "name", "value", "line"),
    [
        ('[[joint]]\nname = "hinge"\naxis = [0, 1, 0]\ndamping = 0.1\n', "hinge", "damping", 4),
        ('[[joint]]\nname = "hinge"\n[[link]]\nname = "rod"\nmass = 1\n', "rod", "mass", 5),
        ('[[link]]\nmass = 1\nname = "rod"\n', "rod", "mass", 2),
        (HINGE, "hinge", "lower", 5),
        (NESTED, "b", "mass", 5),
        (NESTED, "a", "mass", 3),
        ("<robot/>", "rod", "mass", None),
        ("<robot", "rod", "mass", None),
    ],
)  # fmt: skip
def test_lines_of_models(tmp_path, text, name, value, line):
    file = tmp_path / "model"
    file.write_text(text, encoding="utf-8")
    assert line_of(file, name, value) == line
