"""Gaussian likelihood of recordings: residuals whitened by the noise of their channel, samples weighted by what they tell.

A quantised reading that does not change tells nothing new: a stretch of k equal readings counts as one. Samples at the
very start of a window, whose past a sensor with memory would need, do not count, in any hypothesis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.estimation.scatter import crude_colours
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]


class ModelError(Protocol):
    """What an error of the model itself makes of residuals, beside the sensors' noise (``estimation.misfit``)."""

    @property
    def sensors(self) -> Likelihood:
        """The likelihood of the sensors' noise alone."""
        ...

    @property
    def together(self) -> tuple[float, ...]:
        """Samples of every channel that err together, and so count as one."""
        ...


@dataclass(frozen=True, eq=False)
class Likelihood:
    """Noise of every channel of a problem, and the samples' weights.

    colours: one a channel, at the sampling interval of the runs. lead: seconds at a window's start that do not count.
    discrepancy: what every hypothesis leaves out, None where the sensors' noise is all there is; colours are then as loud as that.
    """

    problem: Problem
    colours: tuple[Colour, ...]
    lead: float = 0.0
    discrepancy: ModelError | None = None
    _weights: dict[Window, Array] = field(default_factory=dict, init=False, repr=False)

    def weights(self, window: Window) -> Array:
        """Square roots of the samples' weights, shape (C, T); not to be written to."""
        if window not in self._weights:
            self._weights[window] = self._weigh(window)
        return self._weights[window]

    def _weigh(self, window: Window) -> Array:
        run = self.problem.runs[window.run]
        part = slice(window.first, window.last)
        values = run.values[:, part]
        out = np.isfinite(values).astype(np.float64)
        # Only what scatters from sample to sample lets rounded readings tell more than one another: not slow noise, and not an
        # error of the model that was taken for it. So the weights are those of the recordings, whatever noise is assumed.
        for c, (step, scatter) in enumerate(zip(self.problem.steps, crude_colours(self.problem), strict=True)):
            if step > 0.0 and step > scatter.std:
                out[c] /= np.sqrt(_stretches(values[c], 0.5 * step / max(run.averaged, 1)))
        out[:, (run.time[part] - run.time[window.first]) < self.lead] = 0.0
        if self.discrepancy is not None:
            out /= np.sqrt(self.discrepancy.together)[:, None]
        return out

    def whiten(self, window: Window, predictions: list[Array]) -> Array:
        """Whitened residuals prediction − measurement of several lanes of one window, shape (L, C·T)."""
        run = self.problem.runs[window.run]
        values = run.values[:, window.first : window.last]
        raw = np.array(predictions) - values
        if not np.isfinite(raw).all():
            raw[~np.isfinite(raw)] = 0.0
        return self.whiten_signal(window, raw)

    def whiten_windows(self, windows: Sequence[Window], predictions: Sequence[Array]) -> list[Array]:
        """The same for equally many lanes of several windows, window after window: (L, C·T) of every window."""
        lanes = len(predictions) // len(windows)
        out: list[Array] = [np.empty(0)] * len(windows)
        sizes: dict[int, list[int]] = {}
        for k, window in enumerate(windows):
            sizes.setdefault(window.size, []).append(k)
        for size, which in sizes.items():
            runs = [self.problem.runs[windows[k].run].values[:, windows[k].first : windows[k].last] for k in which]
            raw = np.array([p for k in which for p in predictions[k * lanes : (k + 1) * lanes]])
            raw = raw.reshape(len(which), lanes, -1, size) - np.array(runs)[:, None]
            if not np.isfinite(raw).all():
                raw[~np.isfinite(raw)] = 0.0
            for c, colour in enumerate(self.colours):
                raw[:, :, c] = colour.whiten(raw[:, :, c])
            raw *= np.array([self.weights(windows[k]) for k in which])[:, None]
            for k, own in zip(which, raw.reshape(len(which), lanes, -1), strict=True):
                out[k] = own
        return out

    def whiten_signal(self, window: Window, signal: Array) -> Array:
        """The same for a signal (L, C, T) given outright, in its place."""
        for c, colour in enumerate(self.colours):
            signal[:, c] = colour.whiten(signal[:, c])
        signal *= self.weights(window)
        # Where there is none, too: a short window may have no course that is slow enough.
        return signal.reshape(len(signal), signal.shape[1] * signal.shape[2])

    @property
    def of_sensors(self) -> Likelihood:
        """The same with nothing but the sensors' noise."""
        return self if self.discrepancy is None else self.discrepancy.sensors

    @property
    def as_scattered(self) -> Likelihood:
        """The same with the sensors' noise alone, as the channels' own scatter shows it."""
        return replace(self.of_sensors, colours=crude_colours(self.problem))

    def roundest(self, channel: int) -> float:
        """Mean square that rounding alone may reach in a stretch of a channel, in units of the noise's variance; one at least.

        No reading is off by more than half a step, but a slow motion may be off by that much all along.
        """
        return max(1.0, (0.5 * self.problem.steps[channel] / self.colours[channel].std) ** 2)

    @property
    def rounded(self) -> float:
        """The same of whichever channel is rounded most."""
        return max(self.roundest(c) for c in range(len(self.colours)))

    def spread(self, windows: tuple[Window, ...]) -> float:
        """Log-determinant of the sensors' noise over windows, by which different estimates of it are weighed."""
        counts = np.sum([np.sum(self.weights(w) ** 2, axis=1) for w in windows], axis=0)
        return float(sum(2.0 * n * np.log(c.innovation[1]) for n, c in zip(counts, self.colours, strict=True)))

    def samples(self, windows: tuple[Window, ...]) -> float:
        """Sum of the weights over windows: the number of independent readings."""
        return float(sum(np.sum(self.weights(w) ** 2) for w in windows))


def _stretches(values: Array, tolerance: float) -> Array:
    """Length of the stretch of equal values that each sample belongs to, shape (T,)."""
    change = np.abs(np.diff(values)) > tolerance
    label = np.concatenate([[0], np.cumsum(change)])
    return np.asarray(np.bincount(label)[label], dtype=np.float64)
