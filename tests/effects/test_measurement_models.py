"""Sensor and input laws held against closed forms."""

import numpy as np
import pytest
from scipy.special import ellipj

from harness.effects import measurement

RATE = 2.0 * np.pi * 1.3  # rad/s of the test wave
GRIDS = {
    "even": np.arange(0.0, 8.0, 0.004),
    "uneven": np.cumsum(np.concatenate([[0.0], np.random.default_rng(5).uniform(0.001, 0.007, 1999)])),
}


@pytest.fixture(params=list(GRIDS))
def time(request):
    return GRIDS[request.param]


def wave(time, phase=0.3):
    return np.sin(RATE * time + phase)


def test_offset_gain_drift_act_lane_by_lane(time):
    signal = np.stack([wave(time), wave(time)])
    params = np.array([[0.5], [-2.0]])
    assert np.array_equal(measurement.offset(signal, time, params), [wave(time) + 0.5, wave(time) - 2.0])
    assert np.array_equal(measurement.gain(signal, time, params), [0.5 * wave(time), -2.0 * wave(time)])
    assert np.allclose(measurement.drift(signal, time, params)[1], wave(time) - 2.0 * time, rtol=0, atol=1e-15)


def test_delay_is_a_shifted_wave(time):
    delays = np.array([[0.0], [0.0013], [0.031]])
    delayed = measurement.delay(np.tile(wave(time), (3, 1)), time, delays)
    # Cubic interpolation through four samples at h ≤ 7 ms: |error| ≤ (ω h)⁴ · 9/16/24 · … < 1e-6 of a unit wave.
    inside = time >= 0.031
    for lane, (delay,) in enumerate(delays):
        assert np.abs(delayed[lane] - wave(time - delay))[inside].max() < 1e-6


def test_a_moving_signal_is_continued_before_its_first_sample():
    time = GRIDS["even"]
    square = 0.3 + 2.0 * time - 0.5 * time**2
    delayed = measurement.delay(square[None], time, np.array([[0.02]]))[0]
    late = time - 0.02
    # The curvature counts by v²/(v² + (a d)²) = 4/(4 + 0.02²), so it is short by 1e-4 of ½ a d² = 2e-4.
    assert np.allclose(delayed, 0.3 + 2.0 * late - 0.5 * late**2, rtol=0, atol=3e-8)


def test_a_signal_that_starts_from_rest_was_held_before():
    time = GRIDS["even"]
    released = np.cos(RATE * time)
    delayed = measurement.delay(released[None], time, np.array([[0.05]]))[0]
    expected = np.cos(RATE * np.maximum(time - 0.05, 0.0))
    assert np.abs(delayed - expected).max() < 2e-4  # while half the parabola would be ½ (ω d)² = 0.08 off


@pytest.mark.parametrize("start", np.linspace(1.0, 1.0 + 2.0 * np.pi / RATE, 9))
def test_a_window_within_a_recording_is_continued_as_it_swings(start):
    time = start + np.arange(0.0, 0.5, 0.005)
    late = 0.08  # a tenth of a swing: a parabola is up to (ω d)³/6 = 0.047 off
    delayed = measurement.delay(wave(time)[None], time, np.array([[late]]))[0]
    # The curvature of the cubic through the first four samples is off by 11/12 (ω h)² = 1.5e-3 of ½ (ω d)² = 0.21.
    assert np.abs(delayed - wave(time - late)).max() < 3.4e-4


@pytest.mark.parametrize("start", np.linspace(1.0, 2.0, 9))
def test_a_wide_swing_within_a_recording_is_continued_better_than_by_a_parabola(start):
    def swing(time):
        # A pendulum of amplitude 1.5 rad: θ = 2 asin(k sn(ω t, k)), k = sin(0.75).
        return 2.0 * np.arcsin(np.sin(0.75) * ellipj(2.0 * np.pi * time, np.sin(0.75) ** 2)[0])

    time, late = start + np.arange(0.0, 0.5, 0.005), 0.05
    delayed = measurement.delay(swing(time)[None], time, np.array([[late]]))[0]
    # The worst parabola is 6.7e-3 off: the curvature changes by ω³ · 1.5 d within it.
    assert np.abs(delayed - swing(time - late)).max() < 1.3e-3


