"""Long runs that are killed at any moment go on, and a full disk at any write is one line."""

from __future__ import annotations

import errno
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from harness.cases.case import Doubt, Row, Series
from harness.cases.gate.planted import full
from harness.cases.gate.planted.full import Fate, Fault
from harness.cases.run import Outcome, Task, kept_outcome, outcome_as_dict, run
from harness.cli.main import status_of
from harness.cli.resume import journal_in
from harness.compare import bench as benches
from harness.compare.bench.peers import Options
from harness.compare.bench.row import Row as Cost
from harness.errors import InputError
from harness.journal import Journal
from harness.report.gate.summary import append_summary

PENDULUM = Path(__file__).parents[2] / "models" / "urdf" / "rigid_pendulum.urdf"
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


@pytest.mark.parametrize(
    ("was", "now"),
    [('"value": 7', '"value": 8'), ('"case 1"', '"case 2"'), ('"case 1"', "[1]"), ('"value": 7', '"x": 7')],
)
def test_a_result_that_was_changed_on_the_disk_counts_for_nothing(tmp_path: Path, was: str, now: str) -> None:
    path = tmp_path / "unfinished.jsonl"
    Journal(path, OF).add("case 0", {1: [0.1], 10: None, 2: ()})
    Journal(path, OF).add("case 1", 7)
    text = path.read_text()
    assert Journal(path, OF).found == {"case 0": {"1": [0.1], "10": None, "2": []}, "case 1": 7}
    path.write_text(text.replace(was, now))
    assert list(Journal(path, OF).found) == ["case 0"]


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


REFERENCE = """{"case": "c", "quantity": "q", "engines": ["denoc", "mujoco"], "difference": 1e-9, "allowed": 1e-8, "unit": "rad",
 "why_allowed": "", "verdict": "pass", "note": "", "first_divergence": null}"""


@pytest.mark.slow
def test_a_long_self_test_goes_on_behind_the_last_fault_it_tried(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On saved results; killed while the third of four faults is tried. Begun again without --resume it would lose two: refused."""
    results, accepted, out = tmp_path / "results.json", tmp_path / "accepted.json", tmp_path / "out"
    results.write_text(f'{{"schema": "denoc.results/1", "versions": {{}}, "rows": [{REFERENCE}]}}')
    saved = ["gate", "--results", str(results), "--reference", str(accepted)]
    assert status_of([*saved, "--accept", "--new", "--why", "first figures"]) == 0
    tried: list[str] = []

    def try_fault(fault: Fault) -> Fate:
        if len(tried) == 2 and fault.name not in tried:
            tried.append(fault.name)
            raise KeyboardInterrupt  # the first time the third comes
        tried.append(fault.name)
        return Fate(fault.name, not fault.seed, fault.name != "b", f"said of {fault.name}")

    monkeypatch.setattr(full, "try_fault", try_fault)
    monkeypatch.setattr(full, "CLEAN", 0)
    monkeypatch.setattr(full, "faults", lambda: [Fault(name) for name in "abcd"])
    command = [*saved, "--self-test", "full", "--workers", "1"]
    assert status_of([*command, "--out", str(out)]) == 130
    assert f"`denoc gate --resume {out}` with the same options goes on from here" in capsys.readouterr().err
    assert tried == ["a", "b", "c"]
    before = (out / "unfinished.jsonl").read_bytes()
    assert status_of([*command, "--out", str(out)]) == 2
    assert "keeps 2 results of an interrupted run (go on with --resume" in " ".join(capsys.readouterr().err.split())
    assert (out / "unfinished.jsonl").read_bytes() == before
    answer = tmp_path / "answer.json"
    status = status_of([*command, "--resume", str(out), "--json", str(answer)])
    assert tried == ["a", "b", "c", "c", "d"]
    told = json.loads(answer.read_text())["self_test"]
    planted = {trial["defect"]: trial for trial in told["defects"][-4:]}
    assert [(name, trial["caught"], trial["named"], trial["said"]) for name, trial in planted.items()] == [
        (name, True, name != "b", f"said of {name}") for name in "abcd"
    ]
    assert status == 0
    assert not (out / "unfinished.jsonl").exists()
    assert "- b: caught, but said to be: said of b" in (out / "gate.md").read_text()


def test_a_long_self_test_is_kept_until_its_figures_are_accepted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The disk is full where the accepted figures go, the last thing that is written."""
    results, accepted, out = tmp_path / "results.json", tmp_path / "accepted.json", tmp_path / "out"
    results.write_text(f'{{"schema": "denoc.results/1", "versions": {{}}, "rows": [{REFERENCE}]}}')
    monkeypatch.setattr(full, "try_fault", lambda fault: Fate(fault.name, True, True, ""))
    monkeypatch.setattr(full, "CLEAN", 0)
    monkeypatch.setattr(full, "faults", lambda: [Fault(name) for name in "ab"])
    command = ["gate", "--results", str(results), "--reference", str(accepted), "--self-test", "full", "--workers", "1"]
    command += ["--accept", "--new", "--why", "first figures"]

    def no_room(path: Path, content: str) -> Path:
        raise InputError("cannot be written: No space left on device", source=path, mend="make room")

    with monkeypatch.context() as patch:
        patch.setattr("harness.whole_files.write_whole", no_room)
        assert status_of([*command, "--out", str(out)]) == 2
    assert "No space left on device" in capsys.readouterr().err
    assert (out / "unfinished.jsonl").exists()
    assert status_of([*command, "--resume", str(out)]) == 0
    assert accepted.exists()
    assert not (out / "unfinished.jsonl").exists()


def test_what_another_version_of_the_code_has_left_is_begun_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("harness.journal.code_digest", lambda: "another")
        Journal(tmp_path / "unfinished.jsonl", OF).add("case", 1)
    journal = journal_in(tmp_path, OF, anew=True)
    assert journal is not None
    assert journal.found == {}
    journal.add("case", 2)
    with pytest.raises(InputError, match="keeps 1 result of an interrupted run"):
        journal_in(tmp_path, {"other": 1}, anew=True)
    kept = journal_in(tmp_path, OF, anew=False)
    assert kept is not None
    assert kept.found == {"case": 2}


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


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("arguments", [[], ["audit", str(PENDULUM), "--json", "-"], ["--help"]])
@pytest.mark.parametrize("told", [True, False])
def test_full_standard_streams_are_no_defect_and_no_verdict(arguments: list[str], told: bool) -> None:
    """Where standard error is full as well, the status alone says so."""
    with Path("/dev/full").open("w") as full_device:
        errors: Any = subprocess.PIPE if told else full_device
        command = [sys.executable, "-m", "harness", *arguments]
        done = subprocess.run(command, stdout=full_device, stderr=errors, text=True, check=False)
    assert done.returncode == 2
    if told:
        assert "Traceback" not in done.stderr
        assert done.stderr.splitlines()[-1].startswith("denoc: ")


def test_a_summary_is_added_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a file that others have appended to before."""
    summary, made = tmp_path / "summary.md", tmp_path / "made.md"
    summary.write_text("of an earlier step\n")
    opened = Path.open

    def fills_up(self: Path, *arguments: Any, **options: Any) -> Any:
        with opened(self, *arguments, **options) as file:
            file.write("a part of wh")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "open", fills_up)
    for path in (summary, made):
        with pytest.raises(InputError, match="cannot be written: No space left on device"):
            append_summary(path, "a part of what is told")
    monkeypatch.undo()
    assert summary.read_text() == "of an earlier step\n"
    assert not made.exists()


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
