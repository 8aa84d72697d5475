"""What closes the gate, a line each: figures first, and what one thing stands in the way of as one."""

from __future__ import annotations

from dataclasses import replace

from harness.cases.case import Row
from harness.cases.gate import Judged, Judgement
from harness.report.closing import lines

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
