"""The colour of noise is estimated, and a misfit of the model is not taken for it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from harness.diagnose.estimation.noise_colour import Colour, estimate_colour


def noise(rng: np.random.Generator, count: int, white: float, coloured: float, phi: float) -> np.ndarray:
    drive = coloured * np.sqrt(1.0 - phi**2) * rng.standard_normal(count + 500)
    return lfilter([1.0], [1.0, -phi], drive)[500:] + white * rng.standard_normal(count)


@pytest.mark.parametrize(("white", "coloured", "phi"), [(1.0, 0.0, 0.0), (0.0, 1.0, 0.8), (0.5, 1.0, 0.7)])
@pytest.mark.parametrize("misfit", [0.0, 3.0])
def test_estimate_with_and_without_a_misfit(white: float, coloured: float, phi: float, misfit: float) -> None:
    rng = np.random.default_rng(1)
    time = np.arange(4000) / 250.0
    segments = [
        noise(rng, 4000, white, coloured, phi) + misfit * np.sin(2 * np.pi * (1.0 + 0.005 * time) * time)
        for _ in range(2)
    ]
    found = estimate_colour(segments, 1 / 250.0, 8.0, 1.0)
    assert found.std == pytest.approx(np.hypot(white, coloured), rel=0.12)


def test_whitening_makes_innovations_of_unit_variance() -> None:
    colour = Colour(0.4, 1.0, 0.85)
    x = colour.whiten(noise(np.random.default_rng(2), 200_000, 0.4, 1.0, 0.85))
    # Standard errors over 2e5 samples are 0.0016 and 0.0022.
    assert np.std(x) == pytest.approx(1.0, abs=0.01)
    assert abs(np.mean(x[1:] * x[:-1])) < 0.01


def test_a_jump_is_not_noise() -> None:
    rng = np.random.default_rng(3)
    time = np.arange(4000)
    found = estimate_colour([rng.standard_normal(4000) + 3.0 * (time > 2000)], 1 / 250.0, 8.0, 1.0)
    assert found.std == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize(
    ("white", "coloured", "phi"), [(1.0, 0.5, 0.9), (1e-7, 1.0, 0.5), (1.0, 1e-6, 0.999), (1.0, 0.9, 1e-9)]
)
def test_innovations_have_the_noise_s_autocovariance(white: float, coloured: float, phi: float) -> None:
    # Of (1 − φ B) times the sum of white and AR(1) noise, an MA(1): variance and first covariance (Box and Jenkins, ch. 3),
    # one part of the noise may be much weaker than the other.
    theta, sigma = Colour(white, coloured, phi).innovation
    assert (1.0 + theta**2) * sigma**2 == pytest.approx(
        coloured**2 * (1.0 - phi**2) + white**2 * (1.0 + phi**2), rel=1e-12
    )
    assert theta * sigma**2 == pytest.approx(-phi * white**2, rel=1e-9)
    assert abs(theta) < 1.0
