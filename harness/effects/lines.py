"""Steady lines in a channel's spectrum, far above the motion: hum that a cable picks up, a fan, a supply that switches."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from harness.effects.measured import MeasuredChannel
from harness.effects.scale import references
from harness.system import System
from harness.system.description import Array

LOUD = 20.0  # times the power around it: noise alone reaches that in e⁻²⁰ of the bins
AROUND = 65  # bins whose median is the power around a line
ABOVE = 6.0  # times the joint's own frequency, from which on a line is looked for
STEADY = 0.5  # of its amplitude in one half of a recording that a line must have in the other; vibrations die out
BEATS = 16.0  # bins from half the sampling rate
FEWEST = 128  # samples
STRONGEST = 8  # peaks looked at


def lines_of(system: System, channel: MeasuredChannel, time: Array) -> tuple[float, ...]:
    """``steady_lines`` of a channel, above the motion of the joint that it belongs to."""
    return steady_lines(time, channel.values, references(system, channel.name).frequency / (2.0 * np.pi))


def steady_lines(time: Array, values: Array, own: float) -> tuple[float, ...]:
    """Frequencies [Hz] of the strongest steady lines above the slow motion, loudest first; overtones of a swing may be among them.

    time: [s], ascending, shape (T,). values: shape (T,), nan where there is none. own: of the joint's small swing [Hz].
    A frequency above half the sampling rate shows as its alias.
    """
    seen = np.isfinite(values)
    if seen.sum() < FEWEST:
        return ()
    interval = float(np.median(np.diff(time)))
    stamps = np.arange(time[0], time[-1], interval)
    even = np.interp(stamps, time[seen], values[seen])
    # Where hum is weak, the motion's ends must not leak into its place: a Hann window falls off by the cube.
    taper = np.hanning(len(even) + 2)[1:-1]
    power = np.abs(np.fft.rfft(taper * (even - even.mean()))) ** 2
    frequency = np.fft.rfftfreq(len(even), interval)
    around = median_filter(power, min(AROUND, len(power)), mode="mirror") / np.log(2.0)
    ratio = power / np.maximum(around, 1e-300)
    # The last bin, half the sampling rate, counts as a peak too: mains at twice their frequency stand there.
    padded = np.concatenate([[np.inf], power, [0.0]])
    peak = (power >= padded[:-2]) & (power > padded[2:])
    loud = np.flatnonzero(peak & (ratio > LOUD) & (frequency > ABOVE * own))
    strongest = loud[np.argsort(-power[loud])][:STRONGEST]
    mirrored = np.append(power, power[-2])
    exact = [float(frequency[k] + _beside(mirrored[k - 1 : k + 2]) * frequency[1]) for k in strongest]
    # Near half the sampling rate a line beats with its mirror image, however steady it is.
    beats = 0.5 / interval - BEATS * frequency[1]
    return tuple(line for line in exact if line > beats or _is_steady(even, interval, line))


def _beside(three: Array) -> float:
    """Where a line lies from the middle one of three bins of a Hann-windowed spectrum, in bins."""
    low, middle, high = np.sqrt(three)
    # Neighbours of a line d bins off the middle have amplitudes (1 ± d)/(2 ∓ d) of the middle's, to which d is the exact answer.
    side, sign = (high, 1.0) if high > low else (low, -1.0)
    share = side / middle
    return float(sign * np.clip((2.0 * share - 1.0) / (1.0 + share), 0.0, 0.5))


def _is_steady(even: Array, interval: float, frequency: float) -> bool:
    """Whether both halves of a signal have a line alike."""
    sizes = []
    for half in np.array_split(even, 2):
        taper = np.hanning(len(half) + 2)[1:-1]
        wave = np.exp(-2j * np.pi * frequency * interval * np.arange(len(half)))
        sizes.append(abs(np.sum(taper * (half - half.mean()) * wave)))
    return min(sizes) > STEADY * max(sizes)
