"""What sensors and actuators do to a signal: pure functions of many lanes at once.

Every function has the form (signal (B, T), time (T,), params (B, k)) -> (B, T). ``time`` [s] ascends, evenly or
not, and is counted from the first sample of the recording; a simulation that ends later than the recording has times
beyond the last one.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from harness.effects.resampling import POINTS, resample
from harness.kept_kernels import forgive
from harness.system.description import Array

forgive()

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_NODES, _WEIGHTS = (_NODES + 1.0) / 2.0, _WEIGHTS / 2.0
STRETCH = 3.0  # time constants of a filter, in which a signal tells how fast it swings
AGES = 50.0  # time constants after which a start from rest is forgotten
EDGE, FEW = 2, 8  # samples at whose slopes little is known, and on which a swing shows at least
SHORT_STEP = 1.0  # step over time constant below which quadrature replaces the recursion, which cancels there


def unchanged(signal: Array, time: Array, params: Array) -> Array:
    """The signal itself; no params."""
    return signal


def offset(signal: Array, time: Array, params: Array) -> Array:
    """signal + offset; params: offset [channel unit]."""
    return signal + params[:, :1]


def gain(signal: Array, time: Array, params: Array) -> Array:
    """gain · signal; params: gain [1]."""
    return signal * params[:, :1]


def drift(signal: Array, time: Array, params: Array) -> Array:
    """signal + rate · time; params: rate [channel unit/s]."""
    return signal + params[:, :1] * time


def nonlinearity(signal: Array, time: Array, params: Array) -> Array:
    """signal + quadratic · signal² + cubic · signal³; params: quadratic [1/unit], cubic [1/unit²]."""
    return signal * (1.0 + signal * (params[:, :1] + signal * params[:, 1:2]))


def periodic_error(signal: Array, time: Array, params: Array) -> Array:
    """signal + amplitude · sin(periods · signal + phase); params: amplitude [unit], periods [1/rev], phase [rad]."""
    return signal + params[:, :1] * np.sin(params[:, 1:2] * signal + params[:, 2:3])


def hum(signal: Array, time: Array, params: Array) -> Array:
    """signal + amplitude · sin(2π frequency · time); params: amplitude [channel unit], frequency [Hz]."""
    return signal + hum_courses(time, params, np.zeros(1))[0]


def hum_courses(time: Array, params: Array, around: Array) -> Array:
    """Sine and cosine of hum (2, B, T), as means over times ``around`` (K,) every sample [s], even about it; params as ``hum``."""
    turn = 2.0 * np.pi * params[:, 1:2]
    left = np.mean(np.cos(turn * around), axis=1, keepdims=True)
    return params[:, :1] * left * np.stack([np.sin(turn * time), np.cos(turn * time)])


def saturation(signal: Array, time: Array, params: Array) -> Array:
    """signal held within ±limit; params: limit [channel unit]."""
    return np.clip(signal, -params[:, :1], params[:, :1])


def quantisation(signal: Array, time: Array, params: Array) -> Array:
    """signal rounded to a whole number of steps; params: step [channel unit], 0 leaves the signal as it is."""
    step = params[:, :1]
    safe = np.where(step > 0.0, step, 1.0)
    return np.where(step > 0.0, np.round(signal / safe) * safe, signal)


def deadzone(signal: Array, time: Array, params: Array) -> Array:
    """Nothing within ±width, beyond it what is over; params: width [effort unit]."""
    return np.sign(signal) * np.maximum(np.abs(signal) - params[:, :1], 0.0)


def delay(signal: Array, time: Array, params: Array) -> Array:
    """signal(time − delay); params: delay [s].

    Interpolated by cubics through four samples. What lies before the first sample is the wave that touches the signal there and
    swings as it goes on, if it begins in motion, and the first sample if it begins at rest (a held link is released): the
    curvature counts as far as the speed at the start exceeds what it makes of it in a delay.
    """
    asked = time[None, :] - params[:, :1]
    first = int(np.searchsorted(time, time[0] + float(np.max(params[:, 0]))))
    if first == 0 or len(time) < POINTS:
        return resample(signal, time, asked)
    # What is asked for from before the first sample, by any of them, comes first.
    shifted = resample(signal, time, np.maximum(asked, time[0]))
    asked = asked[:, :first]
    early = asked < time[0]
    lag = np.maximum(params[:, :1], 1e-12)
    speed, bend, moving, turns = _beginning(signal, time, lag, 1.0)
    if not within(time):
        moving = speed**2 / (speed**2 + (bend * lag) ** 2 + 1e-300)
    before = asked - time[0]
    swing = np.sqrt(turns) / lag * before / np.pi
    wave = before * (speed * np.sinc(swing) + 0.5 * moving * bend * before * np.sinc(0.5 * swing) ** 2)
    shifted[:, :first] = np.where(early, signal[:, :1] + wave, shifted[:, :first])
    return shifted


def _at_first(signal: Array, time: Array) -> tuple[Array, Array]:
    """Speed and curvature at the first sample, of the cubic through the first four, each (B, 1)."""
    cubic = np.linalg.solve(np.vander(time[:4] - time[0], increasing=True), signal[:, :4].T)
    return cubic[1][:, None], 2.0 * cubic[2][:, None]


def held_delay(signal: Array, time: Array, params: Array) -> Array:
    """signal(time − delay), the first sample standing before it; cubic between samples; params: delay [s].

    This is what an applied effort does: nothing is known of it before the recording begins. Straight lines between samples h apart
    would lose up to (ω h)²/8 of a wave, and how much would depend on the delay.
    """
    return resample(signal, time, np.clip(time[None, :] - params[:, :1], time[0], time[-1]))


def release(signal: Array, time: Array, params: Array) -> Array:
    """signal(0) until ``delay``, signal(time − delay) after; params: delay [s], not negative."""
    return resample(signal, time, np.maximum(time[None, :] - params[:, :1], max(0.0, float(time[0]))))


def clock_skew(signal: Array, time: Array, params: Array) -> Array:
    """What a clock that runs ``factor`` times too fast records: signal(time / factor); params: factor [1].

    With a factor below 1 the simulation must reach beyond the last sample.
    """
    return resample(signal, time, time[None, :] / params[:, :1])


def lowpass(signal: Array, time: Array, params: Array) -> Array:
    """First-order low-pass of a signal that goes on as it begins; params: cutoff [Hz] (−3 dB).

    τ ẏ + y = x with τ = 1/(2π cutoff), solved exactly for the signal as a piecewise cubic. One that begins at rest with the
    recording was held before, and the filter has settled on it.
    """
    return _passed(signal, time, params, _followed(signal, time, params))


def highpass(signal: Array, time: Array, params: Array) -> Array:
    """First-order high-pass: what a low-pass leaves out; params: cutoff [Hz] (−3 dB), settled [1].

    settled: that low-pass begins at settled · first sample; 1 is a filter that has seen that value for long.
    """
    return signal - _passed(signal, time, params, params[:, 1] * signal[:, 0])


def highpass_memory(signal: Array, time: Array, params: Array) -> tuple[Array, Array]:
    """What a high-pass may still know of the time before its first sample, besides what it is said to have settled on.

    Its course (B, T), −1 at first, and its size (B,): within a recording any part of the signal; where the recording begins, what
    the low-pass makes of the signal in the time by which its samples are uneven, since the first may be off by as much.
    """
    lag = _time_constant(params)
    size = np.abs(signal).max(axis=1)
    if not within(time):
        size = np.abs(signal[:, 0]) * np.minimum(np.std(np.diff(time)) / lag, 1.0)
    return -np.exp(-(time - time[0]) / lag[:, None]), size


def _passed(signal: Array, time: Array, params: Array, start: Array) -> Array:
    """The low-pass of each lane's signal (B, T) that begins at ``start`` (B,)."""
    time_constant = _time_constant(params)
    step = np.diff(time)
    slope = _slope(signal, time)
    x0, x1, s0, s1 = signal[:, :-1], signal[:, 1:], slope[:, :-1] * step, slope[:, 1:] * step
    # Hermite cubic on each step, in the fraction w of the step.
    coefficients = (x0, s0, 3.0 * (x1 - x0) - 2.0 * s0 - s1, 2.0 * (x0 - x1) + s0 + s1)
    u = step[None, :] / time_constant[:, None]
    moments = _moments(u)
    driven = sum((c * m for c, m in zip(coefficients, moments, strict=True)), np.zeros_like(u))
    return _relax(np.exp(-u), driven, np.ascontiguousarray(start))


