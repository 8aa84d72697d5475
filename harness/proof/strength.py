"""How strongly something has to be concealed to show as clearly as asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.proof.plain import PlainRig
from harness.proof.rigs import Rig
from harness.proof.scene import Run, Scene, Sensor
from harness.proof.visibility import distance, moves, observe, profiled

Array = NDArray[np.float64]

RANGE = (1e-4, 6.0)
FIRST = 0.2
CLOSE = 0.25  # ratio, as a logarithm, of visibility and aim
FASTEST = 2.5  # growth of the strength in one step, over which nuisances follow
LINEAR_STEPS, STEPS = 3, 12


@dataclass(frozen=True, eq=False)
class Sight:
    """What a rig shows with nothing concealed, and what its nuisances (nominal quantities, initial states) can make of it.

    without: readings of the rig itself, one after the other; alone: the same by a plain simulation, on which the nuisances
    act, with its sensitivities and their standard deviations ``sigma``.
    """

    plain: PlainRig
    without: Array
    alone: Array
    sensitivities: Array
    sigma: Array

    @classmethod
    def of(cls, true: Rig, runs: Sequence[Run], sensor: Sensor, bare: Scene) -> Sight:
        """Of a rig that is let run and read; bare: the scene with nothing planted."""
        may = moves(true, len(runs))
        plain = PlainRig(true, runs, sensor, may)
        rest = np.zeros(len(may.sigma))
        without = np.concatenate(observe(bare))
        return cls(plain, without, plain.simulate(rest[None])[0], plain.sensitivities(rest), may.sigma)

    def strength(self, make: Callable[[float], Scene], aim: float) -> tuple[float, float]:
        """The strength whose visibility is nearest to the aim, and that visibility.

        The linear view, which takes for visible what large changes of the nuisances could make, says where to begin; from there
        nuisances follow the strength, since from far away there is no way to them.
        """
        strength = FIRST
        for _ in range(LINEAR_STEPS):
            seen = distance(np.concatenate(observe(make(strength))) - self.without, self.sensitivities, self.sigma)
            strength = float(np.clip(strength * np.clip(aim / max(seen, 1e-3), 1e-2, 30.0), *RANGE))
            if 0.5 < aim / max(seen, 1e-3) < 2.0:
                break
        known: dict[float, tuple[float, Array]] = {}
        for _ in range(STEPS):
            from_ = min(known, key=lambda f: abs(np.log(f / strength)), default=strength)
            start = known[from_][1] * (strength / from_) if known else np.zeros(len(self.sigma))
            known[strength] = self._distance(np.concatenate(observe(make(strength))), start)
            below = [f for f, (d, _) in known.items() if d < aim]
            above = [f for f, (d, _) in known.items() if d >= aim]
            nearest = min(known, key=lambda f: abs(np.log(max(known[f][0], 1e-3) / aim)))
            if abs(np.log(max(known[nearest][0], 1e-3) / aim)) < CLOSE:
                break
            if below and above:
                strength = float(np.sqrt(max(below) * min(above)))
            elif below:
                strength = max(below) * float(np.clip(aim / max(known[max(below)][0], 1e-3), 1.2, FASTEST))
            else:
                strength = min(above) / FASTEST
            strength = float(np.clip(strength, *RANGE))
            if strength in known:
                break
        # A mass moved over to where the swing is as fast again is followed into a valley that leads nowhere; seen afresh it is
        # hardly there (Kater's pendulum).
        afresh, _ = self._distance(np.concatenate(observe(make(nearest))), np.zeros(len(self.sigma)))
        return nearest, min(known[nearest][0], afresh)

    def _distance(self, seen: Array, start: Array) -> tuple[float, Array]:
        """How far readings are from what the nuisances can make, and the nuisances that come nearest."""
        return profiled(
            seen - self.without + self.alone,
            lambda z: self.plain.simulate(z[None])[0],
            self.plain.sensitivities,
            self.sigma,
            start=start,
        )
