"""The logarithmic decrement, as the paper prints it and as it is meant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.compare.decay.oscillator import Array
from harness.compare.decay.swings import HalfSwings


@dataclass(frozen=True, eq=False)
class Decrement:
    """Damping by the decrement.

    ratio: of successive amplitudes on the same side, the mean over the decay [1]. decrement: δ, and its standard uncertainty.
    damping_ratio: ζ = δ / √(4π² + δ²). viscous: 2 ζ ω, over the inertia [1/s], with its uncertainty. printed: what the
    paper's rule gives to the letter, ratio · 2 ω [1/s].
    by_amplitude: amplitudes (k,) and the decrement of each successive pair there (k,), constant if the damping is viscous.
    """

    ratio: float
    decrement: float
    std: float
    damping_ratio: float
    viscous: float
    viscous_std: float
    printed: float
    by_amplitude: tuple[Array, Array]


def decrement(found: HalfSwings) -> Decrement:
    """The decrement over all half-swings, each pair's own kept beside it.

    ln A over the number of swings is a straight line where damping is viscous and the swing small; its slope is −δ. The
    line is weighted by A², as white noise on the amplitudes asks.
    """
    circular = 2.0 * np.pi * found.small
    swings = 0.5 * np.arange(len(found.amplitude))
    logarithm, weight = np.log(found.amplitude), found.amplitude**2
    centre = np.sum(weight * swings) / np.sum(weight)
    spread = float(np.sum(weight * (swings - centre) ** 2))
    slope = float(np.sum(weight * (swings - centre) * logarithm) / spread)
    residual = logarithm - np.sum(weight * logarithm) / np.sum(weight) - slope * (swings - centre)
    std = float(np.sqrt(np.sum(weight * residual**2) / max(1, len(swings) - 2) / spread))
    delta = -slope
    ratio = delta / np.hypot(2.0 * np.pi, delta)
    pairs = np.log(found.amplitude[:-2] / found.amplitude[2:])
    return Decrement(
        ratio=float(np.mean(found.amplitude[2:] / found.amplitude[:-2])),
        decrement=delta,
        std=std,
        damping_ratio=float(ratio),
        viscous=float(2.0 * ratio * circular),
        viscous_std=float(2.0 * std / (2.0 * np.pi) * circular),
        printed=float(np.mean(found.amplitude[2:] / found.amplitude[:-2]) * 2.0 * circular),
        by_amplitude=(found.amplitude[1:-1], pairs),
    )
