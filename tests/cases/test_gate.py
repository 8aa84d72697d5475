"""The gate: what closes it, what it accepts, and whether it can be fooled."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.cases.case import Row
from harness.cases.discover import built_in
from harness.cases.gate import Accepted, accept, judge, read_accepted, self_test
from harness.cases.results import Results, read_results
from harness.cli.main import status_of
from harness.errors import InputError

ROW = Row("swing", "period", ("denoc", "analytic"), 1e-9, 1e-8, "1", "RK4", "pass")
OTHER = replace(ROW, case="other")
SKIPPED = Row("swing", "all", ("denoc", "far"), None, None, "1", "", "skipped", "not installed")


def results(*rows: Row) -> Results:
    return Results(rows, versions={"numpy": "2"}, created="2026-01-02T03:04:05+00:00")


def accepted(*rows: Row) -> Accepted:
    return accept(results(*rows), None, "first figures").accepted


def reasons(now: Results, then: Accepted) -> dict[str, str]:
    return {row.key: row.reason for row in judge(now, then).failed}


def test_the_same_run_holds():
    judgement = judge(results(ROW, SKIPPED), accepted(ROW, SKIPPED))
    assert judgement.ok
    assert judgement.rows[0].change == pytest.approx(0.0, abs=1e-12)


def test_a_reader_that_reads_otherwise_may_be_accepted(tmp_path):
    """Its rows are skipped and tell by how much it does, which is no figure to hold to."""
    otherwise = replace(SKIPPED, difference=1.4, allowed=1e-9, note="as read by pinocchio: gravity")
    file = tmp_path / "robot.json"
    file.write_text(accepted(ROW, otherwise).to_json())
    held = read_accepted(file)
    assert held.rows[SKIPPED.key].difference is None
    assert judge(results(ROW, otherwise), held).ok


def test_rows_of_engines_that_were_not_asked_for_are_counted_and_do_not_close_the_gate():
    far, near = replace(ROW, engines=("denoc", "far")), replace(ROW, engines=("denoc", "near"))
    recorded = replace(far, engines=("far", "recorded"))
    held = accepted(ROW, far, near, recorded)
    judgement = judge(results(ROW, near), held, left_out={"far"})
    assert judgement.ok
    assert judgement.not_asked == {"far": 2}
    assert judgement.not_held() == "2 accepted rows were not held: of engines that --engine leaves out, far (2)."
    # Nothing else gets past: what is asked for and is not there, what was run all the same, and a run without any row.
    assert not judge(results(ROW), held, left_out={"far"}).ok
    assert not judge(results(ROW, near, replace(far, difference=1.0, verdict="fail")), held, left_out={"far"}).ok
    assert not judge(results(), accepted(far), left_out={"far"}).ok
    assert not judge(results(ROW, near), held).ok


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
        (replace(ROW, difference=-1e-9), "no check gives"),
        (replace(ROW, allowed=None), "no check gives"),
        (replace(ROW, allowed=math.nan), "no check gives"),
        (replace(ROW, allowed=-1.0, difference=-2.0), "no check gives"),
        # Ten times the accepted figure, and a fifth of what is allowed: within the limit, and yet a change.
        (replace(ROW, difference=3e-9), "grew"),
        (replace(ROW, difference=5e-8, allowed=1e-6), "loosened"),
        (replace(ROW, unit="rad"), "was accepted in 1"),
        (replace(ROW, difference=None, verdict="skipped", note="engine gone"), "not possible here: engine gone"),
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


@pytest.mark.parametrize(
    ("row", "skipped"),
    [
        # The engine stands first where the truth is an analytic one.
        (replace(ROW, engines=("far", "analytic")), SKIPPED),
        # Of the native engine alone: the whole case was not possible.
        (ROW, replace(SKIPPED, engines=("denoc",))),
        (ROW, replace(SKIPPED, quantity=ROW.quantity, engines=("denoc",))),
    ],
)
def test_what_stands_in_the_way_of_a_missing_row_is_said(row, skipped):
    found = reasons(results(skipped), accepted(row, skipped))[row.key]
    assert found == f"not possible here: {skipped.note}"


def test_what_another_engine_lacks_is_no_reason_for_a_missing_row():
    assert "has no" in reasons(results(SKIPPED), accepted(ROW, SKIPPED))[ROW.key]


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
    second = accept(results(replace(ROW, difference=2e-9)), accepted(ROW), "a better integrator").accepted
    assert [entry["why"] for entry in second.history] == ["a better integrator", "first figures"]
    assert (second.history[0]["changed"], second.history[0]["added"], second.history[0]["date"]) == (1, 0, "2026-01-02")
    assert second.history[0]["versions"] == {"numpy": "2"}


def test_a_part_of_a_run_cannot_take_the_rest_out_of_the_file():
    other = replace(ROW, case="other")
    change = accept(results(replace(ROW, difference=2e-9)), accepted(ROW, other), "a part")
    assert change.kept == (other.key,)
    assert change.accepted.rows[other.key] == accepted(other).rows[other.key]
    assert "did not run" in reasons(results(ROW), change.accepted)[other.key]


def test_a_part_of_a_run_lets_go_of_no_row_that_was_not_possible():
    """Only where its engines are compared now: another engine's rows of the case say nothing of it."""
    change = accept(results(ROW), accepted(ROW, SKIPPED), "without the other engine")
    assert (change.removed, change.kept) == ((), (SKIPPED.key,))
    now = replace(ROW, engines=("denoc", "far"))
    assert accept(results(ROW, now), accepted(ROW, SKIPPED), "it is installed now").removed == (SKIPPED.key,)


