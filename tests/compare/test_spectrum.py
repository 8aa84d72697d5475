"""Frequencies read off synthetic motions whose frequencies are known, and off exact pendulum motions."""

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

from harness.compare.spectrum import lines, match_modes, parted, spectrum, swing
from harness.errors import InputError


def pendulum(time, amplitude, small=1.0):
    """Exact motion released at the amplitude: sin(θ/2) = k sn(K - ω t), k = sin(A/2)."""
    k2 = np.sin(0.5 * amplitude) ** 2
    sn, *_ = ellipj(ellipk(k2) - 2.0 * np.pi * small * time, k2)
    return 2.0 * np.arcsin(np.sqrt(k2) * sn)


def frequency_at(amplitude, small=1.0):
    return small * np.pi / 2.0 / ellipk(np.sin(0.5 * amplitude) ** 2)


@pytest.mark.parametrize("frequency", [3.0, 3.0371, 37.54, 200.001])
def test_a_clean_sine_is_found_far_below_the_bin_width(frequency):
    time = np.arange(4000) / 1000.0
    (line,) = lines(time, 0.3 * np.cos(2.0 * np.pi * frequency * time + 0.4))
    assert abs(line.frequency - frequency) < 2e-5
    assert line.amplitude == pytest.approx(0.3, rel=1e-3)
    assert line.std < 1e-4


def test_a_decaying_oscillation_keeps_its_frequency():
    # Damping ratio 2 %: the peak of a resonance curve would lie 0.08 % lower.
    time = np.arange(4000) / 1000.0
    omega = 2.0 * np.pi * 20.0
    (line,) = lines(time, np.exp(-0.02 * omega * time / 4.0) * np.sin(omega * time))
    assert line.frequency == pytest.approx(20.0, abs=2e-4)


@pytest.mark.parametrize("noise", [0.01, 0.1, 0.5])
def test_the_uncertainty_covers_the_error(noise):
    # Over 200 records the error in units of the stated uncertainty has to have spread one.
    rng = np.random.default_rng(3)
    time = np.arange(1000) / 200.0
    scores = []
    for _ in range(200):
        frequency = rng.uniform(10.0, 60.0)
        signal = np.cos(2.0 * np.pi * frequency * time + rng.uniform(0.0, 6.0)) + noise * rng.normal(size=len(time))
        line = lines(time, signal, most=1)[0]
        scores.append((line.frequency - frequency) / line.std)
    assert 0.8 < np.std(scores) < 1.25
    assert abs(np.mean(scores)) < 0.3


def test_noise_alone_has_no_lines():
    rng = np.random.default_rng(5)
    found = [len(lines(np.arange(2000) / 100.0, rng.normal(size=2000))) for _ in range(50)]
    assert sum(found) <= 2


def test_several_lines_come_strongest_first_and_weak_ones_survive_the_leakage():
    time = np.arange(8000) / 1000.0
    truth = {1.07: 1.0, 37.54: 0.02, 103.08: 3e-4, 186.29: 2e-3}
    signal = sum(a * np.cos(2.0 * np.pi * f * time + f) for f, a in truth.items()) + 0.3 + 0.1 * time
    found = lines(time, signal, band=(0.5, 400.0))
    assert [round(line.frequency, 2) for line in found[:4]] == [1.07, 37.54, 186.29, 103.08]
    for line in found[:4]:
        assert line.frequency == pytest.approx(min(truth, key=lambda f: abs(f - line.frequency)), abs=5e-3)


def test_two_lines_within_a_lobe_are_not_claimed_to_be_resolved():
    time = np.arange(1000) / 100.0
    signal = np.cos(2.0 * np.pi * 10.0 * time) + 0.8 * np.cos(2.0 * np.pi * 10.32 * time)
    found = lines(time, signal)
    assert all(line.std >= 0.1 for line in found[1:])


def test_uneven_samples_are_taken():
    rng = np.random.default_rng(1)
    time = np.sort(rng.uniform(0.0, 4.0, 6000))
    (line,) = lines(time, np.cos(2.0 * np.pi * 12.345 * time), most=1)
    assert line.frequency == pytest.approx(12.345, abs=2e-3)


def test_spectrum_of_a_sine_peaks_at_its_amplitude():
    time = np.arange(4096) / 512.0
    found = spectrum(time, 2.5 * np.sin(2.0 * np.pi * 32.0 * time))
    assert found.amplitude.max() == pytest.approx(2.5, rel=1e-3)
    assert found.frequency[np.argmax(found.amplitude)] == pytest.approx(32.0, abs=1e-9)