def test_clock_skew_stretches_time(time):
    skewed = measurement.clock_skew(wave(time)[None], time, np.array([[1.01]]))[0]
    assert np.abs(skewed - wave(time / 1.01)).max() < 1e-6
    assert np.array_equal(measurement.clock_skew(wave(time)[None], time, np.array([[1.0]]))[0], wave(time))


def settling(time, cutoff):
    """Steady course of a filtered wave, and how what else it began with dies away.

    τ ẏ + y = sin(ω t + φ): y = a sin(ω t + φ − ψ) + c e^{−t/τ}, a = 1/√(1 + (ωτ)²), ψ = atan ωτ.
    """
    tau = 1.0 / (2.0 * np.pi * cutoff)
    amplitude, lag = 1.0 / np.hypot(1.0, RATE * tau), np.arctan(RATE * tau)
    return amplitude * np.sin(RATE * time + 0.3 - lag), np.exp(-(time - time[0]) / tau)


@pytest.mark.parametrize("cutoff", [0.2, 2.0, 30.0, 400.0])
def test_lowpass_within_a_motion_is_steady(time, cutoff):
    time = time + 1.0  # seconds into the recording
    steady, _ = settling(time, cutoff)
    passed = measurement.lowpass(wave(time)[None], time, np.array([[cutoff]]))[0]
    # Third differences at h ≤ 7 ms tell ω² to (ω h)² = 3e-3, of which as much of the first sample is wrong; slopes by second-order
    # differences are wrong by (ω h)²/6 of themselves over a step.
    assert np.abs(passed - steady).max() < 3e-3
    assert np.abs(passed - steady)[time > time[0] + 10.0 / cutoff].max(initial=0.0) < 2e-5


def test_what_a_lowpass_began_with_has_the_course_that_its_memory_states(time):
    cutoff = 2.0
    _, dying = settling(time, cutoff)
    course, size = measurement.lowpass_memory(wave(time)[None], time + 1.0, np.array([[cutoff]]))
    assert np.allclose(course[0], dying, rtol=0, atol=1e-12)
    assert size[0] == pytest.approx((RATE / (2.0 * np.pi * cutoff)) ** 2 * 2.0, rel=0.02)


def test_a_lowpass_of_what_was_held_has_settled_on_it():
    time = GRIDS["even"]
    cutoff = 2.0
    tau = 1.0 / (2.0 * np.pi * cutoff)
    # τ ẏ + y = cos ω t from y(0) = 1: steady part (cos ω t + ωτ sin ω t)/(1 + (ωτ)²).
    turn = RATE * tau
    steady = (np.cos(RATE * time) + turn * np.sin(RATE * time)) / (1.0 + turn**2)
    expected = steady + (1.0 - steady[0]) * np.exp(-time / tau)
    released = np.cos(RATE * time)[None]
    passed = measurement.lowpass(released, time, np.array([[cutoff]]))[0]
    assert np.abs(passed - expected).max() < 2e-5
    assert measurement.lowpass_memory(released, time, np.array([[cutoff]]))[1][0] < 1e-6


@pytest.mark.parametrize("since", [0.002, 0.01, 0.05])
def test_a_lowpass_of_what_has_just_been_let_go_is_nearly_settled(since):
    # Released ``since`` before the first sample; the same closed form, begun there. Third order in ω·since is what is left out.
    time = GRIDS["even"]
    cutoff = 2.0
    tau = 1.0 / (2.0 * np.pi * cutoff)
    turn, late = RATE * tau, time + since
    steady = (np.cos(RATE * late) + turn * np.sin(RATE * late)) / (1.0 + turn**2)
    expected = steady + (1.0 - 1.0 / (1.0 + turn**2)) * np.exp(-late / tau)
    passed = measurement.lowpass(np.cos(RATE * late)[None], time, np.array([[cutoff]]))[0]
    assert np.abs(passed - expected).max() < 3e-5 + 3.0 * (RATE * since) ** 3


