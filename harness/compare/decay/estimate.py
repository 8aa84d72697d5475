"""All the ways of reading damping off one decay, side by side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.compare.decay import decrement as by_decrement
from harness.compare.decay import envelope as by_envelope
from harness.compare.decay import likelihood as by_likelihood
from harness.compare.decay.decrement import Decrement
from harness.compare.decay.envelope import Envelope
from harness.compare.decay.likelihood import Likelihood
from harness.compare.decay.oscillator import LAWS, Array, amplitudes
from harness.compare.decay.swings import HalfSwings, half_swings

# A linear model has left the recording where its amplitude is this far off, relative.
LEFT = 0.1


@dataclass(frozen=True, eq=False)
class Decay:
    """A decay read in every way; coefficients are over the inertia.

    time, signal: from where the motion is taken (T,). swings: its half-swings. decrement: logarithmic, printed and corrected.
    envelope: all three laws from the amplitudes. likelihood: the best set of laws from every sample; tried: all sets.
    linear: viscous damping alone from every sample. departure: when the model with the decrement's damping has left the recording's
    amplitudes by a tenth [s], None if it does not.
    """

    time: Array
    signal: Array
    swings: HalfSwings
    decrement: Decrement
    envelope: Envelope
    likelihood: Likelihood
    tried: tuple[Likelihood, ...]
    departure: float | None

    @property
    def linear(self) -> Likelihood:
        """Viscous damping alone."""
        return next(one for one in self.tried if one.laws == ("viscous",))

    @property
    def all_laws(self) -> Likelihood:
        """All three laws free."""
        return next(one for one in self.tried if one.laws == LAWS)


def estimate(time: Array, signal: Array, *, sine: bool | None = None) -> Decay:
    """Damping of a freely swinging signal.

    time [s], signal: (T,). sine: whether the restoring force goes with the sine of the signal (a pendulum's angle); None decides
    by how the frequency goes with the amplitude. What comes before the signal has first fallen to nine tenths of its way is
    left out: a held start is no motion.
    Raises InputError if fewer than four half-swings stand out of the noise.
    """
    rough = half_swings(time, signal, sine=sine)
    away = np.abs(signal - rough.rest)
    begun = int(np.argmax(away < 0.9 * float(away[: max(2, len(away) // 4)].max())))
    t, x = time[begun:], signal[begun:]
    found = half_swings(t, x, sine=rough.sine)
    read = by_decrement.decrement(found)
    shape = by_envelope.envelope(found)
    best, tried = by_likelihood.best(t, x, found)
    return Decay(t, x, found, read, shape, best, tried, departure(found))


def departure(found: HalfSwings, *, early: float = 4.0, left: float = LEFT) -> float | None:
    """When viscous damping read off the first swings left the amplitudes for good by the share ``left`` [s]; None if it has not.

    early: swings that the damping is read off, as the paper does.
    """
    count = max(4, min(len(found.amplitude), int(2.0 * early) + 1))
    first = HalfSwings(
        found.time[:count],
        found.amplitude[:count],
        found.frequency[:count],
        found.std[:count],
        found.rest,
        found.sign,
        found.small,
        found.noise,
        found.sine,
    )
    linear = by_envelope.envelope(first, ("viscous",))
    predicted = amplitudes(
        float(linear.amplitude[0]),
        len(found.amplitude),
        linear.coefficients,
        2.0 * np.pi * found.small,
        sine=found.sine,
    )
    off = np.abs(predicted - found.amplitude) > left * found.amplitude + 3.0 * found.noise
    if not off[-1]:
        return None
    stays = np.flatnonzero(~off)
    return float(found.time[stays[-1] + 1 if len(stays) else 0])
