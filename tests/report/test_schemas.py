"""Every file for programs is what its published schema says."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from diagnosed import document

from harness.cases.case import Row, Series
from harness.cases.results import Results
from harness.cli.main import status_of
from harness.compare.bench import Row as BenchRow
from harness.compare.bench import document as bench_document
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.json_text import json_text
from harness.proof.run import Proof
from harness.proof.score import summarise

jsonschema = pytest.importorskip("jsonschema", reason="jsonschema is not installed")

ROOT = Path(__file__).parents[2]
SCHEMAS = ROOT / "docs" / "schemas"
PENDULUM = str(ROOT / "models" / "urdf" / "rigid_pendulum.urdf")
STRIP = str(ROOT / "models" / "toml" / "flexible_pendulum.toml")


def schema(name: str) -> dict:
    return json.loads((SCHEMAS / f"{name.replace('/', '-')}.json").read_text(encoding="utf-8"))


def check(found: dict) -> None:
    """The document against the schema that it names, strictly as JSON."""
    plain = json.loads(json_text(found))
    jsonschema.Draft202012Validator(schema(plain["schema"])).validate(plain)


def test_every_schema_of_the_product_is_published_and_sound():
    named = set()
    for file in (ROOT / "harness").rglob("*.py"):
        named |= set(re.findall(r"\"(denoc\.[a-z]+/\d+)\"", file.read_text(encoding="utf-8")))
    published = {path.stem.replace("-", "/") for path in SCHEMAS.glob("*.json")}
    assert named == published and len(named) >= 8
    page = (ROOT / "docs" / "schemas.md").read_text(encoding="utf-8")
    for name in named:
        jsonschema.Draft202012Validator.check_schema(schema(name))
        assert f"schemas/{name.replace('/', '-')}.json" in page


def test_results():
    rows = (
        Row("swing", "period", ("denoc", "mujoco"), 1e-9, 1e-8, "1", "rounding", "pass"),
        Row(
            "swing",
            "angle",
            ("denoc", "exudyn"),
            float("nan"),
            1e-8,
            "rad",
            "step",
            "fail",
            first_divergence={"time": 3.2},
        ),
        Row("fall", "tip", ("denoc", "pinocchio"), None, None, "m", "", "skipped", "no beams"),
    )
    line = Series("swing", "trajectory", "denoc", (0.0, 1.0), (0.1, float("nan")), "time [s]", "angle [rad]")
    check(Results(rows, (line,), {"numpy": "2"}, {"swing": "A swing"}, "2026-01-02", 3.0, {"swing": 3.0}).to_json())


def test_a_diagnosis_with_all_it_may_have():
    check(document())
    fields = (
        "verdict",
        "summary",
        "noise",
        "mismatch",
        "findings",
        "ranking",
        "fit",
        "remainder",
        "next_experiment",
        "provenance",
    )
    check(
        Diagnosis(
            **{name: document()[name] for name in fields}, correlations={"parameters": ["a", "b"], "matrix": np.eye(2)}
        ).to_json()
    )


@pytest.mark.parametrize(
    "wrong",
    [{"verdict": "fine"}, {"findings": [{"effect": "x"}]}, {"noise": [{"channel": "a"}]}, {"explained_share": "most"}],
)
def test_the_schema_refuses_what_is_not_a_diagnosis(wrong):
    with pytest.raises(jsonschema.ValidationError):
        check({**document(), **wrong})


@pytest.mark.parametrize(
    "arguments",
    [
        ("simulate", PENDULUM, "--duration", "0.1"),
        ("view", PENDULUM, "--duration", "0.1"),
        ("audit", STRIP),
        ("doctor",),
        ("paper", "departure", "--draws", "1", "--seed", "3"),
    ],
    ids=lambda a: a[0],
)
def test_what_verbs_write(arguments, tmp_path, capfd):
    out = tmp_path / "answer.json"
    assert status_of([*arguments, "--json", str(out)]) == 0
    check(json.loads(out.read_text(encoding="utf-8")))


def test_bench():
    rows = [
        BenchRow("forward_dynamics", 7, "pinocchio", 1e-7, 3e-7),
        BenchRow("x", None, "mujoco", None, None, note="absent"),
    ]
    check(bench_document(rows, {"cpu": "x"}))


def test_proof():
    check(Proof(7, 0, (), summarise([], 2.0), {}).to_json())


def test_the_accepted_figures_in_the_project():
    found = json.loads((ROOT / "reference" / "accepted.json").read_text(encoding="utf-8"))
    check(found)
