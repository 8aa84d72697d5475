"""What is left of efforts is said once where it is, and what was left untried is more than what was found."""

import pytest

from harness.diagnose.answer.explain import Foretold
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.inverse.effort import UNSEARCHED
from harness.diagnose.inverse.effort_words import InWords, gathered, shown_as, summary


@pytest.mark.parametrize(
    ("what", "where", "text"),
    [
        (
            "a smooth force over the state at elbow",
            ["elbow"],
            "What is left shows as a smooth force over the state (elbow).",
        ),
        (
            "a force at certain places at elbow",
            ["elbow"],
            "What is left shows as a force at certain places (elbow).",
        ),
        ("a jump of the reading", ["", ""], "What is left shows as a jump of the reading."),
    ],
)
def test_the_joint_is_named_once(what: str, where: list[str], text: str) -> None:
    assert shown_as([{"what": what, "where": where}]) == text


def test_nothing_left_is_no_sentence() -> None:
    assert shown_as([]) == ""


def test_beside_a_finding_sets_that_were_left_untried_are_further_ones() -> None:
    assert UNSEARCHED[0].startswith("further")


def test_of_joints_told_together_one_may_have_nothing_left_of_what_is_stated() -> None:
    units = {"coefficient": "N*m*s/rad"}
    absent = {"coefficient": Estimate(-0.2, None, -0.2, -0.199)}
    more = {"coefficient": Estimate(0.31, 0.01, 0.29, 0.33)}
    told = gathered(
        [InWords("viscous damping", "elbow", absent, units), InWords("viscous damping", "wrist", more, units)]
    )
    assert told == [
        "viscous damping at elbow (none of the stated 0.200 N·m·s/rad is left) and wrist (0.310 ± 0.01 N·m·s/rad)"
    ]


@pytest.mark.parametrize(
    ("verdict", "hurried", "said"),
    [
        ("partly_explained", False, "nothing in the catalogue earns its place for certain."),
        ("unexplained", False, "nothing in the catalogue earns its place."),
        ("partly_explained", True, "nothing has earned its place so far."),
        ("unexplained", True, "nothing has earned its place so far."),
    ],
)
def test_what_was_not_tried_has_not_failed(verdict: str, hurried: bool, said: str) -> None:
    text = summary(verdict, 8.0, 4.2, [], [], Foretold(), None, None, hurried=hurried)
    assert text.endswith(f"and {said}")
