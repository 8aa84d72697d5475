"""A fleet is diagnosed unit by unit; what is done stays done, whoever is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from fleets import model, pendulum

import harness
from harness.cli.main import status_of
from harness.fleet.kept import answer_file

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]


def stamps(out: Path) -> dict[str, int]:
    return {path.name: path.stat().st_mtime_ns for path in (out / "units").glob("*.json")}


def test_a_fleet_is_resumed_and_its_table_told(tmp_path, capfd):
    home, out = tmp_path / "fleet", tmp_path / "out"
    pendulum(home / "clean.csv", 1)
    pendulum(home / "rough" / "run1.csv", 2, dry=0.004)
    model(home / "rough" / "model.toml")
    (home / "broken.csv").write_text("time,pivot.position\n", encoding="utf-8")
    (home / "bare").mkdir()
    nominal = model(tmp_path / "model.toml")
    found = harness.diagnose_fleet(home, nominal, out=out, workers=1)
    assert [(row["effect"], row["established"]) for row in found.effects] == [("coulomb_friction", ["rough"])]
    # What was put into the swing.
    low, high = (found.parameters[0]["quantiles"][q] for q in ("0.0", "1.0"))
    assert low == high == pytest.approx(0.004, rel=0.1)
    assert [row["unit"] for row in found.failed] == ["bare", "broken.csv"]
    jsonschema = pytest.importorskip("jsonschema")
    for name, document in (
        ("fleet", found.to_json()),
        ("unit", json.loads(answer_file(out, "rough").read_text("utf-8"))),
    ):
        published = json.loads((ROOT / "docs" / "schemas" / f"denoc.{name}-1.json").read_text(encoding="utf-8"))
        jsonschema.Draft202012Validator(published).validate(json.loads(json.dumps(document)))
    before = stamps(out)
    assert len(before) == 4
    # The command goes on with the same folder: only what changed since is asked again.
    pendulum(home / "clean.csv", 5)
    assert (
        status_of(["diagnose", "--fleet", str(home), "--model", str(nominal), "--out", str(out), "--workers", "1"]) == 1
    )
    assert {name for name, when in stamps(out).items() if when != before[name]} == {"clean.csv.json"}
    said = capfd.readouterr().out
    assert "2 of 4 units diagnosed" in said and "holds no recording" in said
    assert (out / "report.html").exists() and (out / "fleet.csv").read_text("utf-8").count("coulomb_friction") == 1
    assert json.loads((out / "fleet.json").read_text("utf-8"))["verdicts"] == {"consistent": 1, "explained": 1}


@contextmanager
def cluster(folder: Path) -> Iterator[tuple[subprocess.Popen, str]]:
    """A scheduler and a worker as processes of their own, at another port each time."""
    file = folder / f"scheduler{time.monotonic_ns()}.json"
    dask = [sys.executable, "-m"]
    common = ["--no-dashboard", "--scheduler-file", str(file)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment, "cwd": folder}
    processes = [
        subprocess.Popen(
            [*dask, "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", *common], **quiet
        )
    ]
    try:
        while not file.exists():
            time.sleep(0.1)
        worker = [*dask, "distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny", *common]
        processes.append(subprocess.Popen(worker, **quiet))
        yield processes[0], json.loads(file.read_text(encoding="utf-8"))["address"]
    finally:
        for process in processes:
            process.kill()
            process.wait()


def test_a_killed_scheduler_loses_nothing_that_was_done(tmp_path):
    pytest.importorskip("distributed")
    home, out = tmp_path / "fleet", tmp_path / "out"
    for k in range(4):
        pendulum(home / f"unit{k}.csv", k)
    nominal = model(tmp_path / "model.toml")
    command = [
        sys.executable,
        "-m",
        "harness",
        "diagnose",
        "--fleet",
        str(home),
        "--model",
        str(nominal),
        "--out",
        str(out),
    ]
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True,
               "env": {**os.environ, "PYTHONPATH": str(ROOT)}}  # fmt: skip
    with cluster(tmp_path) as (scheduler, address):
        running = subprocess.Popen([*command, "--dask", address], **options)
        until = time.monotonic() + 400.0
        while len(stamps(out)) < 2:
            assert running.poll() is None and time.monotonic() < until, running.communicate()
            time.sleep(0.05)
        scheduler.send_signal(signal.SIGKILL)
        _, said = running.communicate(timeout=120)
    assert running.returncode == 2
    lines = said.strip().splitlines()
    assert len(lines) == 1 and "is gone" in lines[0] and "same command" in lines[0]
    done = stamps(out)
    assert 2 <= len(done) < 4
    for name in done:
        assert json.loads((out / "units" / name).read_text(encoding="utf-8"))["diagnosis"]["verdict"] == "consistent"
    with cluster(tmp_path) as (_, address):
        again = subprocess.run([*command, "--dask", address], **options, check=False)
    assert again.returncode == 0, again.stderr
    after = stamps(out)
    assert len(after) == 4 and {name: after[name] for name in done} == done
    assert "4 of 4 units diagnosed" in again.stdout
