"""Sets of a ranking in words."""

from __future__ import annotations

from harness.report.diagnosis.sets_in_words import first_not_likeliest, sets_in_words


def rows(*sets: str) -> list[dict[str, list[str]]]:
    return [{"effects": one.split()} for one in sets]


def test_short_sets_are_listed() -> None:
    assert sets_in_words(rows("a b", "a", "")) == ["a + b", "a", "nothing"]


def test_long_sets_are_told_by_what_differs_from_the_first() -> None:
    said = sets_in_words(
        rows("damping@a damping@b friction@a friction@b", "damping@a damping@b friction@a drag@b", "gap@a", "")
    )
    assert said == [
        "damping@a + damping@b + friction@a + friction@b", "the first less friction@b with drag@b", "gap@a", "nothing",
    ]  # fmt: skip


def test_nothing_is_said_of_no_ranking() -> None:
    assert sets_in_words([]) == []


def test_a_first_row_that_is_not_the_likeliest_is_said_to_be_what_is_told() -> None:
    rows = [{"effects": ["viscous_damping@pivot"], "bic": 110.0}, {"effects": [], "bic": 100.0}]
    assert first_not_likeliest(rows).startswith(
        "The first row is the set that this answer is of. It is not the likeliest"
    )
    assert first_not_likeliest(rows[::-1]) == first_not_likeliest([]) == ""
    # A difference that is told as 0 is none.
    assert first_not_likeliest([{"effects": [], "bic": 100.4}, rows[1]]) == ""
    assert first_not_likeliest([{"effects": [], "bic": None}, rows[1]]) == ""
