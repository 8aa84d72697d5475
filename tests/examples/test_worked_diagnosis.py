"""The recordings of the diagnosis page's worked example are what the page says of them, and its command finds what is concealed."""

from __future__ import annotations

import csv
import math
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

import harness

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "examples" / "worked_diagnosis.py"
MODEL = ROOT / "models" / "urdf" / "rigid_pendulum.urdf"


def recordings(folder: Path) -> list[Path]:
    """The script's recordings in a folder."""
    subprocess.run([sys.executable, str(SCRIPT), str(folder)], check=True)
    return sorted(folder.glob("run*.csv"))


def test_recordings_begin_at_rest_where_the_script_lets_go(tmp_path):
    stated = runpy.run_path(str(SCRIPT))
    for path, release in zip(recordings(tmp_path), stated["RELEASES"], strict=True):
        with path.open(newline="") as file:
            rows = [(float(row["time"]), float(row["pivot.position"])) for row in csv.DictReader(file)]
        assert len(rows) == stated["RATE"] * stated["DURATION"]
        # At rest the pendulum falls by half of m g l sin(release) / J times time squared; friction takes away torque / J of it.
        falls = (stated["MOMENT"] * math.sin(release) - stated["FRICTION"]) / stated["INERTIA"]
        for time, angle in rows[:10]:
            assert angle == pytest.approx(release - 0.5 * falls * time**2, abs=5.0 * stated["NOISE"])


@pytest.mark.slow
def test_the_friction_is_found_and_nothing_else(tmp_path):
    friction = runpy.run_path(str(SCRIPT))["FRICTION"]
    found = harness.diagnose(recordings(tmp_path), model=MODEL)
    assert found.verdict == "explained"
    assert [finding["effect"] for finding in found.findings] == ["coulomb_friction"]
    low, high = found.findings[0]["parameters"]["torque"]["ci95"]
    assert low < friction < high
