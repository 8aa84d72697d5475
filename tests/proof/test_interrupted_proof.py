"""A proof that was interrupted goes on where it stopped, and answers sealed once stay as they are."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from harness.cli.main import status_of
from harness.errors import InputError
from harness.proof.run import Task, conceal, prove, score_so_far
from harness.proof.seal import unseal

SEED = 12


def test_what_is_sealed_is_not_drawn_again(tmp_path: Path) -> None:
    task = Task("clean", 3, "")
    name, published = conceal(task, SEED, tmp_path)
    before = {path.name: path.read_bytes() for path in (tmp_path / "cases" / name).iterdir()}
    assert conceal(task, SEED, tmp_path) == (name, published)
    assert {path.name: path.read_bytes() for path in (tmp_path / "cases" / name).iterdir()} == before
    assert unseal(name, tmp_path / "sealed", published)["kind"] == "clean"


def test_cases_that_were_answered_are_not_diagnosed_again(tmp_path: Path) -> None:
    counts = {"clean": 2}
    first = prove(tmp_path, seed=SEED, counts=counts, workers=1)
    found = tmp_path / "found" / "clean-0.json"
    marked = {**json.loads(found.read_text(encoding="utf-8")), "seconds": -1.0}
    found.write_text(json.dumps(marked), encoding="utf-8")
    (tmp_path / "found" / "clean-1.json").unlink()
    again = prove(tmp_path, workers=1)
    # Short proofs leave the peers out unless they are asked for.
    assert dict(first.peers) == dict(again.peers) == {}
    assert again.seed == SEED
    assert [s.verdict for s in again.scores] == [s.verdict for s in first.scores]
    assert [s.seconds for s in again.scores if s.name == "clean-0"] == [-1.0]


def test_what_was_answered_before_an_interruption_is_scored(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    whole = prove(tmp_path, seed=SEED, counts={"clean": 2}, workers=1)
    written = (tmp_path / "proof.json").read_bytes()
    json.loads(written, parse_constant=pytest.fail)  # other programs know no NaN
    (tmp_path / "found" / "clean-1.json").unlink()
    part = score_so_far(tmp_path)
    assert (part.seed, part.sealed, [s.name for s in part.scores]) == (SEED, 2, ["clean-0"])
    assert part.scores[0].verdict == whole.scores[0].verdict
    assert (part.to_json()["cases"], part.to_json()["sealed"]) == (1, 2)
    assert status_of(["prove", "--score", str(tmp_path)]) == 0
    assert "1 of 2 cases so far" in capsys.readouterr().out
    assert "1 of 2 cases so far" in (tmp_path / "report.html").read_text(encoding="utf-8")
    # Of the proof itself, which may still be running, nothing is touched.
    assert (tmp_path / "proof.json").read_bytes() == written


def test_nothing_to_score_is_said_in_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert status_of(["prove", "--score", str(tmp_path)]) == 2
    assert "no diagnosed case" in capsys.readouterr().err
    assert status_of(["prove", "--score", str(tmp_path), "--seed", "3"]) == 2
    assert "alone" in capsys.readouterr().err


def test_an_answer_changed_after_sealing_is_refused(tmp_path: Path) -> None:
    name, published = conceal(Task("clean", 1, ""), SEED, tmp_path)
    path = tmp_path / "sealed" / f"{name}.json"
    path.write_text(path.read_text(encoding="utf-8").replace('"kind": "clean"', '"kind": "single"'), encoding="utf-8")
    with pytest.raises(InputError, match="changed"):
        unseal(name, tmp_path / "sealed", published)
