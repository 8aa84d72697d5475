"""The truths that the suite's cases state, held against their sources."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from harness.cases.checks.period import period_ratio
from harness.cases.discover import built_in
from harness.cases.double_pendulum import frequencies
from harness.cases.pendulums import GRAVITY, paper_small_frequency
from harness.cases.robots import ROBOTS
from harness.errors import InputError

# From tables of the complete elliptic integral: (2/π) K(sin(A/2)).
PRINTED = {
    30.0: 1.0174087975,
    60.0: 1.0731820071,
    90.0: 1.1803405990,
    120.0: 1.3728805006,
    150.0: 1.7622037295,
    170.0: 2.4393627196,
}


@pytest.mark.parametrize(("amplitude", "ratio"), PRINTED.items())
def test_period_ratio_is_the_printed_one(amplitude, ratio):
    assert period_ratio(math.radians(amplitude)) == pytest.approx(
        ratio, abs=1e-10
    )  # ten digits, cut off rather than rounded


def test_period_ratio_is_the_integral_over_the_swing():
    """T/T0 = (2/π) ∫ dφ / √(1 − k² sin²φ), by quadrature."""
    k = math.sin(0.5 * 2.0)
    integral, _ = quad(lambda phi: 1.0 / math.sqrt(1.0 - (k * math.sin(phi)) ** 2), 0.0, math.pi / 2.0)
    assert period_ratio(2.0) == pytest.approx(2.0 / math.pi * integral, rel=1e-12)


def test_paper_pendulum_swings_as_the_paper_recomputed():
    # Recomputed from Table 1 by hand: 1.0657 Hz small, 0.9029 Hz at 90°.
    assert paper_small_frequency() == pytest.approx(1.0657, abs=5e-5)
    assert paper_small_frequency() / period_ratio(math.pi / 2.0) == pytest.approx(0.9029, abs=5e-5)


def test_double_pendulum_frequencies_solve_the_characteristic_equation():
    """det(K − ω² M) = 0 in absolute angles of two bars: M = m l² [[4/3, 1/2], [1/2, 1/3]], K = m g l [[3/2, 0], [0, 1/2]]."""
    length = 0.30
    for frequency in frequencies():
        square = (2.0 * math.pi * frequency) ** 2 * length / GRAVITY
        matrix = np.array([[1.5 - 4.0 / 3.0 * square, -0.5 * square], [-0.5 * square, 0.5 - square / 3.0]])
        assert abs(np.linalg.det(matrix)) < 1e-12


def test_every_case_cites_its_truth_and_every_name_is_a_file_name():
    cases = built_in()
    assert len(cases) >= 25
    for name, case in cases.items():
        assert name == case.name
        assert case.source.strip(), name
        assert case.title.strip(), name
        assert case.checks, name
        # The name is part of the key of accepted figures, which is taken apart at slashes and plus signs.
        assert name.replace("_", "").isalnum(), name


def test_at_least_ten_robots():
    assert len(ROBOTS) >= 10


def test_unknown_case_is_refused_with_the_nearest_name():
    from harness.cases.discover import select

    with pytest.raises(InputError, match="rigid_pendulum"):
        select(["rigid_pendulm"])


def test_star_takes_all_that_start_so():
    from harness.cases.discover import select

    assert {case.name for case in select(["rigid_pendulum*"])} == {"rigid_pendulum", "rigid_pendulum_damped"}
