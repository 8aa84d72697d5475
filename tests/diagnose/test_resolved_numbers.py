"""Values and intervals show what parts them, and no more."""

import pytest

from harness.diagnose.answer.explain import percent
from harness.diagnose.answer.significant_digits import best, digits, ends, estimate, resolved, rounded
from harness.plain_numbers import points


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
        (1234.0, 400.0, "1230"),
        (5570110.0, 3e4, "5570000"),
        (2.1e11, 3e9, "2.100e+11"),
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


def test_figures_beside_one_another_have_as_many_digits_each() -> None:
    assert [rounded(value) for value in (0.00302, 0.003, 1201.0, 0.0, None)] == ["0.00302", "0.00300", "1200", "0", "–"]


def test_the_ends_of_a_narrow_interval_differ() -> None:
    assert ends([-0.060338, -0.060111]) == "-0.06034 … -0.06011"


def test_an_end_that_is_not_known_is_a_dash() -> None:
    assert ends([None, 0.25]) == "– … 0.250"
    assert ends(None) == ""


def test_ends_that_lie_decades_apart_are_each_read_by_themselves() -> None:
    """0 … 39.0 would say that nothing at all is as likely."""
    assert ends([0.005, 39.0]) == "0.005 … 39"
    assert ends([-1234.0, -2e-6]) == "-1200 … -2e-06"
    assert ends([0.0, 39.0]) == "0.00 … 39.0"
    assert ends([-0.004, 39.0]) == "-0.004 … 39.0"
    assert best(0.4, [0.005, 39.0]) == "0.400"
    assert best(0.001, [-0.5, 0.5]) == "0.001"
    assert best(0.25, None) == "0.250"


def test_an_end_that_says_that_all_is_away_is_no_zero() -> None:
    """A damping of 0.001 is stated: that none of it is left is the best value and one end, far below what parts the ends."""
    assert ends([-0.001, 0.057]) == "-0.001 … 0.0570"
    assert estimate(-0.001, None, (-0.001, 0.057)).startswith("-0.001 … 0.0570 (95 %), best -0.001")
    assert ends([0.0, 0.057]) == "0.00 … 0.0570"
    assert ends([-1e-16, 0.057]) == "0.00 … 0.0570"


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.4, "0"), (-0.4, "0"), (-5.2, "-5"), (232327.3, "232327"), (1642453342761.0, "1.64e12"), (-2.5e6, "-2.50e6")],
)
def test_points_beyond_a_million_have_three_digits(value: float, text: str) -> None:
    assert points(value) == text


@pytest.mark.parametrize(
    ("value", "std", "interval", "unit", "text"),
    [
        (0.5, 0.01, (0.48, 0.52), "kg", "0.500 ± 0.01 kg"),
        (0.04833, 0.022, (0.0052, 0.0915), "N·m", "0.0483 ± 0.022 N·m"),
        (5570110.0, 31000.0, (5.51e6, 5.63e6), "N/m", "5570000 ± 31000 N/m"),
        # Lopsided: one end twice as far as the other.
        (0.4, 10.0, (0.005, 39.0), "N·m", "0.005 … 39 N·m (95 %), best 0.400"),
        (0.0182, 0.085, (2e-6, 169.0), "kg", "2e-06 … 170 kg (95 %), best 0.0182"),
        (1.01, 0.02, (1.0, 1.05), "s", "1.00 … 1.05 s (95 %), best 1.010"),
        # Wider than its estimate: 0.3 ± 0.2 would hide that nothing is as likely.
        (0.3, 0.2, (-0.092, 0.692), "", "-0.0920 … 0.692 (95 %), best 0.300"),
        (-0.3, 0.2, (-0.692, 0.092), "", "-0.692 … 0.0920 (95 %), best -0.300"),
        # At the end of where it was searched.
        (0.3, None, (0.1, 0.3), "m", "0.100 … 0.300 m (95 %), best 0.300 (at its bound)"),
        # Thirty decades are no interval.
        (1.62, None, (1.5e-17, 1.5e16), "N·m·s/rad", "not determined (best 1.62 N·m·s/rad)"),
        (24.0, 9e-16, (24.0, 24.0), "1/rev", "24.0 1/rev"),
        (0.3, None, None, "rad", "0.300 rad"),
        (0.3, 0.01, None, "", "0.300 ± 0.01"),
        (0.3, 0.01, (None, 0.32), "", "0.300 ± 0.01"),
    ],
)
def test_an_estimate_tells_what_is_known_of_it(
    value: float, std: float | None, interval: tuple[float | None, float] | None, unit: str, text: str
) -> None:
    assert estimate(value, std, interval, unit) == text


def test_digits_are_written_out_up_to_a_thousand_million() -> None:
    assert digits(1234567.0, 3) == "1230000"
    assert digits(1234.0, 4) == "1234"
    assert digits(0.00001234, 3) == "1.23e-05"


def test_all_of_a_mismatch_is_never_said_to_be_removed_where_something_is_left() -> None:
    assert [percent(share) for share in (0.83, 0.9978, 1.0)] == ["83 %", "99.8 %", "100 %"]
    # What a free run that flies off leaves has no size, so that further digits would say nothing.
    assert [percent(share) for share in (0.9996, 0.99999999995)] == ["more than 99.9 %"] * 2
    assert percent(0.9994) == "99.9 %"
    assert [percent(share) for share in (1.285, -1365.0)] == ["130 %", "-140,000 %"]
