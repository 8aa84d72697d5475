"""The study of the paper's open question: what its outcomes mean, how it resumes, and what the project says it gave."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import status_of
from harness.proof import paper_damping
from harness.proof.paper_damping import KINDS, Answer, answer_of, asked, record, told, trials

ROOT = Path(__file__).parents[2]
REFERENCE = ROOT / "reference" / "paper_damping.json"


def answer(found, rivals=(), kind="coulomb_friction", release=90.0, duration=10.0):
    trial = next(
        one for one in trials(1, draws=1, releases=(release,), durations=(duration,)) if one.truth.kind == kind
    )
    return Answer(trial, tuple(found), tuple(rivals), "explained")


@pytest.mark.parametrize(
    ("found", "rivals", "outcome"),
    [
        (("viscous_damping", "coulomb_friction"), (), "named"),
        (("coulomb_friction", "sensor_gain"), ("sensor_nonlinearity",), "named"),
        (("coulomb_friction",), ("stribeck_friction",), "likeliest"),
        (("stribeck_friction",), ("coulomb_friction",), "in a class"),
        (("coulomb_friction", "quadratic_drag"), (), "another"),
        (("dahl_friction",), ("stribeck_friction",), "another"),
        (("viscous_damping", "sensor_gain"), (), "not seen"),
    ],
)
def test_outcomes(found, rivals, outcome):
    assert answer(found, rivals).outcome == outcome


def test_tables_count_what_was_asked_and_tell_what_was_not():
    good, wrong = answer(("coulomb_friction",)), answer(("dahl_friction",), kind="quadratic_drag")
    late = answer(("coulomb_friction",), ("stribeck_friction",), duration=20.0)
    study = told([good, wrong, late])
    _, cells = study.tables["open_question"]
    assert ("coulomb friction", "90°", "named", "likeliest") in cells
    assert ("quadratic drag", "90°", "another: dahl friction", "not asked") in cells
    assert study.numbers["told apart_90_10"] == 0.5
    assert math.isnan(study.numbers["told apart_90_20"])  # drag was not asked there
    assert ("coulomb friction", "10 s") in study.tables["seconds_it_takes"][1]
    assert ("quadratic drag", "more than 10 s") in study.tables["seconds_it_takes"][1]


def test_truths_take_40_to_70_percent_and_are_drawn_afresh_by_seed():
    first, again, other = (trials(seed, durations=(4.0,)) for seed in (7, 7, 8))
    assert first == again
    assert {t.truth for t in first}.isdisjoint({t.truth for t in other})
    assert {t.truth.kind for t in first} == set(KINDS) and len(KINDS) >= 5
    assert all(0.4 <= t.truth.share <= 0.7 for t in first)
    assert set(trials(7, draws=1, durations=(4.0,))) < set(first)


def test_a_shorter_recording_is_the_beginning_of_a_longer_one():
    short, long = trials(3, draws=1, releases=(45.0,), durations=(4.0, 7.0))[:2]
    a, b = record(short), record(long)
    # The adaptive integrator's steps end elsewhere, so that a reading on the edge of a winding may be the next one.
    apart = np.abs(a.channels[0].values - b.channels[0].values[: len(a.time)])
    assert np.count_nonzero(apart > 1e-9) <= 2


def test_a_study_goes_on_where_it_was_interrupted(tmp_path, monkeypatch, capsys):
    count = 0

    def fake(trial):
        nonlocal count
        count += 1
        if count == 4:
            raise KeyboardInterrupt
        return Answer(trial, (trial.truth.kind,), (), "explained")

    monkeypatch.setattr(paper_damping, "asked", fake)
    out, options = str(tmp_path / "out"), ["--quick", "--workers", "1"]
    assert status_of(["paper", "damping", "--seed", "5", *options, "--out", out]) == 130
    assert "--resume" in capsys.readouterr().err
    assert status_of(["paper", "damping", *options, "--resume", out, "--so-far"]) == 0
    said = capsys.readouterr().out
    assert "quadratic drag" in said and "dahl friction" not in said
    assert status_of(["paper", "damping", *options, "--resume", out]) == 0
    assert count == 1 + len(KINDS) * 3
    document = json.loads((tmp_path / "out" / "damping.json").read_text(encoding="utf-8"))
    assert document["numbers"]["seed"] == 5
    assert len(document["records"]) == len(KINDS) * 3
    assert not (tmp_path / "out" / "unfinished.jsonl").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["figures", "--seed", "3"], "--seed"),
        (["departure", "--resume", "x"], "--resume"),
        (["damping", "--so-far"], "--resume"),
        (["damping", "--resume", "nowhere"], "no interrupted run"),
    ],
)
def test_what_cannot_be_asked_is_one_line(arguments, words, capsys):
    assert status_of(["paper", *arguments]) == 2
    told_by = capsys.readouterr().err
    assert words in told_by and told_by.count("\n") == 1


def reference():
    return json.loads(REFERENCE.read_text(encoding="utf-8"))


def trials_of(found):
    by_key = {trial.key: trial for trial in trials(int(found["numbers"]["seed"]))}
    return {record["trial"]: (by_key[record["trial"]], record) for record in found["records"]}


def test_the_tables_of_the_reference_are_those_of_its_records():
    found = reference()
    answers = [answer_of(trial, record) for trial, record in trials_of(found).values()]
    study = told(answers)
    for name, table in found["tables"].items():
        heads, rows = study.tables[name]
        assert table == {"heads": list(heads), "rows": [list(row) for row in rows]}
    assert all(
        a.outcome == record["outcome"] for a, (_, record) in zip(answers, trials_of(found).values(), strict=True)
    )


@pytest.mark.slow
def test_a_trial_of_the_reference_is_answered_the_same_again():
    """A drag of 10 s from 90°: the kind that is told apart with least work."""
    trial, record_of = trials_of(reference())["0/quadratic_drag/90/10"]
    again = asked(trial)
    assert again.outcome == record_of["outcome"]
    assert math.isclose(trial.release, 90.0)
