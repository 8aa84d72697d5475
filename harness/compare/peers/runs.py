"""Recordings as peers are given them: joint angles and efforts over time, nothing that a diagnosis found out about
them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from harness.recording import Recording
from harness.system import System

Array = NDArray[np.float64]

FIRST = 0.03  # s of a run that its first state is read off from, and at least ten samples
FINEST = 2e-3  # s, between samples that are fitted where nothing drives


class NotForIt(ValueError):
    """A rig that a peer is not made for: it is not asked, which counts neither for nor against it."""


@dataclass(frozen=True)
class Run:
    """Positions (T, n) [rad or m] over time (T,) [s], efforts (T, n) [N·m or N] or None where the joints are free."""

    time: Array
    positions: Array
    efforts: Array | None = None

    @property
    def driven(self) -> bool:
        return self.efforts is not None and bool(np.any(self.efforts))

    def cut(self, window: float | None, left_out: Sequence[tuple[float, float]] = ()) -> list[Run]:
        """Windows of about that length [s], the whole run if None; those that touch a stretch left out are dropped."""
        pieces = 1 if window is None else max(1, round(float(self.time[-1] - self.time[0]) / window))
        edges = np.round(np.linspace(0, len(self.time), pieces + 1)).astype(int)
        found = []
        for a, b in pairwise(edges):
            time = self.time[a:b]
            if b - a >= 10 and not any(time[0] <= last and time[-1] >= first for first, last in left_out):
                found.append(Run(time, self.positions[a:b], None if self.efforts is None else self.efforts[a:b]))
        return found

    def between(self, left_out: Sequence[tuple[float, float]]) -> list[Run]:
        """What is left of it without some stretches [s], each piece a run."""
        kept = np.ones(len(self.time), dtype=bool)
        for first, last in left_out:
            kept &= (self.time < first) | (self.time > last)
        edges = np.flatnonzero(np.diff(np.r_[False, kept, False].astype(np.int8)))
        return [
            Run(self.time[a:b], self.positions[a:b], None if self.efforts is None else self.efforts[a:b])
            for a, b in edges.reshape(-1, 2)
        ]

    def thinned(self) -> Run:
        """Every so many-th sample, so that neighbours are not much closer than ``FINEST``; driven ones as they are."""
        every = int(FINEST / float(np.median(np.diff(self.time))) + 1e-6)
        return self if self.efforts is not None or every < 2 else Run(self.time[::every], self.positions[::every])

    def acting(self, held: bool) -> Run:
        """Efforts that act on average from each sample to the next; see ``acting``."""
        return self if self.efforts is None else Run(self.time, self.positions, acting(self.efforts, held))

    def at_samples(self, held: bool) -> Run:
        """Efforts at the samples themselves, where held ones jump: half of what was and of what comes."""
        if self.efforts is None or not held:
            return self
        return Run(
            self.time, self.positions, np.vstack([self.efforts[:1], 0.5 * (self.efforts[:-1] + self.efforts[1:])])
        )

    def first_state(self) -> Array:
        """Position and velocity at the first sample from a local parabola, (2n,)."""
        count = max(10, int(np.searchsorted(self.time - self.time[0], FIRST)))
        fits = [
            np.polynomial.polynomial.polyfit(self.time[:count] - self.time[0], p[:count], 2) for p in self.positions.T
        ]
        return np.array([f[0] for f in fits] + [f[1] for f in fits])


def acting(efforts: Array, held: bool) -> Array:
    """Efforts (T, n) that act on average from each sample to the next: as sampled where a controller holds them, between the two
    where they are smooth."""
    return efforts if held else np.vstack([0.5 * (efforts[:-1] + efforts[1:]), efforts[-1:]])


def pushed(time: Array, tau: Array | None, held: bool) -> Array:
    """The same of the one joint of a rig, (T,); nothing where no effort (T, 1) is known."""
    return np.zeros(len(time)) if tau is None else np.ascontiguousarray(acting(tau, held)[:, 0])


def ways(runs: Sequence[Run], held: bool | None = None) -> tuple[bool, ...]:
    """Whether efforts may be held from sample to sample: as told, or both where something drives and nobody says it."""
    if held is not None:
        return (held,)
    return (False, True) if any(run.driven for run in runs) else (False,)


def as_run(system: System, recording: Recording) -> Run:
    """A recording's joint angles, single samples left out as outliers interpolated, and its efforts."""
    positions = []
    for joint in system.joint_names:
        values = recording.channel(f"{joint}.position").values
        good = np.isfinite(values)
        positions.append(np.interp(recording.time, recording.time[good], values[good]))
    found = np.stack(positions, axis=1)
    if not recording.efforts:
        return Run(recording.time, found)
    tau = np.zeros_like(found)
    for channel in recording.efforts:
        if channel.site in system.joint_names:
            tau[:, system.joint_names.index(channel.site)] = channel.values
    return Run(recording.time, found, tau)


def heldout_error(simulate: Callable[[Array, Array, Array | None], Array], runs: Sequence[Run]) -> float:
    """Root mean square of free runs over recordings, nothing but their first states fitted [rad or m].

    simulate: state (2n,), time (T,), efforts (T, n) or None -> positions (T, n).
    """
    left = []
    for run in runs:

        def misfit(x: Array, run: Run = run) -> Array:
            return np.nan_to_num((simulate(x, run.time, run.efforts) - run.positions).ravel(), nan=1e3)

        state = run.first_state()
        scale = np.repeat([1e-2, 1e-1], len(state) // 2)
        left.append(least_squares(misfit, state, x_scale=scale, max_nfev=30).fun)
    return float(np.sqrt(np.mean(np.concatenate(left) ** 2)))
