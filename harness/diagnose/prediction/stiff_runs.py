"""Runs of elastic mechanisms in steps that the swing needs and the vibration does not, where that shows in no channel.

Runs are made twice, the second time in half the steps; what the first one changes in the channels says how far off the
second can be. Where that could be seen behind the noise, steps are halved again, and in the end resolve the vibration.
Of runs that hardly differ, as those for derivatives, one is made twice for all. A vibration that every step of an effort excites
anew may ask for more steps than a run is given: such requests are run again to a coarser tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.lanes.exponential import linearization, march, smooth
from harness.denoc.lanes.model import LaneModel
from harness.denoc.motion.hold import joined
from harness.diagnose.prediction.constants import (
    ALIKE_ROW_DIFFERENCE,
    ALIKE_STATE_DIFFERENCE,
    COARSER_TOLERANCE,
    EASY_STEP_SHARE,
    FEWEST_STIFF_STATES,
    HALVED_STEP_CHANGE,
    MOST_INNER_STEPS,
    STIFF_TURN,
)
from harness.diagnose.problem.problem import ChannelInfo
from harness.recording.sensors import observe

Array = NDArray[np.float64]
Motion = tuple[Array, Array, Array]


@dataclass(frozen=True, eq=False)
class StiffRuns:
    """Chooses the method for every request by itself, so that the differences of its runs are those of the motions.

    channels: whose noise (C,), one standard deviation each, the error is held against.
    """

    channels: tuple[ChannelInfo, ...]
    noise: Array
    # Where the last requests of a mechanism ended: what to begin with, and nothing else.
    _usual: dict[tuple[int, float], int] = field(default_factory=dict, init=False, repr=False)
    # Mechanisms whose runs took more steps than they are given.
    _coarser: set[int] = field(default_factory=set, init=False, repr=False)

    def run(
        self, model: LaneModel, rows: Array, states: Array, time: Array, tau: Array | None, requests: Array,
        tolerance: float, hold: str, threads: int, counts: NDArray[np.int64] | None = None,
        between: Callable[[], None] = lambda: None,
    ) -> Motion:  # fmt: skip
        """Position, velocity, acceleration (B, T, n) of rows (B, P) from states (B, 2n) under efforts (B, T, n).

        See ``LaneModel.simulate``. requests: which request a run belongs to, (B,). between: called between parts of it.
        """
        counts = np.full(len(rows), len(time)) if counts is None else counts
        shape = (len(rows), len(time), model.n)
        out = np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape, np.nan)
        slow = np.ones(len(rows), dtype=bool)
        straight = joined(tau) if tau is not None and hold == "zero" else tau
        for count in np.unique(counts).tolist():
            which = np.flatnonzero(counts == count)
            forces = None if straight is None else straight[which, :count]
            between()
            motion, fits = self._smooth(
                model, rows[which], states[which], time[:count], forces, requests[which], threads
            )
            for array, part in zip(out, motion, strict=True):
                array[which[fits], :count] = part[fits]
            slow[which[fits]] = False
        if slow.any():
            resolved = self._resolved(
                model, rows[slow], states[slow], time, None if tau is None else tau[slow], requests[slow], tolerance,
                {"hold": hold, "threads": threads, "between": between}, counts[slow],
            )  # fmt: skip
            for array, part in zip(out, resolved, strict=True):
                array[slow] = part
        return out

    def _resolved(
        self, model: LaneModel, rows: Array, states: Array, time: Array, tau: Array | None, requests: Array,
        tolerance: float, how: Mapping[str, Any], counts: NDArray[np.int64],
    ) -> Motion:  # fmt: skip
        """Runs in steps that resolve the vibration; requests that are lost at the tolerance are run again to a coarser one."""

        def run(some: NDArray[np.bool_], error: float) -> Motion:
            q, qd = np.split(states[some], 2, axis=1)
            forces = None if tau is None else tau[some]
            return model.simulate(rows[some], q, qd, time, tau=forces, tolerance=error, counts=counts[some], **how)

        def lost(motion: Motion, some: NDArray[np.bool_]) -> NDArray[np.bool_]:
            ends = motion[0][np.arange(len(motion[0])), counts[some] - 1]
            return np.asarray(~np.isfinite(ends).all(axis=1), dtype=np.bool_)

        every = np.ones(len(rows), dtype=np.bool_)
        error = COARSER_TOLERANCE if id(model) in self._coarser else tolerance
        found = run(every, error)
        failed = lost(found, every)
        if error < COARSER_TOLERANCE and failed.any():
            again = np.isin(requests, requests[failed])
            coarse = run(again, COARSER_TOLERANCE)
            for array, part in zip(found, coarse, strict=True):
                array[again] = part
            if lost(coarse, again).sum() < failed.sum():
                self._coarser.add(id(model))
        return found

    def _smooth(
        self,
        model: LaneModel,
        rows: Array,
        states: Array,
        time: Array,
        tau: Array | None,
        requests: Array,
        threads: int,
    ) -> tuple[Motion, NDArray[np.bool_]]:
        """Runs in steps that are longer than the vibration, and which of them may be taken, (B,)."""
        shape = (len(rows), len(time), model.n)
        out = np.empty(shape), np.empty(shape), np.empty(shape)
        fits = np.zeros(len(rows), dtype=bool)
        left = self._worth_it(model, rows, states, time, requests)
        key = (id(model), float(time[1] - time[0]) if len(time) > 1 else 0.0)
        inner = self._usual.get(key, 2)
        linear = linearization(model, rows[left], states[left])

        def run(steps: int, some: NDArray[np.intp]) -> Motion:
            which = left[some]
            forces = None if tau is None else tau[which]
            return march(model, rows[which], states[which], time, steps, linear[some], tau=forces, threads=threads)[:3]

        coarse: Motion | None = None
        while len(left) and inner <= MOST_INNER_STEPS:
            # One run of each kind is made twice.
            twice, kind = _kinds(rows[left], states[left], requests[left])
            coarse = (
                run(inner // 2, twice) if coarse is None else (coarse[0][twice], coarse[1][twice], coarse[2][twice])
            )
            fine = run(inner, np.arange(len(left)))
            changed = self._changed(model, rows[left[twice]], coarse, (fine[0][twice], fine[1][twice], fine[2][twice]))
            lost = ~np.isfinite(fine[0]).all(axis=(1, 2))
            bad = np.isin(requests[left], requests[left[~(changed < HALVED_STEP_CHANGE)[kind] | lost]])
            for array, part in zip(out, fine, strict=True):
                array[left[~bad]] = part[~bad]
            fits[left[~bad]] = True
            if not bad.all():
                self._usual[key] = max(2, inner // 2) if changed.max() < EASY_STEP_SHARE * HALVED_STEP_CHANGE else inner
            coarse, linear, left, inner = (fine[0][bad], fine[1][bad], fine[2][bad]), linear[bad], left[bad], 2 * inner
        return out, fits

    def _worth_it(self, model: LaneModel, rows: Array, states: Array, time: Array, requests: Array) -> NDArray[np.intp]:
        """Runs of the requests that move smoothly and vibrate fast."""
        if model.user or len(time) < FEWEST_STIFF_STATES:
            return np.zeros(0, dtype=np.intp)
        asked, first = np.unique(requests, return_index=True)
        linear = linearization(model, rows[first], states[first])
        turn = np.abs(np.linalg.eigvals(np.nan_to_num(linear))).max(axis=1) * (time[1] - time[0])
        rough = requests[np.logical_not(smooth(model, rows))]
        return np.flatnonzero(np.isin(requests, asked[turn > 2 * STIFF_TURN]) & ~np.isin(requests, rough))

    def _changed(self, model: LaneModel, rows: Array, coarse: Motion, fine: Motion) -> Array:
        """Sum of squares (B,) of what half the steps change in the channels, in variances of the noise; nan where a run failed."""
        total = np.zeros(len(rows))
        # Steps that are too long may lead out of the numbers.
        with np.errstate(over="ignore", invalid="ignore"):
            for channel, noise in zip(self.channels, self.noise, strict=True):
                seen = [observe(model, rows, channel.site, channel.quantity, motion) for motion in (coarse, fine)]
                total += (((seen[0] - seen[1]) / noise) ** 2).sum(axis=1)
        return total


def _kinds(rows: Array, states: Array, requests: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Runs (B,) that stand for all others of their request that hardly differ from them, and which of these each belongs to."""
    found: list[int] = []
    kind = np.full(len(rows), -1, dtype=np.intp)
    while (kind < 0).any():
        k = int(np.argmax(kind < 0))
        alike = (requests == requests[k]) & (kind < 0)
        alike &= (np.abs(rows - rows[k]) <= ALIKE_ROW_DIFFERENCE * np.abs(rows[k])).all(axis=1)
        alike &= (np.abs(states - states[k]) <= ALIKE_STATE_DIFFERENCE * np.maximum(1.0, np.abs(states[k]))).all(axis=1)
        alike[k] = True
        kind[alike] = len(found)
        found.append(k)
    return np.array(found, dtype=np.intp), kind
