"""``denoc report`` of a results.json that somebody has edited: shown, or one line that names the place."""

import copy
import json
from typing import Any

import pytest

from harness.cases.results import from_dict
from harness.cli.main import status_of

ROW = {
    "case": "rig",
    "quantity": "acceleration",
    "engines": ["denoc", "mujoco"],
    "difference": 1e-14,
    "allowed": 1e-12,
    "unit": "1",
    "why_allowed": "rounding",
    "verdict": "pass",
}
CURVE = {
    "case": "rig",
    "figure": "trajectory",
    "label": "denoc",
    "x": [0.0, 1.0, 2.0],
    "y": [0.0, None, 4.0],
    "x_label": "time [s]",
    "y_label": "angle [rad]",
}
DOCUMENT: dict[str, Any] = {
    "schema": "denoc.results/1",
    "rows": [ROW],
    "series": [CURVE],
    "cases": {"rig": {"title": "A rig"}},
}


def test_the_document_is_one():
    assert from_dict(DOCUMENT).ok


@pytest.mark.parametrize(
    ("where", "value", "said"),
    [
        (("series", 0, "x"), [0.0, 1.0], "a line of rig, trajectory, 'denoc', has 2 x and 3 y"),
        (("series", 0, "y"), [0.0, 1e308, 4.0], "a line of rig, trajectory, 'denoc', has a number beyond 1e+200"),
        (("series", 0, "marks"), {"horizon": -1e308}, "has a number beyond 1e+200"),
        (("rows", 0, "engines"), [], "row rig/acceleration/ names no engine"),
        (("rows", 0, "verdict"), "passed", "row rig/acceleration/denoc+mujoco has the verdict 'passed'"),
        (("rows", 0, "difference"), "small", "Expected `float | null`, got `str` at rows[0].difference"),
    ],
)
def test_what_no_longer_fits_together_is_one_line(tmp_path, capsys, where, value, said):
    document = copy.deepcopy(DOCUMENT)
    target: Any = document
    for key in where[:-1]:
        target = target[key]
    target[where[-1]] = value
    (tmp_path / "results.json").write_text(json.dumps(document))
    for options in ([], ["--out", str(tmp_path / "out")]):
        assert status_of(["report", str(tmp_path), *options]) == 2
        told = capsys.readouterr().err
        assert len(told.splitlines()) == 1
        assert "results.json: " in told and said in told
    assert not (tmp_path / "out").exists()
