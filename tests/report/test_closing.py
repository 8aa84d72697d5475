"""What closes the gate, a line each: figures first, and what one thing stands in the way of as one."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from harness.cases.case import Row
from harness.cases.gate import Judged, Judgement
from harness.report.gate import print_judgement
from harness.report.gate.closing import lines

ROW = Row(
    "swing",
    "period",
    ("denoc", "far"),
    2e-8,
    1e-8,
    "1",
    "RK4",
    "fail",
    "mass",
    {"time": 1.5, "link": "rod", "value": "half_depth"},
)


def missing(case: str, quantity: str, reason: str) -> Judged:
    return Judged(f"{case}/{quantity}/denoc+far", None, 1e-9, reason=reason)


def test_rows_that_one_thing_stands_in_the_way_of_are_one_line_after_those_with_a_figure():
    gone = [missing(f"case {k}", f"quantity_{k % 2}", "not possible here: far is not installed") for k in range(5)]
    few = [missing("other", f"quantity_{k}", "missing: the case other did not run") for k in range(3)]
    found = lines(Judgement((*gone, *few, Judged(ROW.key, ROW, 1e-9, reason="left the line")), {}))
    assert [one.case for one in found] == ["swing", "5 cases: case 0, case 1 …", "other", "other", "other"]
    assert (found[0].now, found[0].where, found[0].why) == ("2.0e-08", "time 1.5 s, link rod, half depth", "mass")
    assert (found[1].quantity, found[1].engines, found[1].now) == ("quantity 0, quantity 1", "denoc · far", "5 rows")


def test_a_row_that_is_skipped_says_once_why():
    row = replace(ROW, verdict="skipped", difference=None, note="far is not installed", first_divergence=None)
    (found,) = lines(Judgement((Judged(row.key, row, 1e-9, reason="not possible here: far is not installed"),), {}))
    assert found.said == "not possible here: far is not installed"


HEAVIER = replace(
    ROW, case="arm", quantity="masses", engines=("denoc", "recorded"), difference=0.048, allowed=1e-9, group="models",
    note="mass of link 'upper': 2 → 2.1", first_divergence={"link": "upper", "value": "mass"},
)  # fmt: skip
COMES_OF_IT = replace(
    HEAVIER, quantity="recorded_acceleration", difference=0.389, note="", first_divergence={"coordinate": "elbow"}
)
ENGINES = ("denoc", "pinocchio", "mujoco", "exudyn_with_a_long_name")
CLOSED = Judgement(
    tuple(
        Judged(row.key, row, k * 1e-14, reason=f"left the line: {row.difference:.2e} where 1e-09 is allowed")
        for k, row in enumerate([HEAVIER, *(replace(COMES_OF_IT, engines=(name, "recorded")) for name in ENGINES)])
    ),
    {},
)


def test_what_changed_in_a_model_is_told_first_with_its_line(tmp_path: Path):
    file = tmp_path / "arm.urdf"
    file.write_text(
        '<robot name="arm">\n<link name="base"/>\n<link name="upper">\n<inertial>\n<mass value="2.1"/>\n'
        "</inertial>\n</link>\n</robot>\n"
    )
    found = lines(CLOSED, {"arm": file})
    assert [one.said for one in found] == [
        f"mass of link 'upper': 2 → 2.1; {file}:5",
        "left the line; coordinate elbow",
    ]
    assert (found[1].accepted, found[1].now, found[1].allowed) == ("≤ 4.0e-14", "3.9e-01", "1e-09")
    assert found[1].engines == f"{', '.join(ENGINES)} · recorded"


def test_engines_that_differ_by_other_figures_stand_apart():
    first, *rest = CLOSED.rows
    other = replace(rest[0], row=replace(rest[0].row, difference=0.2))
    assert len(lines(Judgement((first, other, *rest[1:]), {}))) == 3


NOTE = (
    "odd one out: exudyn; gravity is to blame, first at 3.25 s, elbow, where the mass matrix is nearly singular; " * 3
)


@pytest.mark.parametrize("width", [80, 100, 120])
def test_no_sentence_of_a_gate_is_a_tower(width: int):
    """Beside its figures or beneath them: no more lines than at twice what its words need over the whole width."""
    row = replace(ROW, case="rotating_cantilever", quantity="trajectory_to_horizon", note=NOTE)
    judged = Judged(row.key, row, 1e-9, reason="left the line: 2.00e-08 where 1e-08 is allowed")
    screen = Console(file=io.StringIO(), width=width)
    print_judgement(Judgement((judged,), {}), None, screen)
    text = screen.file.getvalue()
    sentence = lines(Judgement((judged,), {}))[0].said
    assert len(text.splitlines()) <= 4 + -(-len(sentence) // (width - 12))
    assert sum("2.0e-08" in line and "1e-08" in line for line in text.splitlines()) == 1
