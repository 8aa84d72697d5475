"""What Python shows of a system, a model, results, recordings and a diagnosis."""

from __future__ import annotations

import builtins
from pathlib import Path

import numpy as np
import pytest
from diagnosed import document
from lxml import html as lxml_html

import harness
from harness.cases.case import Row
from harness.cases.results import Results
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.recording import read_recording

MODELS = Path(__file__).parents[2] / "models"
FIELDS = ("verdict", "summary", "noise", "mismatch", "findings", "ranking", "fit", "remainder", "next_experiment")
ROWS = (
    Row("swing", "period", ("denoc", "mujoco"), 1e-9, 1e-8, "1", "rounding", "pass"),
    Row("swing", "<angle>", ("denoc", "exudyn"), 8e-9, 1e-8, "rad", "step", "pass"),
    Row("fall", "energy", ("denoc", "analytic"), 2e-3, 1e-8, "1", "rounding", "fail"),
    Row("fall", "tip", ("denoc", "pinocchio"), None, None, "m", "", "skipped", "no beams"),
)


def diagnosis() -> Diagnosis:
    return Diagnosis(**{name: document()[name] for name in FIELDS})


@pytest.mark.parametrize("name", ["urdf/double_pendulum.urdf", "toml/flexible_pendulum.toml"])
def test_systems_and_models_are_short_in_a_line_and_whole_in_a_table(name):
    system = harness.load(MODELS / name)
    model = harness.Denoc(system)
    for shown in (system, model):
        assert len(repr(shown)) < 120 and system.name in repr(shown)
        table = lxml_html.fromstring(shown._repr_html_())
        text = table.text_content()
        assert repr(system).count(" links") == (len(system.links) > 1)
        for joint, link in zip(system.joints, system.links, strict=True):
            assert joint.name in text and link.name in text
        assert len(table.findall(".//tbody/tr")) == len(system.joints)


def test_results_show_the_worst_of_every_case_and_become_a_frame():
    results = Results(ROWS)
    assert repr(results) == "<Results: 2 pass, 1 fail, 1 skipped>"
    cells = [[cell.text for cell in row] for row in lxml_html.fromstring(results._repr_html_()).findall(".//tbody/tr")]
    assert [row[:2] for row in cells] == [["swing", "<angle>"], ["fall", "energy"]]
    frame = results.to_frame()
    assert list(frame["verdict"]) == [row.verdict for row in ROWS]
    assert frame["difference"][1] == 8e-9 and frame["engines"][0] == "denoc / mujoco"
    assert "<angle>" in str(results)


def test_a_diagnosis_prints_its_table():
    found = diagnosis()
    text = str(found)
    for word in (
        "partly_explained",
        "coulomb_friction",
        "0.0118",
        "0.0114 … 0.0122",
        "N·m",
        "base_tilt",
        "geometric_stiffening",
    ):
        assert word in text
    assert repr(found) == "<Diagnosis: partly_explained, coulomb_friction@pivot, geometric_stiffening@rod>"
    rows = lxml_html.fromstring(found._repr_html_()).findall(".//tbody/tr")
    assert len(rows) == 2


def test_findings_become_a_frame_a_row_a_parameter():
    found = diagnosis()
    for frame in (found.to_frame(), found.findings.to_frame()):
        row = frame[frame["parameter"] == "torque"].iloc[0]
        assert (row["value"], row["low"], row["high"], row["unit"]) == (0.0118, 0.0114, 0.0122, "N*m")
        assert list(frame["effect"]) == ["coulomb_friction", "geometric_stiffening"]
    assert found.to_json()["findings"] == document()["findings"]


def test_nothing_found_is_an_empty_frame():
    found = Diagnosis(**{**{name: document()[name] for name in FIELDS}, "findings": []})
    assert len(found.to_frame()) == 0 and "value" in found.to_frame()
    assert "coulomb" not in str(found).split("\n\n", 1)[-1].replace(found.summary, "")


def test_recordings_show_their_channels_and_become_a_frame(tmp_path):
    file = tmp_path / "run.csv"
    time = np.arange(100) / 50.0
    angle = np.sin(time)
    rows = "\n".join(f"{t:.4f},{np.degrees(a):.12f}" for t, a in zip(time, angle, strict=True))
    file.write_text("time,pivot.position [deg]\n" + rows + "\n", encoding="utf-8")
    run = read_recording(file)
    assert repr(run) == "<Recording 'run': 100 samples over 1.98 s, pivot.position>"
    assert "pivot.position" in run._repr_html_()
    frame = run.to_frame()
    assert frame.index.name == "time" and np.allclose(frame.index, time, atol=1e-12)
    assert np.allclose(frame["pivot.position"], angle, atol=1e-12)  # written in degrees, read in rad


def test_without_pandas_a_frame_says_what_it_needs(monkeypatch):
    whole = builtins.__import__

    def without(name, *rest, **options):
        if name == "pandas":
            raise ImportError(name)
        return whole(name, *rest, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match=r"needs pandas \(pip install pandas\)"):
        Results(ROWS).to_frame()
