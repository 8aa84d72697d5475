"""Differences of motions: how large, where and when they begin, and how far chaotic motion can be compared at all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.engines.protocol import EngineModel
from harness.system import Trajectory

Array = NDArray[np.float64]

# Two neighbouring regular motions drift apart in proportion to time, which doubles their distance over the second half
# of a run. Chaotic ones grow exponentially: more than this factor says so.
CHAOTIC_GROWTH = 20.0


@dataclass(frozen=True)
class FirstDivergence:
    """Where two motions first leave the allowed difference: time [s], coordinate, and their difference there."""

    time: float
    coordinate: str
    difference: float


@dataclass(frozen=True)
class Difference:
    """Two motions compared.

    largest, rms: over all coordinates and samples up to ``until`` [s]. first: where they part, if they do.
    """

    largest: float
    rms: float
    allowed: float
    until: float
    first: FirstDivergence | None

    @property
    def agree(self) -> bool:
        return self.first is None


@dataclass(frozen=True, eq=False)
class Horizon:
    """How far a motion can be predicted.

    until: last sample time at which neighbours started ``nudge`` apart are still within ``allowed`` [s].
    growth: mean rate at which the logarithm of their distance grows over the second half up to there [1/s].
    chaotic: whether that is faster than the drift of regular motions. separation: of the neighbours, shape (T,).
    complete: whether the whole run lies within the horizon.
    """

    until: float
    growth: float
    chaotic: bool
    complete: bool
    nudge: float
    allowed: float
    separation: Array

    def sentence(self) -> str:
        """For a table."""
        if self.complete:
            return "predictable over the whole run"
        kind = "chaotic" if self.chaotic else "regular, but sensitive"
        return (
            f"{kind}: neighbours {self.nudge:.0e} apart are {self.allowed:.0e} apart after {self.until:.2f} s "
            f"(divergence {self.growth:.1f} 1/s); compared up to there"
        )


def separation(a: Trajectory, b: Trajectory) -> tuple[tuple[str, ...], Array]:
    """Absolute differences of position of the coordinates both motions have: their names, and shape (T, k).

    Values that are not finite differ infinitely. Raises ValueError if the sample times differ or nothing is common.
    """
    if a.time.shape != b.time.shape or not np.allclose(a.time, b.time, rtol=0.0, atol=1e-9):
        raise ValueError("the motions are sampled at different times")
    common = tuple(name for name in a.names if name in b.names)
    if not common:
        raise ValueError("the motions have no coordinate in common")
    first = a.position[:, [a.names.index(name) for name in common]]
    second = b.position[:, [b.names.index(name) for name in common]]
    apart = np.abs(first - second)
    return common, np.where(np.isfinite(apart), apart, np.inf)


def compare(a: Trajectory, b: Trajectory, allowed: float, *, until: float | None = None) -> Difference:
    """The difference of two motions up to ``until`` [s] (to the end if None); allowed [rad or m]."""
    names, apart = separation(a, b)
    inside = np.ones(a.time.size, dtype=bool) if until is None else a.time <= until
    if not inside.any():
        raise ValueError(f"no sample lies before {until} s")
    within = apart[inside]
    over = within > allowed
    first = None
    if over.any():
        k = int(np.argmax(over.any(axis=1)))
        j = int(np.argmax(within[k]))
        first = FirstDivergence(float(a.time[k]), names[j], float(within[k, j]))
    with np.errstate(over="ignore"):
        rms = float(np.sqrt(np.mean(within**2)))
    return Difference(float(within.max()), rms, allowed, float(a.time[inside][-1]), first)


def horizon(
    model: EngineModel,
    q0: Array,
    qd0: Array,
    time: Array,
    *,
    allowed: float,
    nudge: float = 1e-10,
    neighbours: int = 3,
    step: float | None = None,
    seed: int = 0,
) -> Horizon:
    """Measure how far the motion from (q0, qd0) can be predicted, by neighbours started ``nudge`` [rad or m] apart.

    allowed: distance [rad or m] that ends the prediction. nudge: the size of what the engines do differently
    (rounding and integration error). neighbours: random directions tried, the fastest to leave counts.
    step: of the integration [s], the engine's own if None.
    """
    rng = np.random.default_rng(seed)
    start = model.simulate(q0, qd0, time, step=step)
    grown = np.zeros(time.size)
    for _ in range(neighbours):
        direction = rng.normal(size=q0.size)
        direction /= np.linalg.norm(direction)
        _, apart = separation(start, model.simulate(q0 + nudge * direction, qd0, time, step=step))
        grown = np.maximum(grown, apart.max(axis=1))
    left = grown > allowed
    complete = not left.any()
    last = time.size - 1 if complete else max(int(np.argmax(left)) - 1, 0)
    growth = _growth(time[: last + 1] - time[0], grown[: last + 1])
    half = 0.5 * (time[last] - time[0])
    return Horizon(
        until=float(time[last]),
        growth=growth,
        chaotic=bool(growth * half > np.log(CHAOTIC_GROWTH)),
        complete=complete,
        nudge=nudge,
        allowed=allowed,
        separation=grown,
    )


def _growth(since: Array, grown: Array) -> float:
    """Slope of log(distance) over the second half of the run [1/s]; zero where there is too little to fit."""
    second = (since >= 0.5 * since[-1]) & (grown > 0.0)
    if second.sum() < 3:
        return 0.0
    return float(np.polyfit(since[second], np.log(grown[second]), 1)[0])
