"""Which laws a joint's twist follows: least squares over every set of them, what is left taken for noise with a memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.inverse.constants import FROM_NOTHING_SIGMAS, HELD_OUT_SIGMAS, NOISE_LAGS
from harness.diagnose.inverse.effort_noise import EffortNoise, effort_noise
from harness.diagnose.inverse.heldout_gain import heldout_gain
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.transmission.constants import BLOCKS, NOISE_ROUNDS, ROUNDING
from harness.diagnose.transmission.laws import EVERY, LAWS, Laws
from harness.diagnose.transmission.twist import TwistRun

Array = NDArray[np.float64]
Surprise = Callable[[int, Array], float]  # of a law and its shares: −2 log of how plausible it is, its rarity included


@dataclass(frozen=True, eq=False)
class TwistFit:
    """A joint's twist explained.

    shares, spread: of its laws' shapes, and standard deviations, (k,). noise: memory of what is left. probability, delta, heldout,
    rivals: of each law: posterior of its effect over all sets, how much worse the set is without it, how much data held out gain
    by it, and laws that could stand in its place.
    """

    laws: Laws
    shares: Array
    spread: Array
    noise: EffortNoise
    probability: tuple[float, ...] = ()
    delta: tuple[float, ...] = ()
    heldout: tuple[float, ...] = ()
    rivals: tuple[tuple[int, ...], ...] = ()


def explained(train: Sequence[TwistRun], held: Sequence[TwistRun], surprise: Surprise) -> TwistFit:
    """The set of laws that training recordings speak for, less those that data held out, or blocks left out, do not bear out."""
    best = max(EVERY, key=len)
    for _ in range(NOISE_ROUNDS):
        noise = _noise(train, best)
        rows = _Rows(train, noise)
        cost = {laws: rows.cost(laws, surprise) for laws in EVERY}
        best = min(cost, key=lambda laws: cost[laws])
    judged, lowest = _Rows(held, noise), min(cost.values())
    weight = {laws: float(np.exp(-0.5 * (value - lowest))) for laws, value in cost.items()}
    gains: list[float] = []
    while best:
        shares, spread = rows.fit(best)[0], _spread(train, noise, best)
        sure = [float(np.min(np.abs(shares[s]) / spread[s])) / FROM_NOTHING_SIGMAS for s in best.spans]
        gains = [judged.gain(best.without(k), best, rows) for k in range(len(best))]
        worst = min(range(len(best)), key=lambda k: min(sure[k], gains[k] / HELD_OUT_SIGMAS))
        if sure[worst] > 1.0 and gains[worst] > HELD_OUT_SIGMAS:
            break
        best = best.plainer(worst)
    if not best:
        return TwistFit(best, np.zeros(0), np.zeros(0), noise)
    total = sum(weight.values())
    told, rivals = [], []
    for k, law in enumerate(best):
        told.append(
            sum(w for laws, w in weight.items() if LAWS[law].effect in {LAWS[other].effect for other in laws}) / total
        )
        others = [
            (other, best.without(k).with_(other))
            for other in range(len(LAWS))
            if LAWS[other].effect != LAWS[law].effect
        ]
        rivals.append(
            tuple(other for other, laws in others if laws is not None and cost[laws] < cost[best] + UNPARTED_EVIDENCE)
        )
    delta = tuple(cost[best.without(k)] - cost[best] for k in range(len(best)))
    return TwistFit(best, shares, spread, noise, tuple(told), delta, tuple(gains), tuple(rivals))


def refitted(runs: Sequence[TwistRun], fitted: TwistFit) -> tuple[Array, Array]:
    """Shares of the same laws by other recordings, and their standard deviations, (k,)."""
    return _Rows(runs, fitted.noise).fit(fitted.laws)[0], _spread(runs, fitted.noise, fitted.laws)


def left(run: TwistRun, fitted: TwistFit | None) -> Array:
    """The twist of a recording less what laws say of it and less its zero, (N,)."""
    out = run.twist
    if fitted is not None and fitted.laws:
        out = out - _shapes(run)[:, fitted.laws.columns] @ fitted.shares
    return np.asarray(out - out.mean())


def _shapes(run: TwistRun) -> Array:
    return np.column_stack([shape(run) for law in LAWS for shape in law.shapes])


def _noise(runs: Sequence[TwistRun], laws: Laws) -> EffortNoise:
    """The memory of what plain least squares leaves."""
    white = EffortNoise(np.zeros(NOISE_LAGS), 1.0, 1.0)
    shares = _Rows(runs, white).fit(laws)[0]
    return effort_noise([left(run, TwistFit(laws, shares, np.zeros(len(shares)), white)) for run in runs])


def _spread(runs: Sequence[TwistRun], noise: EffortNoise, laws: Laws) -> Array:
    """Standard deviations by the curvature, or by leaving blocks of the recordings out in turn, whichever is more; and by what
    loads that are off by the model's tolerances make of the shares.

    The delete-a-group jackknife knows of what is left over longer times than the noise's memory (Künsch 1989).
    """
    rows = _Rows(runs, noise)
    shares, by_curvature = rows.fit(laws)
    blocks = [(r, part) for r, run in enumerate(runs) for part in np.array_split(np.arange(len(run.time)), BLOCKS)]
    again = []
    for r, part in blocks:
        kept = [run for k, run in enumerate(runs) if k != r]
        sides = (runs[r].part(slice(0, int(part[0]))), runs[r].part(slice(int(part[-1]) + 1, None)))
        kept += [side for side in sides if len(side.time) > 2 * NOISE_LAGS]
        again.append(_Rows(kept, noise).fit(laws)[0] if kept else shares)
    count = len(again)
    by_blocks = np.sqrt((count - 1.0) / count * np.sum((np.array(again) - np.mean(again, axis=0)) ** 2, axis=0))
    by_loads = np.zeros(len(shares))
    for k in range(len(runs[0].errors)):
        off = [
            replace(run, load=run.load + run.errors[k, 0], load_rate=run.load_rate + run.errors[k, 1]) for run in runs
        ]
        by_loads += (_Rows(off, noise).fit(laws)[0] - shares) ** 2
    return np.sqrt(np.maximum(by_curvature, by_blocks) ** 2 + by_loads)


class _Rows:
    """Whitened rows of some recordings, a zero of each taken out."""

    def __init__(self, runs: Sequence[TwistRun], noise: EffortNoise) -> None:
        shapes, seen = [], []
        for run in runs:
            table = np.column_stack([run.twist, _shapes(run), np.ones(len(run.time))])
            white = table[NOISE_LAGS:].copy()
            for lag, share in enumerate(noise.ahead, 1):
                white -= share * table[NOISE_LAGS - lag : len(table) - lag]
            white /= noise.innovation
            zero = white[:, -1:]
            beside = white[:, :-1] - zero * (zero.T @ white[:, :-1]) / max(float(np.sum(zero**2)), 1e-300)
            # A load that never changes its direction is no more than a zero.
            beside[:, np.linalg.norm(beside, axis=0) < ROUNDING * np.linalg.norm(white[:, :-1], axis=0)] = 0.0
            seen.append(beside[:, 0])
            shapes.append(beside[:, 1:])
        self.seen, self.shapes = np.concatenate(seen), np.concatenate(shapes)
        self.count = max(len(self.seen) - len(runs), 1)

    def fit(self, laws: Laws) -> tuple[Array, Array]:
        """Shares of some laws and their standard deviations by the curvature, as loud as what is left, (k,)."""
        if not laws:
            return np.zeros(0), np.zeros(0)
        columns = self.shapes[:, laws.columns]
        length = np.linalg.norm(columns, axis=0)
        scale = np.where(length > 0.0, length, 1.0)
        inverse = np.linalg.pinv(columns / scale)
        shares = inverse @ self.seen
        loud = float(np.sum((self.seen - columns / scale @ shares) ** 2)) / max(self.count - len(shares), 1)
        return shares / scale, np.sqrt(loud * np.sum(inverse**2, axis=1)) / scale

    def left(self, laws: Laws, shares: Array) -> Array:
        return np.asarray(self.seen - self.shapes[:, laws.columns] @ shares)

    def cost(self, laws: Laws, surprise: Surprise) -> float:
        """−2 log of how likely the rows are, the size of their noise being unknown, and the price of the laws; infinite where
        physics forbids a share."""
        shares = self.fit(laws)[0]
        price = len(shares) * float(np.log(self.count))
        for law, span in zip(laws, laws.spans, strict=True):
            if LAWS[law].positive and np.any(shares[span] <= 0.0):
                return np.inf
            price += surprise(law, shares[span])
        squares = float(np.sum(self.left(laws, shares) ** 2))
        return float(self.count * np.log(max(squares, 1e-300) / self.count) + price)

    def gain(self, smaller: Laws, larger: Laws, training: _Rows) -> float:
        """How much these rows gain by further laws, as training rows have both, in standard deviations."""
        before, after = (self.left(laws, training.fit(laws)[0]) for laws in (smaller, larger))
        return heldout_gain(before, after)
