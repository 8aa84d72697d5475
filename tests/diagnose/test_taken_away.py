"""Where all the dissipation that a model states is taken away, an answer says that none of it is left."""

from __future__ import annotations

from typing import Any

import pytest
from rich.console import Console

from harness.diagnose.answer.explain import finding_words
from harness.diagnose.answer.findings import Findings
from harness.diagnose.answer.taken_away import none_left
from harness.diagnose.estimation.intervals import Estimate
from harness.effects.catalogue import catalogue
from harness.report.diagnosis.sections.findings import Findings as FindingsOfAPage
from harness.report.diagnosis.terminal import print_diagnosis

UNIT = "N*m*s/rad"
AT_BOUND = Estimate(-0.0002349989, None, -0.000235, -0.0002349642)
NONE = "none of the stated 0.000235 N·m·s/rad is left"


def _document() -> dict[str, Any]:
    e = AT_BOUND
    number = {"value": e.value, "std": e.std, "ci95": [e.low, e.high], "unit": UNIT}
    finding = {
        "effect": "viscous_damping", "site": "pendulum", "parameters": {"coefficient": number}, "grade": "possible",
        "evidence": {"delta_bic": 115045.0}, "indistinguishable_from": [],
    }  # fmt: skip
    return {"verdict": "partly_explained", "summary": "It is said.", "findings": [finding], "fit": []}


@pytest.mark.parametrize("name", ["viscous_damping", "coulomb_friction"])
def test_a_finding_in_words_says_it_instead_of_a_negative_number(name: str) -> None:
    words = finding_words(catalogue()[name].title, "pendulum", {"x": AT_BOUND}, {"x": UNIT})
    assert words == f"{catalogue()[name].title} at pendulum ({NONE})"


def test_what_may_be_left_by_the_interval_is_told_with_it() -> None:
    words = none_left("viscous_damping", -0.2, None, (-0.2, -0.13), "N·m·s/rad")
    assert words == "none of the stated 0.200 N·m·s/rad is left, 35 % at most (95 %)"


@pytest.mark.parametrize(
    ("effect", "value", "std"),
    [
        ("viscous_damping", -0.1, 0.03),  # some of it is left
        ("viscous_damping", 0.0, None),  # at another bound: none is added
        ("added_inertia", -0.2, None),  # adds to nothing that is stated
    ],
)
def test_nothing_is_said_of_other_numbers(effect: str, value: float, std: float | None) -> None:
    assert none_left(effect, value, std, (-0.2, 0.1), "") == ""


def test_tables_say_it_too(capsys: pytest.CaptureFixture[str]) -> None:
    document = _document()
    print_diagnosis(document, Console(width=200, color_system=None))
    assert f"coefficient = -0.000235 N·m·s/rad: {NONE}" in capsys.readouterr().out
    assert f"coefficient ({NONE})" in str(Findings(document["findings"]))
    page = FindingsOfAPage().content(document)
    assert page is not None and page["rows"][0]["remark"] == NONE
