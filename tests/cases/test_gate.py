"""The gate: what closes it, what it accepts, and whether it can be fooled."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from harness.cases.case import Row
from harness.cases.discover import built_in
from harness.cases.gate import judge, read_accepted, self_test
from harness.cases.gate.accepted import Accepted, accept
from harness.cases.results import Results
from harness.errors import InputError

ROW = Row("swing", "period", ("denoc", "analytic"), 1e-9, 1e-8, "1", "RK4", "pass")
SKIPPED = Row("swing", "all", ("denoc", "far"), None, None, "1", "", "skipped", "not installed")


def results(*rows: Row) -> Results:
    return Results(rows, versions={"numpy": "2"}, created="2026-01-02T03:04:05+00:00")


def accepted(*rows: Row) -> Accepted:
    return accept(results(*rows), None, "first figures")


def reasons(now: Results, then: Accepted) -> dict[str, str]:
    return {row.key: row.reason for row in judge(now, then).failed}


def test_the_same_run_holds():
    judgement = judge(results(ROW, SKIPPED), accepted(ROW, SKIPPED))
    assert judgement.ok
    assert judgement.rows[0].change == pytest.approx(0.0, abs=1e-12)


def test_rounding_of_another_processor_holds():
    assert not reasons(results(replace(ROW, difference=1.3e-9)), accepted(ROW))


@pytest.mark.parametrize(
    ("now", "words"),
    [
        (replace(ROW, difference=2e-8, verdict="fail"), "left the line"),
        (replace(ROW, difference=math.nan, verdict="fail"), "not a finite number"),
        (replace(ROW, difference=math.nan, verdict="pass"), "not a finite number"),
        (replace(ROW, difference=None, verdict="pass"), "not a finite number"),
        # Said to pass, though it is beyond its own limit.
        (replace(ROW, difference=2e-8), "left the line"),
        # Ten times the accepted figure, and a fifth of what is allowed: within the limit, and yet a change.
        (replace(ROW, difference=3e-9), "grew"),
        (replace(ROW, difference=5e-8, allowed=1e-6), "loosened"),
        (replace(ROW, unit="rad"), "was accepted in 1"),
        (replace(ROW, difference=None, verdict="skipped", note="engine gone"), "skipped now"),
    ],
)
def test_a_row_that_changed_closes_the_gate(now, words):
    assert words in reasons(results(now), accepted(ROW))[ROW.key]


def test_a_new_row_closes_the_gate_until_it_is_accepted():
    other = replace(ROW, case="other")
    assert "new" in reasons(results(ROW, other), accepted(ROW))[other.key]
    assert not reasons(results(ROW, other), accepted(ROW, other))


def test_a_missing_row_closes_the_gate():
    other = replace(ROW, case="other")
    assert "did not run" in reasons(results(ROW), accepted(ROW, other))[other.key]


def test_a_missing_engine_is_named():
    gone = replace(ROW, engines=("denoc", "far"))
    assert "not installed" in reasons(results(SKIPPED), accepted(gone, SKIPPED))[gone.key]


def test_two_rows_of_one_name_close_the_gate():
    assert "two rows" in reasons(results(ROW, ROW), accepted(ROW))[ROW.key]


def test_an_empty_run_does_not_pass():
    assert not judge(results(), accepted(ROW)).ok


def test_what_fails_cannot_be_accepted():
    with pytest.raises(InputError, match="rows fail"):
        accept(results(replace(ROW, verdict="fail", difference=1.0)), None, "because")


@pytest.mark.parametrize("difference", [None, float("nan"), float("inf"), -1.0, 1.0])
def test_a_pass_that_cannot_be_one_is_not_accepted(difference):
    with pytest.raises(InputError, match="changed by hand"):
        accept(results(replace(ROW, difference=difference)), None, "because")


def test_two_rows_of_one_name_are_not_accepted():
    with pytest.raises(InputError, match="two rows"):
        accept(results(ROW, ROW), None, "because")


def test_accepting_needs_a_reason_and_keeps_it():
    with pytest.raises(InputError, match="reason"):
        accept(results(ROW), None, "  ")
    second = accept(results(replace(ROW, difference=2e-9)), accepted(ROW), "a better integrator")
    assert [entry["why"] for entry in second.history] == ["a better integrator", "first figures"]
    assert (second.history[0]["changed"], second.history[0]["added"], second.history[0]["date"]) == (1, 0, "2026-01-02")
    assert second.history[0]["versions"] == {"numpy": "2"}


def test_the_file_survives_and_a_figure_is_a_line(tmp_path):
    file = tmp_path / "accepted.json"
    file.write_text(accepted(ROW, SKIPPED).to_json(), encoding="utf-8")
    again = read_accepted(file)
    assert again.rows == accepted(ROW, SKIPPED).rows
    assert sum("swing/period" in line for line in file.read_text().splitlines()) == 1


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda d: d.update(schema="denoc.accepted/9"), "schema"),
        (lambda d: d.update(rows={}), "holds no figures"),
        (lambda d: d["rows"][ROW.key].update(difference=None), "no finite accepted figure"),
        (lambda d: d["rows"][ROW.key].update(allowed="wide"), "no finite accepted figure"),
        (lambda d: d["rows"][ROW.key].update(difference=1.0), "accepts 1 where"),
        (lambda d: d["rows"][ROW.key].update(difference=-1e-9), "accepts -1e-09 where"),
        (lambda d: d["rows"][ROW.key].pop("unit"), "incomplete"),
        (lambda d: d["rows"][ROW.key].update(verdict="fail"), "no finite accepted figure"),
        (lambda d: d["shares"].update(period=5.0), "between 0 and 1"),
    ],
)
def test_a_spoiled_reference_is_refused(tmp_path, spoil, words):
    document = json.loads(accepted(ROW).to_json())
    spoil(document)
    file = tmp_path / "accepted.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(InputError, match=words) as caught:
        read_accepted(file)
    assert str(file) in str(caught.value)


def test_a_reference_with_nan_is_refused(tmp_path):
    file = tmp_path / "accepted.json"
    file.write_text(accepted(ROW).to_json().replace("1e-09", "NaN"), encoding="utf-8")
    with pytest.raises(InputError, match="finite"):
        read_accepted(file)


def test_a_missing_reference_is_refused(tmp_path):
    with pytest.raises(InputError, match="no accepted figures"):
        read_accepted(tmp_path / "acepted.json")


def test_every_planted_defect_is_caught_and_named():
    found = self_test()
    assert found.clean
    assert len(found.trials) >= 10
    assert {trial.defect: trial.said for trial in found.trials if not trial.caught} == {}
    assert {trial.defect: trial.said for trial in found.trials if not trial.named} == {}


def test_the_shipped_reference_knows_every_case_and_no_other():
    reference = read_accepted(Path(__file__).parents[2] / "reference" / "accepted.json")
    assert {key.rsplit("/", 2)[0] for key in reference.rows} == set(built_in())
    assert all(entry["why"] and entry["date"] and entry["versions"] for entry in reference.history)


def test_the_suite_passes_the_gate_it_ships():
    # What a user's first `denoc gate` does.
    run = subprocess.run([sys.executable, "-m", "harness", "gate"], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "rows hold" in run.stdout
