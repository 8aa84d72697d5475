"""Models with loops from end to end: read, refused in one line, written back, simulated, compared."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.cli.main import status_of
from harness.errors import UnsupportedError
from harness.system import write
from harness.system.closure import closed_position, opening

FOUR_BAR = """name = "four-bar"

[[joint]]
name = "a"
type = "revolute"
parent = "base"
child = "crank"
axis = [0, 1, 0]

[[joint]]
name = "b"
type = "revolute"
parent = "crank"
child = "coupler"
origin = { xyz = [0.1, 0, 0] }
axis = [0, 1, 0]

[[joint]]
name = "d"
type = "revolute"
parent = "base"
child = "rocker"
origin = { xyz = [0.3, 0, 0] }
axis = [0, 1, 0]

[[link]]
name = "crank"
mass = 0.1
com = [0.05, 0, 0]
inertia = [1e-6, 1e-4, 1e-4]

[[link]]
name = "coupler"
mass = 0.3
com = [0.15, 0, 0]
inertia = [1e-6, 2.25e-3, 2.25e-3]

[[link]]
name = "rocker"
mass = 0.2
com = [0, 0, 0.1]
inertia = [6e-4, 6e-4, 1e-6]
"""
PIN = """
[[loop]]
name = "pin"
first = { link = "coupler", xyz = [0.3, 0, 0] }
second = { link = "rocker", xyz = [0, 0, 0.2] }
closed = ["x", "z"]
"""
GEAR = """
[[coupling]]
name = "gear"
joint = "d"
leader = "a"
polynomial = [0.1, 0.5]
"""


@pytest.fixture
def four_bar(tmp_path: Path) -> Path:
    file = tmp_path / "four_bar.toml"
    file.write_text(FOUR_BAR + PIN)
    return file


def columns(file: Path) -> dict[str, np.ndarray]:
    rows = list(csv.reader(file.open()))
    return dict(zip(rows[0], np.array(rows[1:], dtype=float).T, strict=True))


def test_simulate_holds_what_is_given_and_closes_the_rest(
    four_bar: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run.csv"
    asked = ["simulate", str(four_bar), "--duration", "1", "--rate", "100", "--position", "a=0.5", "--out", str(out)]
    assert status_of([*asked, "--velocity", "a=3"]) == 0
    assert "the loops are closed at b = " in " ".join(capsys.readouterr().err.split())
    run = columns(out)
    assert run["a.position"][0] == 0.5 and run["a.velocity"][0] == pytest.approx(3.0, rel=1e-14)
    system = harness.load(four_bar)
    course = np.array([run[f"{name}.position"] for name in system.position_names]).T
    assert max(np.abs(opening(system, q).value).max() for q in course) < 1e-12


def test_validate_compares_closed_states(four_bar: Path, tmp_path: Path) -> None:
    found = tmp_path / "rows.json"
    assert status_of(["validate", str(four_bar), "--workers", "1", "--json", str(found)]) == 0
    rows = json.loads(found.read_text())["rows"]
    compared = {tuple(row["engines"]) for row in rows if row["quantity"] == "acceleration" and row["verdict"] == "pass"}
    assert compared == {("denoc", "pinocchio"), ("denoc", "mujoco")}


@pytest.mark.parametrize("ending", ["toml", "xml"])
def test_loops_are_written_and_read_again(four_bar: Path, tmp_path: Path, ending: str) -> None:
    four_bar.write_text(
        FOUR_BAR
        + PIN.replace('rocker", xyz', 'rocker", rpy = [0.1, 0.2, 0.3], xyz').replace(
            'first = { link = "coupler",', 'first = { link = "coupler", rpy = [0.0, 0.7, 0.0],'
        )
    )
    system = harness.load(four_bar)
    again = tmp_path / f"again.{ending}"
    assert write(system, again) == ()
    other = harness.load(again)
    ours, theirs = harness.Denoc(system), harness.Denoc(other)
    q = ours.assemble()
    np.testing.assert_allclose(theirs.open_by(q), 0.0, atol=1e-12)
    qd = ours.closed_velocity(q, np.ones(3))
    np.testing.assert_allclose(
        ours.forward_dynamics(q, qd, np.ones(3)), theirs.forward_dynamics(q, qd, np.ones(3)), rtol=1e-9
    )
    with pytest.raises(UnsupportedError, match="'pin' closes a loop, which URDF cannot say"):
        write(system, tmp_path / "again.urdf")


def test_a_loop_on_a_massless_link_is_no_mjcf(four_bar: Path, tmp_path: Path) -> None:
    """Of a massless link and what it carries MJCF makes one body, on which the loop's frame would move."""
    strut = FOUR_BAR.replace("mass = 0.3\ncom = [0.15, 0, 0]\ninertia = [1e-6, 2.25e-3, 2.25e-3]", "mass = 0.0")
    tip = """
[[joint]]
name = "wag"
type = "revolute"
parent = "coupler"
child = "tip"
axis = [0, 1, 0]

[[link]]
name = "tip"
mass = 0.1
com = [0.01, 0, 0]
inertia = [1e-4, 1e-4, 1e-4]
"""
    assert strut != FOUR_BAR
    four_bar.write_text(strut + tip + PIN)
    system = harness.load(four_bar)
    with pytest.raises(UnsupportedError, match="loop 'pin' ends on 'coupler', which is massless"):
        write(system, tmp_path / "again.xml")
    assert not (tmp_path / "again.xml").exists()
    assert write(system, tmp_path / "again.toml") == ()


