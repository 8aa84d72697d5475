"""A number of the diagnosis is changed in its table before anything is imported, and what follows from it follows."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[2] / "benchmarks"
ASKED = """
import sys
sys.path.insert(0, {scripts!r})
from changed_numbers import before_import
read = set()
before_import(("harness.diagnose.problem.constants", {name!r}, {factor}), read)
from harness.diagnose.problem import constants as problem
from harness.diagnose.selection.constants.weighing import HOPED_EVIDENCE
print(problem.UNPARTED_EVIDENCE, HOPED_EVIDENCE, problem.COHERENCE_SEGMENT, problem.COHERENT_CHANCE)
"""


def _with(name: str, factor: float) -> list[float]:
    code = ASKED.format(scripts=str(SCRIPTS), name=name, factor=factor)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return [float(word) for word in done.stdout.split()]


def test_what_follows_from_a_number_follows() -> None:
    as_is = _with("UNPARTED_EVIDENCE", 1.0)
    assert _with("UNPARTED_EVIDENCE", 2.0) == [2.0 * as_is[0], 2.0 * as_is[1], *as_is[2:]]
    assert _with("COHERENCE_SEGMENT", 0.5) == [*as_is[:2], as_is[2] / 2.0, as_is[3]]


@pytest.fixture
def scripts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(SCRIPTS))


def test_shares_stay_shares_and_counts_stay_counts(scripts: None) -> None:
    from changed_numbers import changed

    assert changed(0.3, 2.0) == 0.6
    assert changed(0.9, 2.0) == pytest.approx(0.8)
    assert changed(0.9, 0.5) == pytest.approx(0.95)
    assert changed(5, 0.5) == 2 and changed(1, 0.5) == 1
    assert changed((2.0, (3, 0.2)), 2.0) == (4.0, (6, 0.4))
    assert changed({"rad": 0.02}, 0.5) == {"rad": 0.01}


def test_every_number_that_was_not_derived_is_tried(scripts: None) -> None:
    from changed_numbers import numbers, tables

    names = {name for _, name, _ in numbers()}
    assert {"UNPARTED_EVIDENCE", "COMPLETE_RESIDUAL_RATIO", "STOP_PLACES"} <= names
    assert not {"QUARTER_TURN", "NORMAL_95", "HOPED_EVIDENCE"} & names
    assert "harness.diagnose.selection.constants.weighing" in tables()


def test_answers_differ_by_what_is_told(scripts: None) -> None:
    from sensitivity import differences

    one = {
        "verdict": "explained", "findings": ["a@b established"], "class": [[]], "estimates": [[1.0, 0.1]], "right": True,
    }  # fmt: skip
    assert differences(one, one) == []
    assert differences(one, {**one, "estimates": [[1.005, 0.1]]}) == []
    assert differences(one, {**one, "estimates": [[1.02, 0.1]]}) == ["estimates"]
    assert differences(one, {**one, "findings": [], "class": [], "right": False}) == ["findings", "class", "right"]
    assert differences(one, {"error": "no"}) == ["error"]