@pytest.mark.parametrize("cutoff", [0.2, 2.0, 30.0, 400.0])
def test_highpass_of_a_wave(time, cutoff):
    steady, dying = settling(time, cutoff)
    start = wave(time)[0]
    rest = measurement.highpass(wave(time)[None], time, np.array([[cutoff, 1.0]]))[0]
    # Slopes by second-order differences: error (ω h)²/6 of the slope over the step, h ≤ 7 ms.
    assert np.abs(rest - (wave(time) - steady - (start - steady[0]) * dying)).max() < 2e-5
    fresh = measurement.highpass(wave(time)[None], time, np.array([[cutoff, 0.0]]))[0]
    # Settled on zero before: the whole first sample passes, and dies away.
    assert np.allclose(fresh - rest, start * dying, rtol=0, atol=1e-12)


def test_lowpass_of_a_straight_line_is_late_by_its_time_constant(time):
    # y = x(t − τ) for a line that has always been there
    tau = 1.0 / (2.0 * np.pi * 0.7)
    passed = measurement.lowpass((2.0 - 3.0 * time)[None], time, np.array([[0.7]]))[0]
    assert np.allclose(passed, 2.0 - 3.0 * (time - tau), rtol=0, atol=1e-9)


def test_nonlinearity_saturation_deadzone_quantisation():
    time = np.arange(5.0)
    signal = np.array([[-2.0, -0.5, 0.0, 0.5, 2.0]])
    assert np.allclose(
        measurement.nonlinearity(signal, time, np.array([[0.1, -0.2]])),
        [[-2 + 0.4 + 1.6, -0.5 + 0.025 + 0.025, 0, 0.5 + 0.025 - 0.025, 2 + 0.4 - 1.6]],
    )
    assert np.array_equal(measurement.saturation(signal, time, np.array([[0.7]])), [[-0.7, -0.5, 0.0, 0.5, 0.7]])
    assert np.allclose(measurement.deadzone(signal, time, np.array([[0.6]])), [[-1.4, 0.0, 0.0, 0.0, 1.4]])
    assert np.allclose(measurement.quantisation(signal, time, np.array([[0.3]])), [[-2.1, -0.6, 0.0, 0.6, 2.1]])
    assert np.array_equal(measurement.quantisation(signal, time, np.array([[0.0]])), signal)


def test_release_holds_then_follows(time):
    released = measurement.release(wave(time)[None], time, np.array([[0.5]]))[0]
    held = time <= 0.5
    assert np.allclose(released[held], wave(0.0), rtol=0, atol=1e-12)
    assert np.abs(released[~held] - wave(time[~held] - 0.5)).max() < 1e-6


def test_held_delay_of_an_effort_keeps_the_first_value():
    time = np.arange(0.0, 1.0, 0.01)
    ramp = 3.0 + 2.0 * time
    delayed = measurement.held_delay(ramp[None], time, np.array([[0.035]]))[0]
    assert np.allclose(delayed, 3.0 + 2.0 * np.maximum(time - 0.035, 0.0), rtol=0, atol=1e-12)


@pytest.mark.parametrize("delay", [0.001, 0.005, 0.0272])
def test_held_delay_of_a_smooth_effort_is_exact_between_samples(delay):
    time = np.arange(0.0, 1.0, 0.01)
    rate = 2.0 * np.pi * 4.0
    delayed = measurement.held_delay(np.sin(rate * time)[None], time, np.array([[delay]]))[0]
    # A cubic through samples h apart is off by at most 3/128 (ω h)⁴ inside; straight lines would be by (ω h)²/8.
    inside = (time > delay + 0.02) & (time < 0.97)
    assert np.abs(delayed - np.sin(rate * (time - delay)))[inside].max() < 3.0 / 128.0 * (rate * 0.01) ** 4


def test_periodic_error_repeats_with_the_turn():
    time = np.arange(4.0)
    angle = np.array([[0.2, 0.2 + np.pi, 0.2 + 2 * np.pi, 0.2 - 2 * np.pi]])
    error = measurement.periodic_error(angle, time, np.array([[0.01, 3.0, 0.4]])) - angle
    assert np.allclose(error[0, [0, 2, 3]], 0.01 * np.sin(3 * 0.2 + 0.4), rtol=0, atol=1e-12)
    assert np.isclose(error[0, 1], -error[0, 0], rtol=0, atol=1e-12)