def _time_constant(params: Array) -> Array:
    return np.asarray(1.0 / (2.0 * np.pi * np.maximum(params[:, 0], 1e-12)))


def _slope(signal: Array, time: Array) -> Array:
    return np.asarray(np.gradient(signal, time, axis=1, edge_order=2 if len(time) > 2 else 1))


def lowpass_memory(signal: Array, time: Array, params: Array) -> tuple[Array, Array]:
    """What a low-pass may still know of the time before its first sample: its course (B, T), 1 at first, and its size (B,).

    The size is that of what ``lowpass`` may be wrong by there, because motion is no wave of one frequency; and where the recording
    begins, because a filter that begins with it stands on its first sample, however that moves.
    """
    tau = _time_constant(params)[:, None]
    size = np.zeros(len(signal))
    if len(time) >= 4:
        begun = _beginning(signal, time, tau)
        _, _, moving, turns = begun
        size = (np.minimum(turns, 1.0) * moving * np.ptp(signal, axis=1, keepdims=True))[:, 0]
        if not within(time):
            size = np.maximum(size, np.abs(_lag(signal, tau, begun)))
    return np.exp(-(time - time[0]) / tau), size


def _followed(signal: Array, time: Array, params: Array) -> Array:
    """Where a low-pass stands at the first sample if the signal was before it what it is after it, (B,)."""
    if len(time) < 4:
        return signal[:, 0]
    tau = _time_constant(params)[:, None]
    return np.asarray(signal[:, 0] - _lag(signal, tau, _beginning(signal, time, tau)))


