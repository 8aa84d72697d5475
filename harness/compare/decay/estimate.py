"""All the ways of reading damping off one decay, side by side."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from harness.compare.decay import decrement as by_decrement
from harness.compare.decay import envelope as by_envelope
from harness.compare.decay import likelihood as by_likelihood
from harness.compare.decay.decrement import Decrement
from harness.compare.decay.envelope import Envelope
from harness.compare.decay.likelihood import Likelihood
from harness.compare.decay.oscillator import LAWS, Array, amplitudes
from harness.compare.decay.swings import ABOVE_NOISE, HalfSwings, half_swings, restoring_told

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
    by how the frequency goes with the amplitude, and where that does not tell, by which fits the motion better.
    What comes before the signal has first fallen to nine tenths of its way is left out: a held start is no motion.
    Raises InputError if fewer than four half-swings stand out of the noise.
    """
    rough = half_swings(time, signal, sine=sine)
    if sine is None and not restoring_told(rough):
        return min((estimate(time, signal, sine=law) for law in (True, False)), key=lambda decay: decay.likelihood.bic)
    away = np.abs(signal - rough.rest)
    begun = int(np.argmax(away < 0.9 * float(away[: max(2, len(away) // 4)].max())))
    t, x = time[begun:], signal[begun:]
    found = half_swings(t, x, sine=rough.sine)
    read = by_decrement.decrement(found)
    shape = by_envelope.envelope(found)
    best, tried = by_likelihood.best(t, x, found)
    return Decay(t, x, found, read, shape, best, tried, departure(found, until=float(t[-1])))


def departure(found: HalfSwings, *, until: float | None = None, early: float = 4.0, left: float = LEFT) -> float | None:
    """When viscous damping read off the first swings left the amplitudes for good by the share ``left`` [s]; None if it has not.

    until: the end of the recording [s], where it goes on behind the last half-swing: what stopped has been left by a model that
    goes on. early: swings that the damping is read off, as the paper does.
    """
    count = max(4, min(len(found.amplitude), int(2.0 * early) + 1))
    first = replace(
        found,
        time=found.time[:count],
        amplitude=found.amplitude[:count],
        frequency=found.frequency[:count],
        std=found.std[:count],
    )
    linear = by_envelope.envelope(first, ("viscous",))
    time, amplitude = found.time, found.amplitude
    beat = float(np.median(np.diff(time)))
    if until is not None and until - time[-1] > 2.0 * beat:
        time = np.append(time, time[-1] + beat)
        amplitude = np.append(amplitude, ABOVE_NOISE * found.noise)  # no half-swing of this size stood out any more
    predicted = amplitudes(
        float(linear.amplitude[0]),
        len(amplitude),
        linear.coefficients,
        2.0 * np.pi * found.small,
        sine=found.sine,
    )
    off = np.abs(predicted - amplitude) > left * amplitude + 3.0 * found.noise
    if len(amplitude) > len(found.amplitude):
        # What is too small to be seen in the prediction as well says nothing.
        off = (
            np.append(off[:-1], True) if predicted[-1] > (1.0 + left) * amplitude[-1] + 3.0 * found.noise else off[:-1]
        )
    if not off[-1]:
        return None
    stays = np.flatnonzero(~off)
    return float(time[stays[-1] + 1 if len(stays) else 0])
