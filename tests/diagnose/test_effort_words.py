"""What is left of efforts is said once where it is, and what was left untried is more than what was found."""

import pytest

from harness.diagnose.inverse.effort import UNSEARCHED
from harness.diagnose.inverse.effort_words import shown_as


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
