"""The sentence of an answer, where all that was found is no more than possible."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from harness.diagnose.answer.explain import summary
from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.criticism.remainder import Remains
from harness.diagnose.problem.hypothesis import Hypothesis


def _conclusion(verdict: str) -> Conclusion:
    fit = cast(Any, SimpleNamespace(hypothesis=Hypothesis()))
    return Conclusion(verdict, fit, fit, fit, (), Remains(False, (), 0.0), (), 1.4)


@pytest.mark.parametrize("verdict", ["partly_explained", "explained"])
def test_nothing_is_said_to_hold_up_that_is_not_named(verdict: str) -> None:
    text = summary(_conclusion(verdict), 30.0, [], [], 1.4)
    assert text == (
        "The nominal model leaves the recordings by 30 times the noise, and nothing in the catalogue earns its place for certain."
    )


def test_what_is_named_holds_up() -> None:
    text = summary(_conclusion("partly_explained"), 30.0, ["viscous damping at pivot"], [], 1.4)
    assert "; viscous damping at pivot holds up on data held out, but" in text
