"""Second encoders beside a model that predicts best: their rows lack its errors, and the answer is whole all the same."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from rich.console import Console
from test_second_encoders import model, written

from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.explain import foretelling
from harness.diagnose.transmission.second_encoders import parted
from harness.diagnose.transmission.transmission import links_apart, with_second_encoders
from harness.recording import read_recordings
from harness.report.diagnosis import print_diagnosis, write_diagnosis
from harness.system import load


def test_an_answer_with_second_encoders_beside_a_predictive_model_is_shown_and_written(tmp_path: Path) -> None:
    """A joint that is rigid, so that there is nothing but rows to add; only the drive's row has the predictive model's errors."""
    system = load(model(tmp_path))
    read, second = parted(read_recordings(written(tmp_path, stiffness=np.inf), system=system))
    drive = {"channel": "shoulder.position", "unit": "rad", "noise_floor": 1e-5}
    errors = {name: {"train_rmse": 2e-3, "heldout_rmse": 2e-3} for name in ("nominal", "refitted", "augmented")}
    row = {**drive, **errors, "predictive": {"train_rmse": 1.25e-3, "heldout_rmse": 1.75e-3}}
    alone = Diagnosis(
        "unexplained", "Something is left.", [], [], [], [], [row], {}, {}, predicting=["quadratic_drag@shoulder"],
        predictive=system,
    )  # fmt: skip
    found = with_second_encoders(alone, system, read, None, links_apart(system, read, None, second))
    assert [r["channel"] for r in found.fit] == ["shoulder.position", "shoulder.link_position"]

    screen = Console(file=io.StringIO(), width=160)
    print_diagnosis(found.to_json(), screen)
    (line,) = [line for line in screen.file.getvalue().splitlines() if line.startswith("shoulder.link_position")]
    assert line.split()[-3:-1] == ["–", "–"]
    # Whichever row comes first, the predictive model's columns are there.
    screen = Console(file=io.StringIO(), width=160)
    print_diagnosis({**found.to_json(), "fit": list(reversed(found.fit))}, screen)
    assert "0.00175" in screen.file.getvalue()
    assert foretelling(found.predicting, found.fit).startswith("Best predicts")

    files = {path.name: path for path in write_diagnosis(found, tmp_path / "out")}
    assert {"diagnosis.json", "report.html", "predictive.toml"} <= set(files)
    assert "0.00175" in files["report.html"].read_text(encoding="utf-8")
