"""Signals at other times: cubics are exact for a cubic, whatever the order of the times, and parabolas for a parabola beyond."""

from __future__ import annotations

import numpy as np
import pytest

from harness.effects.resampling import resample

EVEN = np.arange(40) * 0.05
UNEVEN = np.cumsum(np.random.default_rng(1).uniform(0.02, 0.08, 40))


@pytest.mark.parametrize("time", [EVEN, UNEVEN], ids=["even", "uneven"])
def test_a_cubic_comes_out_exactly_at_times_in_any_order(time: np.ndarray) -> None:
    random = np.random.default_rng(2)
    factors = random.normal(size=(5, 4))
    signal = np.array([np.polynomial.polynomial.polyval(time, f) for f in factors])
    query = random.uniform(time[0], time[-1], (5, 200))
    query[0] = np.sort(query[0])
    expected = np.array([np.polynomial.polynomial.polyval(q, f) for q, f in zip(query, factors, strict=True)])
    np.testing.assert_allclose(resample(signal, time, query), expected, rtol=1e-9, atol=1e-10)


def test_samples_themselves_are_kept() -> None:
    signal = np.random.default_rng(3).normal(size=(2, 40))
    np.testing.assert_allclose(resample(signal, UNEVEN, np.tile(UNEVEN, (2, 1))), signal, atol=1e-12)


def test_a_parabola_goes_on_beyond_both_ends() -> None:
    signal = (1.0 - 2.0 * EVEN + 3.0 * EVEN**2)[None]
    query = np.array([[-0.2, -0.01, EVEN[-1] + 0.01, EVEN[-1] + 0.3]])
    np.testing.assert_allclose(resample(signal, EVEN, query), 1.0 - 2.0 * query + 3.0 * query**2, rtol=1e-9)


def test_three_samples_are_joined_by_lines() -> None:
    found = resample(np.array([[0.0, 1.0, 0.0]]), np.array([0.0, 1.0, 2.0]), np.array([[0.5, 1.25, 2.5]]))
    np.testing.assert_allclose(found, [[0.5, 0.75, 0.0]])