@pytest.mark.parametrize("name", ["other", "other/period", "other/period/denoc+analytic", "oth*"])
def test_rows_are_let_go_by_name(name):
    other = replace(ROW, case="other")
    change = accept(results(ROW), accepted(ROW, other), "the case is gone", remove=[name])
    assert change.removed == (other.key,)
    assert set(change.accepted.rows) == {ROW.key}
    assert change.accepted.history[0]["removed"] == 1


@pytest.mark.parametrize(("name", "words"), [("othr", "names no accepted row"), ("swing", "which this run holds")])
def test_what_is_not_there_or_still_there_cannot_be_let_go(name, words):
    with pytest.raises(InputError, match=words):
        accept(results(ROW), accepted(ROW, replace(ROW, case="other")), "because", remove=[name])


def test_a_row_is_not_accepted_as_skipped_unless_it_is_let_go():
    skipped = replace(ROW, difference=None, allowed=None, verdict="skipped", note="engine gone")
    other = replace(ROW, case="other")
    with pytest.raises(InputError, match="--remove"):
        accept(results(skipped, other), accepted(ROW, other), "because")
    change = accept(results(skipped, other), accepted(ROW, other), "no such engine here", remove=[ROW.key])
    assert change.accepted.rows[ROW.key].verdict == "skipped"


def test_a_loosened_limit_is_told():
    assert accept(results(replace(ROW, allowed=1e-6)), accepted(ROW), "because").loosened == (ROW.key,)


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
        (lambda d: d["rows"][ROW.key].update(allowed="wide"), "Expected `float | null`, got `str`"),
        (lambda d: d["rows"][ROW.key].update(verdict="skipped"), "is skipped, and has figures"),
        (lambda d: d["rows"].update({"swing": d["rows"][ROW.key]}), "no row's key"),
        (lambda d: d.update(rows=[1, 2]), "Expected `object`, got `array`"),
        (lambda d: d.update(history=[1]), "Expected `object`, got `int`"),
        (lambda d: d.update(shares={"period": None}), "Expected `float`, got `null`"),
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


@pytest.mark.parametrize(
    "edit",
    [
        lambda d: d["rows"][ROW.key].update(difference=9e-9),
        lambda d: d["rows"][ROW.key].update(allowed=1.0),
        lambda d: d["rows"][ROW.key].update(unit="rad"),
        lambda d: d["rows"][ROW.key].update(verdict="skipped", difference=None, allowed=None),
        lambda d: d["rows"].pop(OTHER.key),
        lambda d: d["shares"].update(period=1.0),
        lambda d: d["history"][0].update(why="another reason"),
        lambda d: d["history"][0]["versions"].update(numpy="3"),
        lambda d: d.pop("digest"),
    ],
)
def test_figures_changed_by_hand_close_the_gate_until_they_are_accepted(tmp_path, edit):
    document = json.loads(accepted(ROW, OTHER).to_json())
    edit(document)
    file = tmp_path / "accepted.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    held = read_accepted(file)
    judgement = judge(results(ROW, OTHER), held)
    assert judgement.reference and not judgement.ok
    again = accept(results(ROW, OTHER), held, "looked at, and right").accepted
    file.write_text(again.to_json(), encoding="utf-8")
    assert judge(results(ROW, OTHER), read_accepted(file)).ok
    assert again.history[0]["edited"]


