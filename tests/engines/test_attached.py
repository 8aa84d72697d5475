"""Effects that a model file attaches and that could not act are refused in a line, by every command that reads models."""

from __future__ import annotations

from pathlib import Path

import pytest

import harness
from harness.cli.main import status_of
from harness.engines.attached import check_attached

MODEL = """
[[joint]]
name = "pivot"
type = "revolute"
parent = "base"
child = "rod"
axis = [0, 1, 0]
[[link]]
name = "rod"
mass = 0.2
com = [0, 0, -0.15]
inertia = [1.5e-3, 1.5e-3, 1e-5]
"""
STOP = ("end_stop", "pivot", "angle = {}, stiffness = 50.0, damping = 0.1")


def with_effects(folder: Path, *effects: tuple[str, str, str]) -> Path:
    path = folder / "rig.toml"
    tables = (f'[[effect]]\nname = "{n}"\nsite = "{s}"\nparameters = {{ {p} }}\n' for n, s, p in effects)
    path.write_text(MODEL + "".join(tables))
    return path


REFUSED = {
    "a joint for its channel": [("sensor_gain", "pivot", "gain = 1.1")],
    "a channel misspelt": [("sensor_offset", "pivot.positon", "offset = 0.1")],
    "an input at a link": [("actuator_gain", "rod", "gain = 1.1")],
    "two stops of a joint": [(*STOP[:2], STOP[2].format(0.5)), (*STOP[:2], STOP[2].format(-0.5))],
    "drag twice": [("quadratic_drag", "pivot", "coefficient = 0.1")] * 2,
}


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.parametrize("command", ["simulate", "validate", "view"])
def test_what_cannot_act_is_refused(tmp_path, capsys, name, command):
    path = with_effects(tmp_path, *REFUSED[name])
    assert status_of([command, str(path), "--out", str(tmp_path / "out.html")]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert str(path) in line and REFUSED[name][0][0] in line
    assert not (tmp_path / "out.html").exists()


def test_what_adds_up_or_acts_elsewhere_is_not(tmp_path):
    twice = ("viscous_damping", "pivot", "coefficient = 0.1")
    sensors = [("sensor_gain", "pivot.position", "gain = 1.1"), ("sensor_gain", "pivot.velocity", "gain = 1.1")]
    skew = ("clock_skew", "time", "factor = 1.01")
    check_attached(harness.load(with_effects(tmp_path, twice, twice, *sensors, skew)))
