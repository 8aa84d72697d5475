"""Noise estimated from recordings whose noise is known because it was drawn."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.signal import lfilter

from harness.recording import estimate_noise
from harness.recording.noise import _least

SEEDS = range(100, 107)


def swing(time):
    return 1.2 * np.exp(-0.05 * time) * np.cos(2 * np.pi * 1.1 * time + 0.02 * np.sin(4 * np.pi * 1.1 * time))


def autoregressive(rng, count, phi):
    """First-order autoregressive noise of unit variance, stationary from its first sample."""
    drawn = rng.normal(size=count + 2000) * np.sqrt(1.0 - phi**2)
    return lfilter([1.0], [1.0, -phi], drawn)[2000:]


def draw(rate, duration, sigma, phi=0.0, step=0.0, jitter=0.0, seed=0):
    rng = np.random.default_rng(seed)
    time = np.arange(int(rate * duration)) / rate
    if jitter:
        time = np.sort(time + rng.uniform(-jitter, jitter, len(time)) / rate)
    noise = autoregressive(rng, len(time), phi) if phi else rng.normal(size=len(time))
    values = swing(time) + sigma * noise
    return time, np.round(values / step) * step if step else values


def estimates(**settings):
    return [estimate_noise(*draw(seed=seed, **settings)) for seed in SEEDS]


WHITE = [
    {"rate": 250, "duration": 16, "sigma": 3e-3},
    {"rate": 250, "duration": 16, "sigma": 1e-4},
    {"rate": 1000, "duration": 9, "sigma": 1e-4},
    {"rate": 50, "duration": 16, "sigma": 3e-3},
    {"rate": 100, "duration": 10, "sigma": 0.03},
    {"rate": 250, "duration": 16, "sigma": 3e-3, "jitter": 0.3},
    {"rate": 70, "duration": 5, "sigma": 1e-3, "jitter": 0.4},
]


@pytest.mark.parametrize("settings", WHITE, ids=str)
def test_white_noise(settings):
    found = estimates(**settings)
    ratios = np.array([estimate.std for estimate in found]) / settings["sigma"]
    # The mean over seven draws within 3 %; each within four of the standard errors that it states.
    assert abs(ratios.mean() - 1.0) < 0.03
    for estimate, ratio in zip(found, ratios, strict=True):
        assert abs(ratio - 1.0) < 4.0 * max(estimate.relative_error, 0.01)
    # White noise called coloured is a false alarm; the criterion allows few.
    assert sum(estimate.coloured > 0.0 for estimate in found) <= 1


COLOURED = [
    ({"rate": 250, "duration": 16, "sigma": 3e-3, "phi": 0.5}, 0.05),
    ({"rate": 250, "duration": 16, "sigma": 3e-3, "phi": 0.8}, 0.06),
    ({"rate": 1000, "duration": 16, "sigma": 1e-3, "phi": 0.9}, 0.06),
    ({"rate": 250, "duration": 16, "sigma": 3e-3, "phi": 0.8, "jitter": 0.3}, 0.06),
    ({"rate": 250, "duration": 16, "sigma": 3e-3, "phi": 0.9}, 0.12),
]


@pytest.mark.parametrize(("settings", "allowed"), COLOURED, ids=str)
def test_autoregressive_noise(settings, allowed):
    found = estimates(**settings)
    assert all(estimate.coloured > 0.0 for estimate in found)
    ratios = np.array([estimate.std for estimate in found]) / settings["sigma"]
    assert abs(ratios.mean() - 1.0) < allowed
    phi = np.array([estimate.coefficient for estimate in found])
    assert abs(phi.mean() - settings["phi"]) < 0.03
    times = np.array([estimate.time for estimate in found])
    true = -1.0 / settings["rate"] / np.log(settings["phi"])
    assert np.median(times) == pytest.approx(true, rel=0.2)


def test_white_and_autoregressive_noise_together():
    ratios, phis = [], []
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        time = np.arange(16000) / 1000.0
        noise = 2e-3 * autoregressive(rng, len(time), 0.95) + 1e-3 * rng.normal(size=len(time))
        found = estimate_noise(time, swing(time) + noise)
        assert found.white > 0.0 and found.coloured > 0.0
        ratios.append([found.white / 1e-3, found.coloured / 2e-3])
        phis.append(found.coefficient)
    assert np.abs(np.mean(ratios, axis=0) - 1.0).max() < 0.1
    assert abs(np.mean(phis) - 0.95) < 0.02


@pytest.mark.parametrize(("sigma", "step"), [(1e-6, 1.5e-3), (1e-3, 1.5e-3), (3e-4, 5e-3)])
def test_quantisation_counts_with_a_twelfth_of_its_square(sigma, step):
    for estimate in estimates(rate=250, duration=16, sigma=sigma, step=step):
        assert estimate.step == pytest.approx(step, rel=1e-3)
        assert estimate.std == pytest.approx(np.sqrt(sigma**2 + step**2 / 12.0), rel=0.06)


def test_motion_with_corners_is_not_taken_for_noise():
    # Dry friction puts a jump into the acceleration at every reversal; its spectrum falls as 1/f³ in amplitude.
    time = np.arange(3000) / 250.0
    half = np.floor(2.0 * time)
    amplitude = 1.0 - 0.04 * half
    offset = 0.02 * (-1.0) ** half
    motion = offset + (amplitude - 0.02) * np.cos(2 * np.pi * time)
    for seed in SEEDS:
        noise = np.random.default_rng(seed).normal(0.0, 1e-3, len(time))
        assert estimate_noise(time, motion + noise).std == pytest.approx(1e-3, rel=0.08)


def test_a_vibration_is_not_taken_for_noise():
    time = np.arange(16000) / 1000.0
    ringing = 0.02 * np.exp(-0.5 * time) * np.sin(2 * np.pi * 37.0 * time)
    for seed in list(SEEDS)[:6]:
        noise = np.random.default_rng(seed).normal(0.0, 1e-3, len(time))
        assert estimate_noise(time, swing(time) + ringing + noise).std == pytest.approx(1e-3, rel=0.05)


def test_gaps_and_missing_samples_do_not_matter():
    for seed in SEEDS:
        time, values = draw(250, 16, 2e-3, seed=seed)
        values[700:740] = np.nan
        keep = (time < 9.0) | (time > 9.7)
        assert estimate_noise(time[keep], values[keep]).std == pytest.approx(2e-3, rel=0.08)


def test_the_autocovariance_is_that_of_its_parts():
    found = estimate_noise(*draw(250, 16, 3e-3, phi=0.8, seed=5))
    assert found.autocovariance(np.array([0.0]))[0] == pytest.approx(found.std**2)
    lag = found.autocovariance(np.array([1 / 250.0]))[0]
    assert lag == pytest.approx(found.coloured**2 * found.coefficient, rel=1e-6)


def test_too_little_to_tell_is_said_to_be():
    time, values = draw(250, 0.2, 1e-3)
    assert estimate_noise(time, values).reliability == "poor"
    assert estimate_noise(time, np.full(len(time), 0.3)).std == 0.0


def test_slopes_are_scipy_s_own():
    """The search for the least value goes the very way that SciPy goes with slopes that it differences itself."""
    box = ((-30.0, 30.0), (-6.0, 6.0))

    def loss(x):
        return float(100.0 * (x[1] - x[0] ** 2) ** 2 + (1.0 - x[0]) ** 2)

    for start in ((-1.2, 1.0), (5.0, 6.0)):
        ours, theirs = _least(loss, start, box), minimize(loss, start, method="L-BFGS-B", bounds=box)
        np.testing.assert_array_equal(ours.x, theirs.x)
