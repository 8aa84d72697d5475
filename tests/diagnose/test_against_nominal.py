"""What data held out say of the models of an answer, where the nominal one is nearer to them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.diagnose.answer.against_nominal import (
    astray,
    beside_findings,
    nothing_added,
    within_tolerances,
    worse_than_nominal,
)
from harness.diagnose.answer.explain import foretelling
from harness.diagnose.problem.hypothesis import Nominal

QUANTITIES = (Nominal("mass", "rod", 0.03), Nominal("length", "rod", 0.01))


def _rows(**errors: float) -> list[dict[str, Any]]:
    models = {name: {"train_rmse": 0.003, "heldout_rmse": error} for name, error in errors.items()}
    return [{"channel": "pivot.position", "unit": "rad", "noise_floor": 5.8e-4, **models}]


def test_what_predicts_worse_than_the_nominal_model_is_said_to() -> None:
    rows = _rows(nominal=0.0201, augmented=0.0201, predictive=0.335)
    assert foretelling(["quadratic_drag@pivot"], rows) == (
        "What predicts best by the training recordings, quadratic_drag@pivot (predictive.toml), leaves 0.34 rad of the data held "
        "out at pivot.position, more than the nominal model does (0.02 rad): what those recordings teach does not carry over to "
        "these data."
    )
    assert "the nominal model with its quantities fitted (predictive.toml)" in foretelling([], rows)


def test_nor_is_it_then_said_to_predict_better_than_what_is_claimed() -> None:
    rows = _rows(nominal=0.02, augmented=0.5, predictive=0.335)
    assert "Best predicts" not in foretelling(["quadratic_drag@pivot"], rows)
    rows = _rows(nominal=0.8, augmented=0.5, predictive=0.335)
    assert foretelling(["quadratic_drag@pivot"], rows).startswith(
        "Best predicts, by the training recordings, quadratic"
    )
    rows = _rows(nominal=0.5, augmented=0.335, predictive=0.335)
    assert foretelling(["quadratic_drag@pivot"], rows) == ""


def test_a_little_more_of_a_quiet_channel_may_be_traded_for_much_less_of_a_loud_one() -> None:
    loud, quiet = _rows(nominal=0.5, augmented=0.1), _rows(nominal=0.01, augmented=0.02)
    assert worse_than_nominal([*loud, *quiet], "augmented", 0.9) is None
    assert worse_than_nominal(quiet, "augmented", 0.9) is quiet[0]


def test_a_model_with_nothing_added_is_said_to_be_the_nominal_one_adjusted() -> None:
    text = nothing_added(QUANTITIES, np.array([-0.4, 1.6, 0.0]), _rows(nominal=0.02, augmented=0.02), beside=False)
    assert text == (
        "The model in augmented.toml is the nominal one with its quantities adjusted as their tolerances allow, most "
        "the length of rod, by +1.6 % (1.6 standard deviations of its tolerance)."
    )


def test_it_is_said_to_be_worse_on_data_held_out() -> None:
    text = nothing_added(QUANTITIES, np.array([-0.4, 0.1]), _rows(nominal=0.02, augmented=0.03), beside=False)
    assert "most the mass of rod, by -1.2 % (0.4 standard deviations" in text
    assert text.endswith(
        "; it leaves 0.03 rad of the data held out at pivot.position, more than the nominal model does (0.02 rad)."
    )


def test_errors_of_a_set_that_is_not_claimed_are_not_its_own() -> None:
    text = nothing_added(QUANTITIES, np.array([-0.4, 0.1, 7.0]), _rows(nominal=0.02, augmented=0.03), beside=True)
    assert "bent far outside their tolerances" not in text
    assert text.endswith(
        ", beside effects that are not claimed; the errors told as augmented are with these, and what is told so leaves 0.03 rad "
        "of the data held out at pivot.position, more than the nominal model does (0.02 rad)."
    )


def test_what_no_tolerance_allows_is_not_said_to_be_allowed() -> None:
    text = nothing_added(QUANTITIES, np.array([-0.4, -7.3]), _rows(nominal=0.02, augmented=0.02), beside=False)
    assert (
        "with its quantities bent far outside their tolerances, most the length of rod, by -7 % (7.3 standard" in text
    )


def test_an_error_that_is_a_twelfth_larger_is_told_by_digits_that_differ() -> None:
    text = nothing_added(QUANTITIES, np.array([-2.5, 0.1]), _rows(nominal=0.01651, augmented=0.01784), beside=False)
    assert text.endswith(
        "leaves 0.018 rad of the data held out at pivot.position, more than the nominal model does (0.017 rad)."
    )
    text = nothing_added(QUANTITIES, np.array([-2.5, 0.1]), _rows(nominal=0.1059, augmented=0.1144), beside=False)
    assert text.endswith(
        "leaves 0.114 rad of the data held out at pivot.position, more than the nominal model does (0.106 rad)."
    )


def test_findings_do_not_hide_that_the_nominal_model_foretells_better() -> None:
    (told,) = beside_findings(QUANTITIES, np.array([0.5, -0.2, 40.0]), _rows(nominal=0.118, augmented=4.35))
    assert told == (
        "The model told as augmented leaves 4.3 rad of the data held out at pivot.position, more than the nominal model does (0.12 "
        "rad): what the other recordings teach does not carry over to these data."
    )
    assert beside_findings(QUANTITIES, np.array([0.5, -4.9]), _rows(nominal=0.1, augmented=0.101)) == []


def test_findings_do_not_hide_how_far_nominal_quantities_are_bent() -> None:
    # A quantity z tolerances t off is multiplied by exp(t z).
    four = (*QUANTITIES, Nominal("damping", "pivot", 0.01), Nominal("mass", "tip", 0.01))
    (told,) = beside_findings(four, np.array([-5.4, -6.6, -17.7, -12.0]), _rows(nominal=0.1, augmented=0.001))
    assert told.startswith(
        "Beside what was found, the nominal model is bent far outside its tolerances: the damping of pivot, by -16 % (18 standard "
        "deviations of its tolerance), the mass of tip, by -11 % (12 standard deviations of its tolerance), the length of rod, by "
        "-6.4 % (6.6 standard deviations of its tolerance), and 1 more."
    )


@pytest.mark.parametrize("z", [np.zeros(2), np.array([0.3, -0.9])])
def test_nothing_is_said_of_what_is_the_nominal_model_or_as_good(z: np.ndarray) -> None:
    assert nothing_added(QUANTITIES, z, _rows(nominal=0.02, augmented=0.0201), beside=False) == ""
    assert nothing_added(QUANTITIES, z, [], beside=False) == ""
    assert nothing_added((), np.zeros(0), [], beside=True) == ""


@pytest.mark.parametrize(
    ("train", "held", "flies"),
    [(0.9, 0.9, False), (1.5, 0.9, True), (0.9, 59.0, True), (np.nan, np.nan, False)],
)
@pytest.mark.parametrize("still", [False, True])
def test_a_free_run_that_leaves_more_than_recordings_vary_is_astray(
    train: float, held: float, flies: bool, still: bool
) -> None:
    """Closed form: a swing of 1 rad has a standard deviation of 1 / √2 rad, and two that are unrelated lie 1 rad apart (RMS)."""
    swing = np.sin(np.linspace(0.0, 40.0 * np.pi, 4000, endpoint=False))
    values = np.stack([swing, np.full(4000, 0.3)])
    values[0, 5] = np.nan
    window = SimpleNamespace(run=0, first=0, last=4000)
    outcome: Any = SimpleNamespace(
        nominal=SimpleNamespace(windows=[window]), held_windows=[window],
        problem=SimpleNamespace(runs=[SimpleNamespace(values=values)]),
    )  # fmt: skip
    # A joint that stands still is left by more than it varies by any model that is not exact.
    rows = [{"unit": "rad", "nominal": {"train_rmse": 0.0, "heldout_rmse": 0.0}} for _ in range(2)]
    rows[int(still)] = {"unit": "rad", "nominal": {"train_rmse": train, "heldout_rmse": held}}
    assert astray(outcome, rows) == flies


@pytest.mark.parametrize(("bend", "inside"), [(2.9, True), (-3.1, False)])
def test_quantities_are_within_their_tolerances_up_to_three_deviations(bend: float, inside: bool) -> None:
    windows = ("all",)
    empty = SimpleNamespace(x=np.array([0.1, bend]), windows=windows)
    outcome: Any = SimpleNamespace(
        empty=empty, training=SimpleNamespace(windows=windows), predictor=SimpleNamespace(nominal=QUANTITIES)
    )
    assert within_tolerances(outcome) == inside
