"""What ``denoc simulate`` writes, diagnosed with the model that wrote it: nothing is missing, however little the noise."""

from pathlib import Path

import pytest

import harness
from harness.cli.main import status_of

MODEL = Path(__file__).parents[2] / "models" / "urdf" / "rigid_pendulum.urdf"


@pytest.mark.slow
def test_a_simulated_recording_is_consistent_with_its_model(tmp_path):
    run = tmp_path / "run.csv"
    start = ("--position", "pivot=70[deg]", "--velocity", "pivot=30[rpm]")
    assert status_of(["simulate", str(MODEL), "--duration", "1", *start, "--out", str(run)]) == 0
    found = harness.diagnose([str(run)], model=str(MODEL))
    assert found.verdict == "consistent"
    assert not found.findings