REFUSED = {
    "cannot close": (PIN.replace("[0.3, 0, 0]", "[0.9, 0, 0]"), r":44: loop 'pin' cannot close: at best .* stays open"),
    "contradict": (
        PIN + PIN.replace('"pin"', '"other"').replace("[0, 0, 0.2]", "[0, 0, 0.25]"),
        "loops 'pin', 'other' contradict one another",
    ),
    "nothing left": (
        PIN + GEAR,
        r":50: the loops hold everything: 3 independent conditions on 3 degrees of freedom.*'gear'",
    ),
    "unknown link": (PIN.replace('"rocker"', '"rokcer"'), r":44: loop 'pin': 'rokcer' is not a link .*rocker"),
    "one link": (PIN.replace('"rocker"', '"coupler"'), "both frames are on 'coupler'"),
    "unknown motion": (PIN.replace('"z"', '"rw"'), r":48: loop 'pin': unknown motion 'rw'"),
    "nothing closed": (PIN.replace('["x", "z"]', "[]"), r":48: loop 'pin': 'closed' must be a list of motions"),
    "no frame": (PIN.replace("first =", "frist ="), "loop 'pin': 'first' is missing"),
    "no joint": (GEAR.replace('"d"', '"e"'), "loop 'gear': 'e' is no joint of this model"),
    "itself": (GEAR.replace('"d"', '"a"'), "joint 'a' is coupled to itself"),
    "sixth power": (GEAR.replace("[0.1, 0.5]", "[1, 2, 3, 4, 5, 6]"), "'polynomial' has 6 coefficients"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused_in_one_line(case: str, tmp_path: Path) -> None:
    text, words = REFUSED[case]
    file = tmp_path / "bad.toml"
    file.write_text(FOUR_BAR + text)
    with pytest.raises(harness.InputError, match=words) as raised:
        harness.load(file)
    assert "\n" not in str(raised.value)


GEARS = """<mujoco><compiler angle="radian"/><worldbody>
<body name="a"><joint name="j" axis="0 1 0"/><geom size="0.1" pos="0.3 0 0"/></body>
<body name="b" pos="0 1 0"><joint name="k" axis="0 1 0"/><geom size="0.1" pos="0.2 0 0"/></body>
<body name="c" pos="0 2 0"><joint name="l" axis="0 1 0"/><geom size="0.1" pos="0.1 0 0"/></body>
</worldbody><equality>
<joint name="first" joint1="j" joint2="k" polycoef="0.1 2"/>
<joint name="second" joint1="k" joint2="l" polycoef="0.2 -1"/>
{third}
</equality></mujoco>"""


@pytest.mark.parametrize(
    ("joints", "polynomial"),
    [('joint1="j" joint2="k"', "0.1 2"), ('joint1="j" joint2="l"', "0.5 -2"), ('joint1="l" joint2="k"', "0.2 -1")],
)
def test_gears_may_be_said_twice(joints: str, polynomial: str, tmp_path: Path) -> None:
    """j = 0.1 + 2 k and k = 0.2 − l, so that j = 0.5 − 2 l and l = 0.2 − k."""
    (tmp_path / "gears.xml").write_text(GEARS.format(third=f'<joint name="third" {joints} polycoef="{polynomial}"/>'))
    system = harness.load(tmp_path / "gears.xml")
    assert system.nv == 1 and not system.loops
    (note,) = (note for note in system.notes if "'third'" in note)
    assert "what others say already" in note


def test_gears_that_contradict_one_another_are_refused_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "gears.xml").write_text(
        GEARS.format(third='<joint name="third" joint1="j" joint2="l" polycoef="0.9 -2"/>')
    )
    with pytest.raises(harness.InputError, match=r":8: equality 'third' contradicts others: .* 0\.2 "):
        harness.load(tmp_path / "gears.xml")


def test_gears_that_one_place_alone_suits_are_locked_there(tmp_path: Path) -> None:
    """j = 0.5 − 2 l and j = 0.9 − l: l = −0.4."""
    free = (
        '<body name="d" pos="0 3 0"><joint name="m" axis="0 1 0"/><geom size="0.1" pos="0.1 0 0"/></body></worldbody>'
    )
    text = GEARS.format(third='<joint name="third" joint1="j" joint2="l" polycoef="0.9 -1"/>').replace(
        "</worldbody>", free
    )
    (tmp_path / "gears.xml").write_text(text)
    system = harness.load(tmp_path / "gears.xml")
    q = closed_position(system)
    assert q[system.position_names.index("l")] == pytest.approx(-0.4, abs=1e-12)


def test_what_is_said_twice_is_counted(four_bar: Path) -> None:
    four_bar.write_text(FOUR_BAR + PIN.replace('["x", "z"]', '["x", "y", "z", "rx", "rz"]'))
    assert any("5 conditions, 2 of them independent" in note for note in harness.load(four_bar).notes)


def test_efforts_are_not_fitted_beside_loops(
    four_bar: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = tmp_path / "run.csv"
    time = np.linspace(0.0, 2.0, 201)
    recording.write_text("time,a.position\n" + "\n".join(f"{t},{np.cos(t)}" for t in time))
    assert status_of(["diagnose", str(recording), "--model", str(four_bar), "--fit-effort"]) == 2
    (line,) = [line for line in capsys.readouterr().err.splitlines() if "efforts are fitted" in line]
    assert "leave out --fit-effort" in line


def test_an_mjcf_s_equalities_are_loops(tmp_path: Path) -> None:
    """Connected and welded bodies, joints with pos and ref; closed where the file places them."""
    file = tmp_path / "model.xml"
    file.write_text(
        """<mujoco><compiler angle="radian"/><worldbody>
        <body name="a" pos="0 0 1"><joint name="j" axis="0 1 0" pos="0.1 0 0" ref="0.3"/><geom size="0.1" pos="0.3 0 0"/>
          <body name="b" pos="0.5 0 0"><joint name="k" axis="0 1 0"/><geom size="0.1" pos="0.2 0 0"/></body></body>
        <body name="c" pos="0.9 0 1"><joint name="l" axis="0 1 0" pos="0 0 -0.4"/><geom size="0.1"/>
          <body name="e" pos="0 0.2 0"><joint name="m" axis="0 1 0"/><geom size="0.1" pos="0.1 0 0"/></body></body>
        <body name="d" pos="0 1 0"><freejoint name="f"/><geom size="0.1" pos="0.01 0 0"/></body>
        </worldbody><equality><connect name="pin" body1="b" body2="c" anchor="0.4 0 0"/>
        <weld name="glue" body1="e" body2="d"/></equality></mujoco>"""
    )
    system = harness.load(file)
    assert [loop.name for loop in system.loops] == ["pin", "glue"]
    q = closed_position(system)
    rest = system.keyframes[-1].position
    np.testing.assert_allclose(q, [rest[name] for name in system.position_names], atol=1e-12)
    np.testing.assert_allclose(opening(system, q).value, 0.0, atol=1e-12)