def test_a_part_of_a_run_cannot_accept_what_was_edited_in_the_rest(tmp_path):
    """Its new digest would make good what nobody looked at."""
    document = json.loads(accepted(ROW, OTHER).to_json())
    document["rows"][OTHER.key].update(allowed=1.0, difference=0.9)
    file = tmp_path / "accepted.json"
    file.write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(InputError, match="lacks 1 of its rows, the first is other"):
        accept(results(ROW), read_accepted(file), "a part")
    again = accept(results(ROW, OTHER), read_accepted(file), "the whole").accepted
    assert again.rows[OTHER.key].allowed == OTHER.allowed
    # By name a row may go, edited or not.
    assert accept(results(ROW), read_accepted(file), "the case is gone", remove=["other"]).kept == ()


def test_the_digest_does_not_hang_on_the_layout_of_the_file(tmp_path):
    file = tmp_path / "accepted.json"
    file.write_text(json.dumps(json.loads(accepted(ROW).to_json()), indent=7), encoding="utf-8")
    assert not read_accepted(file).edited


def test_a_row_that_stands_twice_in_the_file_is_refused(tmp_path):
    file = tmp_path / "accepted.json"
    text = accepted(ROW).to_json()
    line = next(line for line in text.splitlines() if ROW.key in line)
    file.write_text(text.replace(line, line + ",\n" + line), encoding="utf-8")
    with pytest.raises(InputError, match="stands twice"):
        read_accepted(file)


@pytest.mark.parametrize("read", [read_accepted, read_results])
@pytest.mark.parametrize("seed", range(4))
def test_a_damaged_file_is_refused_in_one_line(tmp_path, read, seed):
    rng = np.random.default_rng(seed)
    text = (accepted(ROW, SKIPPED).to_json() if read is read_accepted else results(ROW, SKIPPED).to_text()).encode()
    pieces = [
        b"null",
        b"1e999",
        b"-",
        b"[" * 3000,
        b'"',
        b"{}",
        b"[]",
        b"true",
        b"9" * 5000,
        b"NaN",
        b"\xff",
        b",",
        b"",
    ]
    file = tmp_path / "damaged.json"
    refused = 0
    for _ in range(150):
        start, length = int(rng.integers(len(text))), int(rng.integers(0, 40))
        file.write_bytes(text[:start] + pieces[int(rng.integers(len(pieces)))] + text[start + length :])
        try:
            read(file)
        except InputError as error:
            refused += 1
            assert "\n" not in str(error) and len(str(error)) < 600
    assert refused > 100


@pytest.mark.parametrize(
    "text",
    [
        "[" * 100_000,
        '{"schema": "denoc.accepted/1", "rows": ' + '{"a":' * 50_000,
        "1",
        "[]",
        "null",
        '"denoc.accepted/1"',
    ],
)
def test_what_is_no_document_at_all_is_refused_in_one_line(tmp_path, text):
    file = tmp_path / "damaged.json"
    file.write_text(text, encoding="utf-8")
    for read in (read_accepted, read_results):
        with pytest.raises(InputError) as caught:
            read(file)
        assert "\n" not in str(caught.value) and len(str(caught.value)) < 600


@pytest.mark.parametrize("number", ["NaN", "-Infinity", "1e999"])
def test_a_number_that_is_not_finite_is_refused_wherever_it_stands(tmp_path, number):
    """What a row says of where it left its line has any form; nothing that is written has such numbers."""
    text = results(replace(ROW, difference=1.0, verdict="fail", first_divergence={"time": 0.25})).to_text()
    file = tmp_path / "results.json"
    file.write_text(text.replace("0.25", number), encoding="utf-8")
    with pytest.raises(InputError, match="is no finite number"):
        read_results(file)


def test_results_of_others_give_neither_terminals_nor_servers_a_command(tmp_path, capsys):
    """Control characters become signs, and a line break in a name begins no line, of which servers read commands."""
    hostile = "swing\x1b[31m\n::error::all is well"
    row = replace(ROW, difference=1.0, verdict="fail", note=hostile, first_divergence={"joint": hostile, "time": 0.5})
    rows = (row, replace(row, case=hostile, unit="\x9b31m"), replace(SKIPPED, note=hostile))
    file, reference = tmp_path / "results.json", tmp_path / "accepted.json"
    file.write_text(results(*rows).to_text(), encoding="utf-8")
    reference.write_text(accepted(ROW, OTHER, SKIPPED).to_json(), encoding="utf-8")
    options = ["--results", str(file), "--reference", str(reference), "--no-self-test", "--annotate"]
    assert status_of(["gate", *options, "--summary", str(tmp_path / "gate.md")]) == 1
    said = capsys.readouterr().out
    assert "all is well" in said
    for text in (said, (tmp_path / "gate.md").read_text(encoding="utf-8")):
        assert "\x1b" not in text and "\x9b" not in text
        assert not any(line.strip().startswith("::error::all") for line in text.splitlines())


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
