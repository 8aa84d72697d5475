"""Tolerances of single quantities: read, written, given on the command line, and what they let a diagnosis do."""

from __future__ import annotations

import numpy as np
import pytest

from harness.diagnose.problem.hypothesis import bent_by, nominal_quantities
from harness.diagnose.problem.tolerances import told, with_tolerances
from harness.errors import InputError
from harness.system.read_toml import read_toml
from harness.system.write_toml import to_toml
from harness.system.write_urdf import to_urdf

MODEL = """
name = "servo"
tolerance = 0.01
[[joint]]
name = "servo"
type = "revolute"
parent = "base"
child = "arm"
axis = [0, 1, 0]
armature = 0.009
tolerance = { armature = 0.2 }
[[link]]
name = "arm"
mass = 0.8
com = [0, 0, -0.1]
tolerance = { mass = 0.001 }
"""


def test_read_and_written_back() -> None:
    system = read_toml(MODEL)
    assert {q.key: q.tolerance for q in nominal_quantities(system)} == {
        "armature@servo": 0.2, "mass@arm": 0.001, "length@arm": 0.01,
    }  # fmt: skip
    text, left_out = to_toml(system)
    again = read_toml(text)
    assert left_out == ()
    assert again.tolerances == system.tolerances
    _, left_out = to_urdf(system)
    assert "tolerance 0.2 of armature@servo" in left_out


def test_a_deviation_of_one_sigma_is_that_quantity_s_own_share() -> None:
    found = bent_by(nominal_quantities(read_toml(MODEL)), np.array([1.0, -2.0, 0.0]))
    assert found == pytest.approx([np.exp(0.2), np.exp(-0.002), 1.0])


def test_given_by_who_asks() -> None:
    system = read_toml(MODEL)
    assert told(["0.02"]) == {"*": 0.02}["*"]
    given = told(["0.02", "servo.armature=0.3"])
    assert given is not None
    own = with_tolerances(system, given)
    assert {q.key: q.tolerance for q in nominal_quantities(own)} == {
        "armature@servo": 0.3, "mass@arm": 0.001, "length@arm": 0.02,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("line", "instead", "said"),
    [
        ("tolerance = { armature = 0.2 }", "tolerance = { armatur = 0.2 }", "armature"),
        ("tolerance = { armature = 0.2 }", "tolerance = { armature = 1.5 }", "between 0 and 1"),
        ("tolerance = { mass = 0.001 }", "tolerance = { stiffness = 0.1 }", "inertia, length, mass"),
    ],
)
def test_what_is_none_is_one_line_at_its_place(line: str, instead: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        read_toml(MODEL.replace(line, instead))
    assert caught.value.line == 1 + MODEL.splitlines().index(line)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["servo.armature=fifth"], "is no number"),
        (["servo.damping=0.2"], "states no such quantity, or states it as nothing"),
        (["2"], "not between 0 and 1"),
    ],
)
def test_what_cannot_be_given(words: list[str], said: str) -> None:
    with pytest.raises(InputError, match=said):
        given = told(words)
        assert given is not None
        with_tolerances(read_toml(MODEL), given)