def test_swing_and_vibration_are_parted_without_shift():
    time = np.arange(8000) / 1000.0
    slow, fast = np.cos(2.0 * np.pi * 1.1 * time), 0.1 * np.sin(2.0 * np.pi * 35.0 * time)
    one, other = parted(time, slow + fast, 6.0)
    inside = slice(500, -500)
    np.testing.assert_allclose(one[inside], slow[inside], atol=2e-5)
    np.testing.assert_allclose(other[inside], fast[inside], atol=2e-5)
    np.testing.assert_allclose(one + other, slow + fast, atol=1e-12)


def test_parts_an_octave_away_are_kept():
    # A fourth-order Butterworth there and back: 1 / (1 + 2⁸) = 0.39 % lost an octave below.
    time = np.arange(20000) / 1000.0
    tone = np.cos(2.0 * np.pi * 5.0 * time)
    slow, _ = parted(time, tone, 10.0)
    inside = slice(4000, -4000)
    assert np.max(np.abs(slow - tone)[inside]) == pytest.approx(1.0 / 257.0, rel=0.03)


def test_modes_are_matched_once_each_and_strangers_left_alone():
    assert match_modes([1.07, 37.6, 103.0], [37.5, 103.1, 186.0]) == ((1, 0), (2, 1))
    # Greedily 10.0 would take 10.4 and leave 10.9 to 10.4's owner; the assignment does not.
    assert match_modes([10.0, 10.5], [10.4, 9.9]) == ((0, 1), (1, 0))
    assert match_modes([1.0], [2.0]) == ()
    assert match_modes([], [2.0]) == ()
    with pytest.raises(InputError, match="not positive"):
        match_modes([0.0], [1.0])


@pytest.mark.parametrize("degrees", [1.0, 45.0, 90.0, 150.0])
def test_a_pendulum_swings_as_the_elliptic_integral_says(degrees):
    amplitude = np.radians(degrees)
    time = np.arange(10_000) / 1000.0
    found = swing(time, pendulum(time, amplitude))
    np.testing.assert_allclose(found.frequency, frequency_at(amplitude), rtol=2e-6)
    np.testing.assert_allclose(found.amplitude, amplitude, rtol=1e-5)


def test_noise_moves_the_frequency_by_what_the_uncertainty_says():
    rng = np.random.default_rng(2)
    amplitude = np.radians(60.0)
    time = np.arange(6000) / 250.0
    found = swing(time, pendulum(time, amplitude) + 0.003 * rng.normal(size=len(time)))
    scores = (found.frequency - frequency_at(amplitude)) / found.std
    assert len(scores) > 35
    assert 0.6 < np.std(scores) < 1.5
    np.testing.assert_allclose(found.amplitude, amplitude, atol=0.008)


def test_a_decaying_swing_climbs_the_elliptic_curve():
    # θ'' + 2 ζ ω θ' + ω² sin θ = 0, integrated elsewhere (DOP853); light damping leaves the local frequency of each
    # half-swing that of the undamped pendulum at its amplitude, to first order.
    from scipy.integrate import solve_ivp

    omega, zeta = 2.0 * np.pi, 0.01
    time = np.linspace(0.0, 15.0, 3001)
    run = solve_ivp(
        lambda _, y: [y[1], -2.0 * zeta * omega * y[1] - omega**2 * np.sin(y[0])],
        (0.0, 15.0),
        [np.radians(100.0), 0.0],
        t_eval=time,
        method="DOP853",
        rtol=1e-10,
        atol=1e-12,
    )
    found = swing(time, run.y[0])
    assert found.amplitude[0] > 2.5 * found.amplitude[-1]
    np.testing.assert_allclose(found.frequency, frequency_at(found.amplitude), rtol=1.5e-3)


def test_a_swing_about_another_position_with_vibration_on_top():
    time = np.arange(8000) / 1000.0
    signal = 0.5 + 0.2 * np.cos(2.0 * np.pi * 0.9 * time) + 0.004 * np.sin(2.0 * np.pi * 35.0 * time)
    found = swing(time, signal, rest=0.5)
    assert np.median(found.frequency) == pytest.approx(0.9, rel=5e-3)
    assert np.median(found.amplitude) == pytest.approx(0.2, abs=0.004)


@pytest.mark.parametrize(
    ("call", "word"),
    [
        (lambda: lines(np.arange(8.0), np.zeros(8)), "16 samples"),
        (lambda: lines(np.arange(20.0), np.full(20, np.nan)), "finite"),
        (lambda: lines(np.zeros(20), np.zeros(20)), "increase"),
        (lambda: parted(np.arange(100.0), np.zeros(100), 0.7), "split"),
        (lambda: swing(np.arange(100.0), np.linspace(1.0, 2.0, 100)), "less than twice"),
    ],
)
def test_what_is_no_signal_is_refused_in_one_line(call, word):
    with pytest.raises(InputError, match=word) as caught:
        call()
    assert "\n" not in str(caught.value)
