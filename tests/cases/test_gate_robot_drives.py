"""What acts in single runs alone, and what closes a mechanism, belong to the robot that was accepted too."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from harness.cases.gate import read_accepted
from harness.cli.main import status_of

ARM = """<mujoco model="arm"><compiler angle="radian"/><worldbody>
<body name="p"><joint name="h" axis="0 1 0" range="-2 2" solreflimit="0.02 1"/>
<inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .001"/>
<body name="q" pos="0 0 -.4"><joint name="i" axis="0 1 0"/>
<inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .001"/></body></body>
</worldbody><equality><joint name="gear" joint1="i" joint2="h" polycoef="0 1 0.5 0 0"/></equality>
<actuator><position name="servo" joint="h" kp="10" kv="1" ctrlrange="-1 1"/></actuator>
<keyframe><key name="home" qpos="0.1 0.105" ctrl="0.1"/></keyframe></mujoco>"""

CHANGES = [
    ('kp="10"', 'kp="12"', "stiffness of actuator 'servo': 10 → 12"),
    ('ctrlrange="-1 1"', 'ctrlrange="-1 2"', "commands of actuator 'servo': [-1, 1] → [-1, 2]"),
    ('name="servo"', 'name="drive"', "actuator 'servo' is gone"),
    ('ctrl="0.1"', 'ctrl="0.2"', "command.servo of keyframe 'home': 0.1 → 0.2"),
    # 1/(d t² r²) for the time constant t = 0.02 s, the ratio r = 1 and MuJoCo's impedance d = 0.95; a quarter of it for twice t.
    ('solreflimit="0.02 1"', 'solreflimit="0.04 1"', "stiffness over inertia of stop 'h': 2631.58 → 657.895"),
    ("<worldbody>", '<option><flag limit="disable"/></option><worldbody>', "limits act: True → False"),
    ('polycoef="0 1 0.5 0 0"', 'polycoef="0 1 0.4 0 0"', "coefficients of loop 'gear': [0, 1, 0.5, 0, 0] → [0, 1, 0.4, 0, 0]"),
]  # fmt: skip


def gate(*arguments: object) -> int:
    return status_of(["gate", *map(str, arguments), "--engine", "mujoco", "--workers", "1"])


@pytest.fixture(scope="module")
def accepted(tmp_path_factory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("robot")
    robot, reference = folder / "arm.xml", folder / "arm.accepted.json"
    robot.write_text(ARM, encoding="utf-8")
    assert gate(robot, "--reference", reference, "--accept", "--new", "--why", "as delivered") == 0
    assert gate(robot, "--reference", reference) == 0
    return robot, reference


@pytest.mark.parametrize(("old", "new", "words"), CHANGES)
def test_drives_stops_keyframes_and_loops_are_held(accepted, tmp_path, old, new, words):
    assert old in ARM
    robot, answer = tmp_path / "arm.xml", tmp_path / "answer.json"
    robot.write_text(ARM.replace(old, new), encoding="utf-8")
    assert gate(robot, "--reference", accepted[1], "--json", answer) == 1
    (row,) = (row for row in json.loads(answer.read_text("utf-8"))["rows"] if row["quantity"] == "scene")
    assert not row["ok"] and words in row["note"]


def test_a_reference_of_an_earlier_version_holds_without_them(accepted, tmp_path):
    held = read_accepted(accepted[1])
    without = ("actuators", "stops", "keyframes", "loops", "limits_act")
    robots = {name: {k: v for k, v in kept.items() if k not in without} for name, kept in held.robots.items()}
    reference = tmp_path / "arm.accepted.json"
    reference.write_text(replace(held, robots=robots).to_json(), encoding="utf-8")
    assert gate(accepted[0], "--reference", reference) == 0


def test_what_a_joint_follows_is_held(tmp_path):
    """A slide across gravity that follows another: its offset moves no figure of the dynamics, and is told all the same."""
    robot, reference, answer = tmp_path / "x.toml", tmp_path / "x.accepted.json", tmp_path / "answer.json"
    joint = '[[joint]]\nname = "{0}"\ntype = "prismatic"\nparent = "base"\nchild = "{1}"\naxis = [1, 0, 0]\n'
    link = '[[link]]\nname = "{}"\nmass = 1.0\ninertia = [1.0, 1.0, 1.0]\n'
    text = joint.format("a", "p") + joint.format("b", "q") + 'mimic = {{ joint = "a", offset = {} }}\n'
    text += link.format("p") + link.format("q")
    robot.write_text(text.format(0.1), encoding="utf-8")
    assert gate(robot, "--reference", reference, "--accept", "--new", "--why", "as delivered") == 0
    robot.write_text(text.format(0.2), encoding="utf-8")
    assert gate(robot, "--reference", reference, "--json", answer) == 1
    (row,) = (row for row in json.loads(answer.read_text("utf-8"))["rows"] if not row["ok"])
    assert row["quantity"] == "frames" and "mimic of joint 'b'" in row["note"]
