"""A wire-wound potentiometer: the wiper drags, the calibration bends, and the voltage climbs from winding to winding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.system.description import Array


@dataclass(frozen=True)
class WireWound:
    """A wire-wound potentiometer read as an angle.

    travel: electrical angle [rad]; windings: over the whole travel, each a step of travel / windings. linearity: largest deviation
    from the straight line, as a share of full scale; it is taken as one wave over the travel. play: angle by which the wiper's
    friction lets it stay behind at a reversal [rad]. noise: standard deviation after the wiper [rad]. middle: angle of the shaft
    at the middle of the travel [rad].
    Defaults are a single-turn one of a thousand windings and 0.25 % (the paper prints 25 %).
    Source: E. O. Doebelin, Measurement Systems, 5th ed. (2004), §4.2: resolution, conformity and noise of resistive potentiometers.
    """

    travel: float = np.radians(340.0)
    windings: int = 1000
    linearity: float = 0.0025
    play: float = 0.0
    noise: float = 5e-4
    middle: float = 0.0

    @property
    def step(self) -> float:
        """Angle from winding to winding [rad]."""
        return self.travel / self.windings

    def read(self, angle: Array, rng: np.random.Generator | None = None) -> Array:
        """What it says of a shaft's angle [rad], (T,) to (T,); rng: of the noise, None leaves it out."""
        wiper = _drag(angle, self.play)
        bent = wiper + self.linearity * self.travel * np.sin(2.0 * np.pi * (wiper - self.middle) / self.travel)
        stepped = self.middle + self.step * np.round((bent - self.middle) / self.step)
        if rng is not None and self.noise:
            stepped = stepped + self.noise * rng.standard_normal(len(angle))
        return np.asarray(stepped)


def _drag(angle: Array, play: float) -> Array:
    """The wiper behind the shaft: it follows when the shaft is half the play ahead of it."""
    if play <= 0.0:
        return angle
    half = 0.5 * play
    out = np.empty_like(angle)
    at = float(angle[0])
    for k, shaft in enumerate(angle):
        at = min(max(at, shaft - half), shaft + half)
        out[k] = at
    return out
