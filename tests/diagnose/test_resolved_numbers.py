"""Values and intervals show what parts them, and no more."""

import pytest

from harness.diagnose.answer.significant_digits import ends, resolved, spread


@pytest.mark.parametrize(
    ("value", "width", "text"),
    [
        (-0.060224, 2.3e-4, "-0.06022"),
        (0.06, 1e-4, "0.06000"),
        (0.0118, 8e-4, "0.0118"),
        (0.0118, None, "0.0118"),
        (0.0118, 0.0, "0.0118"),
        (0.0, 0.1, "0.00"),
        (1234.5, 3.0, "1234.5"),
        (1234.5, 8.0, "1234"),
        (1234.0, 400.0, "1.23e+03"),
        (12.0, 50.0, "12.0"),
        (2.5e-5, 0.026, "0.000"),
        (-2.5e-5, 0.026, "0.000"),
        (3.0, 400.0, "0"),
        (24.0, 9e-16, "24.0"),
        (None, 1.0, "–"),
    ],
)
def test_digits_show_a_fifth_of_the_width(value: float | None, width: float | None, text: str) -> None:
    assert resolved(value, width) == text


def test_the_ends_of_a_narrow_interval_differ() -> None:
    assert ends([-0.060338, -0.060111]) == "-0.06034 … -0.06011"


def test_an_end_that_is_not_known_is_a_dash() -> None:
    assert ends([None, 0.25]) == "– … 0.250"
    assert ends(None) == ""


@pytest.mark.parametrize(
    ("value", "std", "interval", "text"),
    [
        (0.5, 0.01, (0.48, 0.52), " ± 0.01"),
        (0.5, 0.01, (0.47, 0.53), " ± 0.01"),
        # Farther to one side than twice what the deviation says: another valley, or a number that only one side bounds.
        (0.0182, 0.085, (2e-6, 169.0), " (95 %: 2e-06 … 1.7e+02)"),
        (24.0, 9e-16, (24.0, 24.0), ""),
        (0.3, None, (0.0, 0.3), ""),
        (0.3, 0.01, None, " ± 0.01"),
        (0.3, 0.01, (None, 0.32), " ± 0.01"),
    ],
)
def test_a_deviation_is_told_where_it_says_how_far_the_interval_reaches(
    value: float, std: float | None, interval: tuple[float | None, float] | None, text: str
) -> None:
    assert spread(value, std, interval) == text
