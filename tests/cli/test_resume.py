"""Long runs that are killed at any moment go on, and a full disk at any write is one line."""

from __future__ import annotations

import errno
import json
from pathlib import Path
from typing import Any

import pytest

from harness.cases.case import Doubt, Row, Series
from harness.cases.run import Outcome, Task, kept_outcome, outcome_as_dict, run
from harness.cli.main import status_of
from harness.compare import bench as benches
from harness.compare.bench.peers import Options
from harness.compare.bench.row import Row as Cost
from harness.errors import InputError
from harness.journal import Journal

OF = {"only": ["a"], "quick": True}


def test_a_journal_cut_off_at_any_byte_keeps_what_was_whole(tmp_path: Path) -> None:
    """A kill or a full disk leaves a beginning of what was written."""
    path = tmp_path / "unfinished.jsonl"
    whole = Journal(path, OF)
    for k in range(4):
        whole.add(f"case {k}", {"value": k, "text": "é\n"})
    content = path.read_bytes()
    ends = [k + 1 for k, byte in enumerate(content) if byte == ord("\n")]
    for length in range(len(content) + 1):
        path.write_bytes(content[:length])
        found = Journal(path, OF).found
        assert len(found) == max(0, sum(end <= length for end in ends) - 1)
        Journal(path, OF).add("next", {"value": 9})
        assert Journal(path, OF).found == {**found, "next": {"value": 9}}


def test_a_journal_of_another_run_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "unfinished.jsonl"
    Journal(path, OF).add("case", 1)
    with pytest.raises(InputError, match="with other options"):
        Journal(path, {**OF, "quick": False})
    monkeypatch.setattr("harness.journal.code_digest", lambda: "another")
    with pytest.raises(InputError, match="another version of the code"):
        Journal(path, OF)
    path.write_text('{"schema": "other"}\n')
    with pytest.raises(InputError, match="no record of an interrupted run"):
        Journal(path, OF)


def test_a_case_is_the_same_after_it_was_kept() -> None:
    row = Row("c", "q", ("denoc", "mujoco"), 1e-9, 1e-8, "rad", "why", "pass", "note", {"time": 0.5, "joint": "j"})
    line = Series("c", "t", "denoc", (0.0, 1.0), (float("nan"), 2.0), "s", "rad")
    outcome = Outcome("c", "title", (row,), (line,), 1.5, (Doubt("c", "kind", "subject", "what"),), ("a note",))
    again = kept_outcome(json.loads(json.dumps(outcome_as_dict(outcome))), None)
    assert repr(again) == repr(outcome)


def test_cases_that_ended_are_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[str] = []

    def run_one(task: Task) -> Outcome:
        ran.append(task.case)
        return Outcome(task.case, "title", (Row(task.case, "q", ("denoc",), 1e-9, 1e-8, "rad", "", "pass"),), (), 0.1)

    monkeypatch.setattr("harness.cases.run.run_task", run_one)
    tasks = [Task(case, ("denoc", "mujoco")) for case in ("rotor", "chain_2", "tree_2")]
    path = tmp_path / "unfinished.jsonl"
    told: list[tuple[int, int, str]] = []
    first = run(tasks, workers=1, journal=Journal(path, OF))
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(lines[:2]) + lines[2][:30])  # killed while the second was written
    ended, ran[:] = ran[0], []
    again = run(tasks, workers=1, journal=Journal(path, OF), progress=lambda *step: told.append(step))
    assert again.rows == first.rows
    assert [row.case for row in again.rows] == ["rotor", "chain_2", "tree_2"]
    assert ended not in ran
    assert len(ran) == 2
    assert [step[:2] for step in told] == [(2, 3), (3, 3)]


def test_benchmarks_that_ended_are_not_measured_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    measured: list[str] = []

    def module(name: str) -> Any:
        class Bench:
            @staticmethod
            def run(options: Options) -> Any:
                measured.append(name)
                yield Cost(
                    benches.BENCHMARKS[name.rpartition(".")[2]].rows[0], 7, "peer", 1.0, 2.0, ours_spread=(0.9, 1.1)
                )

        return Bench

    monkeypatch.setattr(benches, "import_module", module)
    path = tmp_path / "unfinished.jsonl"
    wanted = ("batch", "scaling")
    steps = benches.run(wanted, Options(), Journal(path, OF))
    rows = [next(steps), next(steps)]
    steps.close()  # killed once the first benchmark is whole and the second is not
    assert list(benches.run(wanted, Options(), Journal(path, OF))) == rows
    assert [name.rpartition(".")[2] for name in measured] == ["batch", "scaling", "scaling"]


def test_only_interrupted_runs_are_resumed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for verb in ("gate", "bench"):
        assert status_of([verb, "--resume", str(tmp_path)]) == 2
        assert "holds no interrupted run" in capsys.readouterr().err


@pytest.mark.parametrize("place", ["write_text", "write_bytes", "mkdir", "replace"])
def test_a_full_disk_is_one_line(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """At each kind of write of what goes to --out, and of --json."""
    results = tmp_path / "results.json"
    row = {
        "case": "c", "quantity": "q", "engines": ["denoc", "mujoco"], "difference": 1e-9, "allowed": 1e-8, "unit": "rad",
        "why_allowed": "", "verdict": "pass", "note": "", "first_divergence": None,
    }  # fmt: skip
    results.write_text(json.dumps({"schema": "denoc.results/1", "versions": {}, "rows": [row]}))
    out = tmp_path / "out"
    if place != "mkdir":
        out.mkdir()
    before = sorted(tmp_path.rglob("*"))

    def full(self: Path, *arguments: object, **options: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", str(self))

    with monkeypatch.context() as patch:
        patch.setattr(Path, place, full)
        wanted = ["--json", str(out / "answer.json")] if place == "write_text" else ["--out", str(out)]
        status = status_of(["report", str(results), *wanted])
    told = capsys.readouterr().err
    assert status == 2
    assert told.count("\n") == 1
    assert "No space left on device (make room, or name another place)" in told
    assert "defect" not in told
    assert sorted(tmp_path.rglob("*")) == before  # whole or not at all


def test_a_disk_that_fills_up_between_two_results_is_told_with_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a full disk says of a file that is open already names no file."""
    journal = Journal(tmp_path / "unfinished.jsonl", {})
    journal.add("first", 1)

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("os.fsync", full)
        with pytest.raises(
            InputError, match=r"unfinished\.jsonl: cannot be written: No space left on device \(make room"
        ):
            journal.add("second", 2)
    assert Journal(tmp_path / "unfinished.jsonl", {}).found["first"] == 1


def test_an_error_of_the_machine_is_no_defect(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def full(*arguments: object, **options: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", "proof/found/single-0.json")

    monkeypatch.setattr("harness.proof.run.prove", full)
    monkeypatch.setattr("harness.denoc.compiling.ahead.everything", lambda: None)
    assert status_of(["prove", "--quick", "--out", str(tmp_path / "proof")]) == 2
    told = capsys.readouterr().err
    assert "proof/found/single-0.json: No space left on device" in told
    assert "defect" not in told