def _lag(signal: Array, tau: Array, begun: tuple[Array, Array, Array, Array]) -> Array:
    """How far it then stands behind the signal there, (B,); begun: see ``_beginning``.

    (τ ẋ − τ² ẍ)/(1 + τ² ω²) is exact for a wave of angular frequency ω about any centre, and for a straight line.
    """
    speed, bend, moving, turns = begun
    slowing = speed * bend < 0.0
    lag = (np.where(slowing, moving, 1.0) * tau * speed - moving * tau**2 * bend) / (1.0 + moving * turns)
    extent = np.ptp(signal, axis=1, keepdims=True)
    return np.asarray(np.clip(lag, -extent, extent)[:, 0])


def within(time: Array) -> bool:
    """Whether a signal begins within a recording: the samples of one average begin up to an interval after the recording does."""
    return len(time) > 1 and bool(time[0] >= time[1] - time[0])


def _beginning(signal: Array, time: Array, tau: Array, stretch: float = STRETCH) -> tuple[Array, Array, Array, Array]:
    """How signals (B, T) begin: speed, curvature, how far they are in motion (0 to 1), and (τ ω)² of their swing, each (B, 1).

    Within a recording all are in motion; at its beginning a signal that starts from rest was held before.
    """
    # A wave about c has ẍ = −ω² (x − c): a regression over a few time constants, or over the first few samples if those are longer.
    last = np.minimum(np.maximum(np.searchsorted(time, time[0] + stretch * tau), EDGE + FEW), len(time)) - 1
    # The slopes of slopes up to there need a few samples more.
    seen = slice(0, int(last.max()) + 1 + 2 * EDGE)
    bends = _slope(_slope(signal[:, seen], time[seen]), time[seen])
    inside = np.arange(len(time[seen])) >= EDGE
    centred = signal[:, seen] - signal[:, :1]
    products = (np.ones_like(bends), centred, bends, centred * bends, centred**2)
    count, x, b, xb, xx = (np.take_along_axis(np.cumsum(inside * p, axis=1), last, axis=1) for p in products)
    turns = tau**2 * np.maximum(x * b - count * xb, 0.0) / np.maximum(count * xx - x**2, 1e-300)
    speed, bend = _at_first(signal, time)
    if within(time):
        return speed, bend, np.ones_like(speed), turns
    # What has just left rest follows x = b t²/2, and of that the filter keeps 1 − e^(−t/τ) of what it keeps of a wave, t = ẋ/ẍ.
    # What slows down has moved before, unless it only seems to.
    since = np.clip(speed * bend / (tau * bend**2 + 1e-300), -AGES, AGES)
    return speed, bend, -np.expm1(np.where(since > 0.0, -since, -(since**2))), turns


def _moments(u: Array) -> tuple[Array, Array, Array, Array]:
    """∫₀¹ u e^{−u(1−w)} wᵏ dw for k = 0 … 3: what a step in the input's k-th power leaves at the step's end."""
    short = np.minimum(u, SHORT_STEP)
    by_quadrature = [
        sum((weight * short * np.exp(-short * (1.0 - node)) * node**k for node, weight in zip(_NODES, _WEIGHTS,
        strict=True)),
            np.zeros_like(u))
        for k in range(4)
    ]  # fmt: skip
    long = np.maximum(u, SHORT_STEP)
    by_recursion = [1.0 - np.exp(-long)]
    for k in range(1, 4):
        by_recursion.append(1.0 - k * by_recursion[-1] / long)
    chosen = [np.where(u < SHORT_STEP, q, r) for q, r in zip(by_quadrature, by_recursion, strict=True)]
    return chosen[0], chosen[1], chosen[2], chosen[3]


@njit(cache=True, error_model="numpy")
def _relax(decay: Array, driven: Array, start: Array) -> Array:
    """y[k+1] = decay[k] y[k] + driven[k] from ``start``; decay, driven (B, T−1) -> (B, T)."""
    lanes, steps = driven.shape
    out = np.empty((lanes, steps + 1))
    for lane in range(lanes):
        y = start[lane]
        out[lane, 0] = y
        for k in range(steps):
            y = decay[lane, k] * y + driven[lane, k]
            out[lane, k + 1] = y
    return out
