"""Runs of elastic mechanisms in steps that the swing needs and the vibration does not, where that shows in no channel.

Every run is made twice, the second time in half the steps; what the first one changes in the channels says how far off the
second can be. Where that could be seen behind the noise, steps are halved again, and in the end resolve the vibration.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from harness.denoc.lanes import LaneModel
from harness.denoc.lanes_exponential import linearization, march, smooth
from harness.diagnose.problem import ChannelInfo
from harness.recording.sensors import observe

Array = NDArray[np.float64]
Motion = tuple[Array, Array, Array]

# What half the steps may change in the sum of squares of a run, in variances of the noise. Errors of order 4 leave a 225th of
# it; of order 2, where efforts have kinks and several joints turn, a ninth.
SHOWN = 0.3
FINEST = 32  # steps between two states that are handed over
STIFF = 0.5  # rad that the fastest vibration turns in a step; below, steps that resolve it cost no more
FEWEST = 16  # states that are worth it


@dataclass(frozen=True, eq=False)
class StiffRuns:
    """Chooses the method for every request by itself, so that the differences of its runs are those of the motions.

    channels: whose noise (C,), one standard deviation each, the error is held against.
    """

    channels: tuple[ChannelInfo, ...]
    noise: Array
    # Where the last requests of a mechanism ended: what to begin with, and nothing else.
    _usual: dict[tuple[int, float], int] = field(default_factory=dict, init=False, repr=False)

    def run(
        self, model: LaneModel, rows: Array, states: Array, time: Array, tau: Array | None, requests: Array,
        tolerance: float, threads: int,
    ) -> Motion:  # fmt: skip
        """Position, velocity, acceleration (B, T, n) of rows (B, P) from states (B, 2n) under efforts (B, T, n).

        See ``LaneModel.simulate``. requests: which request a run belongs to, (B,).
        """
        out = tuple(np.empty((len(rows), len(time), model.n)) for _ in range(3))
        slow = np.ones(len(rows), dtype=bool)
        left = self._worth_it(model, rows, states, time, requests)
        key = (id(model), float(time[1] - time[0]) if len(time) > 1 else 0.0)
        inner = self._usual.get(key, 2)
        linear = linearization(model, rows[left], states[left])

        def run(steps: int) -> Motion:
            forces = None if tau is None else tau[left]
            return march(model, rows[left], states[left], time, steps, linear, tau=forces, threads=threads)[:3]

        coarse: Motion | None = None
        while len(left) and inner <= FINEST:
            if coarse is None:
                coarse = run(inner // 2)
            fine = run(inner)
            changed = self._changed(model, rows[left], coarse, fine)
            bad = np.isin(requests[left], requests[left[~(changed < SHOWN)]])
            for array, part in zip(out, fine, strict=True):
                array[left[~bad]] = part[~bad]
            slow[left[~bad]] = False
            if not bad.all():
                self._usual[key] = inner
            coarse, linear, left, inner = (fine[0][bad], fine[1][bad], fine[2][bad]), linear[bad], left[bad], 2 * inner
        if slow.any():
            q, qd = np.split(states[slow], 2, axis=1)
            forces = None if tau is None else tau[slow]
            resolved = model.simulate(rows[slow], q, qd, time, tau=forces, tolerance=tolerance, threads=threads)
            for array, part in zip(out, resolved, strict=True):
                array[slow] = part
        return out[0], out[1], out[2]

    def _worth_it(self, model: LaneModel, rows: Array, states: Array, time: Array, requests: Array) -> NDArray[np.intp]:
        """Runs of the requests that move smoothly and vibrate fast."""
        if model.user or len(time) < FEWEST:
            return np.zeros(0, dtype=np.intp)
        asked, first = np.unique(requests, return_index=True)
        linear = linearization(model, rows[first], states[first])
        turn = np.abs(np.linalg.eigvals(np.nan_to_num(linear))).max(axis=1) * (time[1] - time[0])
        rough = requests[np.logical_not(smooth(model, rows))]
        return np.flatnonzero(np.isin(requests, asked[turn > 2 * STIFF]) & ~np.isin(requests, rough))

    def _changed(self, model: LaneModel, rows: Array, coarse: Motion, fine: Motion) -> Array:
        """Sum of squares (B,) of what half the steps change in the channels, in variances of the noise; nan where a run failed."""
        total = np.zeros(len(rows))
        for channel, noise in zip(self.channels, self.noise, strict=True):
            seen = [observe(model, rows, channel.site, channel.quantity, motion) for motion in (coarse, fine)]
            total += (((seen[0] - seen[1]) / noise) ** 2).sum(axis=1)
        return total
