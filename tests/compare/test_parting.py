"""From when on motions part, and by what: on motions whose integration errs by construction."""

from __future__ import annotations

import numpy as np
import pytest

from harness.compare.parting import Finer, Motion, parting

TIME = np.linspace(0.0, 10.0, 501)
SWING = np.sin(3.0 * TIME)[:, None]
LINE = 1e-6


def motion(engine, position, moves=None):
    """``moves``: what finer integration changes; None of one that answers to no step."""
    return Motion(engine, position, Finer("half the step", None if moves is None else position - moves))


def test_what_finer_integration_does_not_change_is_the_model():
    found = parting(TIME, motion("a", SWING, 1e-12), motion("b", SWING + 1e-3, 1e-9), LINE)
    assert (found.cause, found.begins) == ("model", 0)
    assert found.words == "half the step moves a by 1.0e-12, b by 1.0e-09: it is the model, not the integration"


def test_where_the_equations_agree_it_is_the_run():
    found = parting(TIME, motion("a", SWING, 0.0), motion("b", SWING + 1e-3, 1e-9), LINE, one_equation=True)
    assert found.cause == "run"
    assert "model" not in found.words


def test_what_finer_integration_takes_away_is_the_solver():
    error = 1e-4 * TIME[:, None]
    found = parting(TIME, motion("a", SWING, 0.0), motion("b", SWING + error, 0.5 * error), LINE)
    assert (found.cause, found.begins) == ("solver", None)
    assert "leaves 1.0e-06: it is the integration, and the model is not judged" in found.words


def test_no_verdict_below_what_integration_makes():
    found = parting(TIME, motion("a", SWING, 0.0), motion("b", SWING + 2e-6, -1e-6), LINE)
    assert (found.cause, found.begins) == ("", None)
    assert "no verdict" in found.words


@pytest.mark.parametrize("one_equation", [False, True])
def test_of_an_engine_that_answers_to_no_step_nothing_is_said_of_the_model(one_equation):
    found = parting(TIME, motion("a", SWING, 1e-12), motion("b", SWING + 1e-3), LINE, one_equation=one_equation)
    assert found.cause == ""
    assert "b answers to no step" in found.words
    assert "it is the model" not in found.words


def test_the_beginning_is_where_the_difference_shows_and_not_where_it_leaves_the_line():
    apart = np.where(TIME > 5.0, 1e-4 * (TIME - 5.0) ** 2, 0.0)[:, None]
    found = parting(TIME, motion("a", SWING, 1e-9), motion("b", SWING + apart, 1e-9), 1e-4)
    assert found.place(TIME) == {"begins": pytest.approx(5.02), "cause": "model"}


def test_chaos_later_on_hides_no_difference_that_was_clear_before():
    grown = np.minimum(1e-12 * np.exp(3.0 * TIME), 1.0)[:, None]
    found = parting(TIME, motion("a", SWING, grown), motion("b", SWING + np.minimum(1e5 * grown, 1.0), grown), LINE)
    assert found.cause == "model"
    assert " up to " in found.words


@pytest.mark.parametrize(("again", "cause"), [(0.0, "solver"), (np.nan, "")])
def test_what_is_no_number_is_said_and_whether_finer_integration_mends_it(again, cause):
    broken = np.where(TIME[:, None] < 6.0, SWING, np.nan)
    finer = np.where(TIME[:, None] < 6.0, SWING, SWING + again)
    found = parting(TIME, motion("a", SWING, 0.0), Motion("b", broken, Finer("half the step", finer)), LINE)
    assert found.cause == cause
    assert found.words.startswith("b gives no finite number at 6 s")
