"""The sentence of an answer, where all that was found is no more than possible."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest

from harness.diagnose.answer.explain import Foretold, left_in_words, summary
from harness.diagnose.answer.left_out import AtJoint, LeftOut
from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.claims.cut_short import UNCRITICISED, UNJUDGED
from harness.diagnose.criticism.left_force import Place
from harness.diagnose.criticism.remainder import Remains
from harness.diagnose.problem.hypothesis import Hypothesis


def _conclusion(verdict: str) -> Conclusion:
    fit = cast(Any, SimpleNamespace(hypothesis=Hypothesis()))
    return Conclusion(verdict, fit, fit, fit, (), Remains(False, (), 0.0), (), 1.4)


@pytest.mark.parametrize("verdict", ["partly_explained", "explained"])
def test_nothing_is_said_to_hold_up_that_is_not_named(verdict: str) -> None:
    text = summary(_conclusion(verdict), 30.0, [], [], Foretold(1.4))
    assert text == (
        "The nominal model leaves the recordings by 30 times the noise, and nothing in the catalogue earns its place for certain."
    )


def test_what_is_named_holds_up() -> None:
    text = summary(_conclusion("partly_explained"), 30.0, ["viscous damping at pivot"], [], Foretold(1.4))
    assert "; viscous damping at pivot holds up on data held out, but" in text


def test_what_training_leaves_open_is_told_of_the_data_held_out() -> None:
    loosely = replace(_conclusion("explained"), loosely=True)
    text = summary(loosely, 30.0, ["viscous damping at pivot"], [], Foretold(2.5))
    assert text.endswith(
        "with viscous damping at pivot the residual is at the noise floor, also on data held out, as far as the training "
        "recordings fix the numbers; their likeliest values alone predict those to 2.5 times the noise."
    )


LEFT = LeftOut((AtJoint("servo", 0.048, "N*m", 0.058, 0.026),), None)


@pytest.mark.parametrize(("explained", "said"), [(0.99, True), (0.3, False), (None, False)])
def test_plain_laws_that_may_only_be_possible_are_told_as_that_where_they_remove_most(
    explained: float | None, said: bool
) -> None:
    text = summary(
        _conclusion("partly_explained"),
        46.6,
        [],
        [],
        Foretold(5.3),
        explained,
        LEFT,
        ["payload at arm (mass 0.339 kg)"],
    )
    assert text.startswith(
        "The nominal model leaves the recordings by 46.6 times the sensors' noise, and nothing in the catalogue earns its place "
        "for certain. "
    )
    words = (
        "Possibly it is payload at arm (mass 0.339 kg): that would remove 99 % of the mismatch on data held out, but a force over "
        "position and speed that nobody has named could do the same. "
    )
    assert (words in text) == said == ("payload" in text)


@pytest.mark.parametrize(
    ("hurried", "doubt"),
    [
        (True, "what else could do the same has not been gone through."),
        (False, "that it is this, and not something that does nearly the same, is not sure."),
    ],
)
@pytest.mark.parametrize(("explained", "said"), [(0.98, True), (0.3, False), (None, False)])
def test_they_are_told_where_no_force_was_weighed_too(
    explained: float | None, said: bool, hurried: bool, doubt: str
) -> None:
    conclusion = replace(_conclusion("partly_explained"), hurried=hurried)
    laws = ["viscous damping at pivot (coefficient 0.0003 N·m·s/rad)", "added inertia at pivot (inertia 0.001 kg·m²)"]
    text = summary(conclusion, 132.0, [], [], Foretold(2.3), explained, None, laws)
    certain = (
        "nothing has earned its place so far." if hurried else "nothing in the catalogue earns its place for certain."
    )
    certain = f"by 132 times the noise, and {certain}"
    words = (
        f" Possibly it is {' and '.join(laws)}: that would remove 98 % of the mismatch on data held out, but {doubt}"
    )
    assert text.endswith(certain + (words if said else ""))


def test_what_is_left_is_told_in_the_channels_unit_against_its_noise_and_as_a_force() -> None:
    rows = [
        {"channel": "servo.position", "unit": "rad", "noise_floor": 1e-5, "augmented": {"heldout_rmse": 0.0043}},
        {"channel": "servo.velocity", "unit": "rad/s", "noise_floor": 1e-2, "augmented": {"heldout_rmse": 0.05}},
    ]
    text = summary(
        _conclusion("partly_explained"), 2023.0, ["dry friction at servo"], [], Foretold.worst(rows), 0.9, LEFT
    )
    assert text.startswith("The nominal model leaves the recordings by 2,020 times the sensors' noise; ")
    assert (
        "What is left of the data held out is 0.0043 rad at servo.position, 430 times the sensors' noise: "
        "a force of 0.048 N·m at servo, 5.8 % of the largest that gravity or inertia make there"
    ) in text


def test_errors_that_there_was_no_time_for_are_no_numbers() -> None:
    text = summary(_conclusion("unexplained"), float("nan"), [], [], Foretold(), None, LEFT)
    assert "nan" not in text and "0 times" not in text
    assert text.startswith(
        "The nominal model leaves the recordings to an extent that has not been worked out, and nothing "
    )
    assert "What is left of the data held out is a force of 0.048 N·m at servo" in text


def test_a_catalogue_that_was_not_gone_through_is_not_said_to_hold_nothing() -> None:
    whole = summary(_conclusion("unexplained"), 30.0, [], [], Foretold(1.4))
    cut = summary(replace(_conclusion("unexplained"), hurried=True), 30.0, [], [], Foretold(1.4))
    assert whole.endswith("nothing in the catalogue earns its place.")
    assert cut.endswith("nothing has earned its place so far.")


def test_a_set_that_was_cut_short_tells_what_it_removes_of_data_held_out() -> None:
    cut = replace(_conclusion("unexplained"), cut_short=UNJUDGED, hurried=True)
    text = summary(cut, 30.0, [], [], Foretold(1.4), 0.93)
    assert text.endswith(
        "it removes 93 % of the mismatch on data held out, but which of its effects stand there was not examined, so nothing is "
        "claimed."
    )
    for unknown in (None, -0.2):
        text = summary(cut, 30.0, [], [], Foretold(), unknown)
        assert text.endswith("it has not been judged on data held out, so nothing is claimed.")


@pytest.mark.parametrize(("left", "noise"), [(None, "the noise"), (LEFT, "the sensors' noise")])
def test_where_the_time_ended_what_the_table_has_of_plain_laws_is_told(left: LeftOut | None, noise: str) -> None:
    cut = replace(_conclusion("partly_explained"), cut_short=UNCRITICISED, hurried=True)
    laws = ["Coulomb (dry) friction at pendulum (torque 0.000379 N·m)"]
    text = summary(cut, 25.6, [], [], Foretold(10.9), 0.96, left, laws)
    assert text.startswith(
        f"The nominal model leaves the recordings by 25.6 times {noise}, and nothing has earned its place so far. Possibly it is "
        "Coulomb (dry) friction at pendulum (torque 0.000379 N·m): that would remove 96 % of the mismatch on data held out, but "
        "what else could do the same has not been gone through."
    )


def test_a_catalogue_that_was_not_gone_through_beside_a_force_is_not_said_to_hold_nothing() -> None:
    cut = replace(_conclusion("unexplained"), hurried=True)
    assert "nothing has earned its place so far." in summary(cut, 556.0, [], [], Foretold(35.0), None, LEFT)


def test_a_set_that_was_not_judged_beside_a_force_is_told_as_that() -> None:
    cut = replace(_conclusion("unexplained"), cut_short=UNJUDGED, hurried=True)
    text = summary(cut, 30.0, [], [], Foretold(1.4), 0.93, LEFT)
    assert "sensors' noise. The best set so far is nothing; it removes 93 %" in text
    assert "so nothing is claimed. What is left of the data held out is" in text


def test_findings_are_not_said_to_remove_alone_what_they_remove_with_others() -> None:
    firm = ["dry friction at servo"]
    alone = summary(_conclusion("partly_explained"), 30.0, firm, [], Foretold(5.0), 0.9, LEFT)
    assert "dry friction at servo holds up on data held out and removes 90 % of the mismatch there." in alone
    both = summary(_conclusion("partly_explained"), 30.0, firm, [], Foretold(5.0), 0.9, LEFT, beside=True)
    assert "holds up on data held out and, with what is told as possible in the table, removes 90 % of" in both
    whole = summary(_conclusion("explained"), 30.0, firm, [], Foretold(1.0), 0.99, beside=True)
    assert (
        "with dry friction at servo, and what is told as possible in the table, the residual is at the noise" in whole
    )


def test_a_remainder_whose_tests_had_no_time_is_said_to_show_as_nothing() -> None:
    untested = replace(_conclusion("partly_explained"), remains=Remains(True, (), 5.0))
    assert "What is left shows as" not in summary(untested, 30.0, ["dry friction at servo"], [], Foretold(5.0))


def test_a_channel_and_a_force_at_another_joint_are_told_in_sentences_of_their_own() -> None:
    arm = LeftOut((AtJoint("pan", 38.0, "N*m", 0.2, 0.5), AtJoint("wrist", 5.0, "N*m", 1.0, 0.89)), None)
    apart = left_in_words(arm, Foretold(46.0, 38.0, "pan.effort", "N*m"), "the noise")
    assert apart == [
        "What is left of the data held out is 38 N·m at pan.effort, 46 times the noise.",
        "Against what else acts at a joint, most is left at wrist: a force of 5 N·m, 100 % of the largest that gravity or inertia "
        "make there, which keeps for about 0.89 s.",
    ]
    here = left_in_words(arm, Foretold(46.0, 38.0, "wrist.effort", "N*m"), "the noise")
    assert here == [
        "What is left of the data held out is 38 N·m at wrist.effort, 46 times the noise: a force of 5 N·m at wrist, 100 % of the "
        "largest that gravity or inertia make there, which keeps for about 0.89 s."
    ]


def test_a_force_larger_than_what_acts_there_is_told_in_times_of_it() -> None:
    large = LeftOut((AtJoint("servo", 3.5, "N*m", 1.285, 0.056),), None)
    (told,) = left_in_words(large, Foretold(), "the noise")
    assert "3.5 N·m at servo, 1.3 times the largest that gravity or inertia make there" in told


@pytest.mark.parametrize(("left", "noise"), [(None, "the noise"), (LEFT, "the sensors' noise")])
def test_what_the_tolerances_allow_is_told_where_nothing_else_is(left: LeftOut | None, noise: str) -> None:
    nothing, friction = _conclusion("unexplained"), ["dry friction at servo"]
    within = (
        f"leaves the recordings by 17.8 times {noise} (within its tolerances it leaves 1.1 times {noise}), and nothing"
    )
    assert within in summary(nothing, 17.8, [], [], Foretold(1.1), None, left, within=1.09)
    assert "tolerances" not in summary(nothing, 17.8, [], [], Foretold(1.1), None, left, within=9.0)
    told = summary(_conclusion("partly_explained"), 17.8, friction, [], Foretold(1.1), None, left, within=1.09)
    assert "tolerances" not in told


@pytest.mark.parametrize("left", [None, LEFT])
def test_a_model_that_flies_off_is_said_not_to_follow_the_recordings(left: LeftOut | None) -> None:
    """How far it has got by the end is no size of anything."""
    friction = ["dry friction at gear"]
    text = summary(
        _conclusion("partly_explained"), 1.16e6, friction, [], Foretold(1500.0), 0.99999995, left, astray=True
    )
    assert text.startswith(
        "The nominal model does not follow the recordings, which it leaves by more than they vary; dry friction at gear holds up "
    )
    assert "1,160,000" not in text and "99.99" not in text
    assert ("removes more than 99.9 % of the mismatch there" in text) == (left is not None)


def test_most_of_what_is_left_begins_a_sentence() -> None:
    left = LeftOut(LEFT.joints, Place("pivot", "moving forwards", 0.9998, 0.33))
    assert left_in_words(left, Foretold(), "the noise")[-1] == (
        "More than 99.9 % of it lies at pivot moving forwards, in 33 % of the time."
    )
