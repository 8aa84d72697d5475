"""Time stamps that are late in a pattern: sample n by a time that depends on n modulo a small number, and drifts slowly.

A bus that is asked in turn, a filter that delivers every few samples, a logger that stores in bursts: readings are not those of
their stamps, and err by speed times lateness, in lines at fractions of the sampling rate with the motion's own frequency beside
them. Unlike lateness at random this can be undone: how late each sample is shows in all of its kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from harness.recording.differences import third_weights, weighted
from harness.recording.recording import QualityNote
from harness.system.description import Array

PERIODS = range(2, 13)  # samples after which a pattern repeats
KNOTS = (1, 3, 8)  # times over a recording at which a pattern may be another one, linear between them
MOST_KNOTS = 24
ENOUGH = 8_000  # samples that a pattern is looked for in
SECONDS = 3.0  # between two of them at least
FEWEST = 40  # moving samples for every number
LOUDEST = 3.2  # times their mean, that third differences of white noise have in a line of the spectrum (64 of 20)
PLAIN = 12.0  # times the gain by chance of every number, that a pattern must bring
WORTH = 0.5  # of what third differences hold, that it must explain
PASSES = 3  # of estimating what is left after healing
MOST = 0.45  # of the interval, beyond which samples would change places


@dataclass(frozen=True, eq=False)
class StampPattern:
    """When samples were read after their stamps [s], (T,), none on average; it repeats after ``period`` samples.

    knots: times [s] between which it is linear.
    """

    period: int
    late: Array
    knots: Array

    @property
    def size(self) -> float:
        """Its standard deviation [s]."""
        return float(np.std(self.late))


def stamp_pattern(time: Array, signals: Sequence[tuple[Array, float]]) -> StampPattern | None:
    """The pattern that the stamps (T,) of positions show, or None.

    signals: values (T,), nan where missing, and quantisation step of every position that was read with these stamps.
    """
    # What is late in a pattern is so from the beginning.
    found = _likeliest(time[:ENOUGH], [(values[:ENOUGH], step) for values, step in signals])
    if found is None:
        return None
    late = found.late
    if len(time) > ENOUGH:
        share = (time[-1] - time[0]) / (found.knots[-1] - found.knots[0]) if len(found.knots) > 1 else 1.0
        count = round((len(found.knots) - 1) * share) + 1
        found = replace(found, knots=np.linspace(time[0], time[-1], min(count, MOST_KNOTS)))
        whole = _fitted(time, signals, found.period, found.knots)
        if whole is None:
            return None
        late = whole[0]
    for _ in range(PASSES - 1):
        # Linear in the lateness only as far as speed is constant over it.
        rest = _fitted(time + late, signals, found.period, found.knots)
        if rest is None:
            break
        late = late + rest[0]
    usual = float(np.median(np.diff(time)))
    if np.abs(late).max() > MOST * usual or np.any(np.diff(time + late) <= 0.0):
        return None
    return replace(found, late=late)


def healed(time: Array, signals: Sequence[tuple[Array, float]]) -> tuple[Array, QualityNote | None]:
    """Stamps (T,) at which samples were read, and what was found; the same stamps and None where they show no pattern."""
    found = stamp_pattern(time, signals)
    if found is None:
        return time, None
    note = QualityNote(
        "stamp_pattern",
        "time",
        f"samples are late in a pattern that repeats after {found.period} of them, by ± {1e3 * found.size:.2g} ms",
        "every stamp put where its sample was read",
        len(time),
        size=found.size,
    )
    late = found.late - found.late[0]
    return time + late, note


def _likeliest(time: Array, signals: Sequence[tuple[Array, float]]) -> StampPattern | None:
    """The pattern with the best Bayesian criterion over periods and drifts, if it is plain."""
    best: tuple[float, StampPattern] | None = None
    duration = float(time[-1] - time[0])
    for period in PERIODS:
        for count in KNOTS:
            if count > 1 and duration < SECONDS * (count - 1):
                continue
            knots = np.linspace(time[0], time[-1], count)
            fitted = _fitted(time, signals, period, knots)
            if fitted is None:
                continue
            late, before, after, seen = fitted
            numbers = (period - 1) * count
            gain = seen * float(np.log(before / after))
            plain = (before - after) / (LOUDEST * numbers) > PLAIN * after / seen
            if not plain or after > (1.0 - WORTH) * before:
                continue
            worth = gain - LOUDEST * numbers * float(np.log(seen))
            if best is None or worth > best[0]:
                best = worth, StampPattern(period, late, knots)
    return best[1] if best is not None and best[0] > 0.0 else None


def _kinds(time: Array, period: int) -> NDArray[np.intp]:
    """Which sample of a pattern each one is, missing ones counted."""
    usual = float(np.median(np.diff(time)))
    return np.asarray(np.round((time - time[0]) / usual).astype(int) % period)


def _fitted(
    time: Array, signals: Sequence[tuple[Array, float]], period: int, knots: Array
) -> tuple[Array, float, float, int] | None:
    """Least squares of a pattern's lateness (T,): that, squares of third differences before and after, and how many there are.

    A third difference knows four samples of a pattern, and the two knots beside each: its normal equations are summed up over those
    that know the same, in blocks of that.
    """
    kinds, own = _kinds(time, period), len(knots)
    which, lower, upper = _beside(time, knots)
    known = np.stack([kinds * own + which, kinds * own + np.minimum(which + 1, own - 1)])
    weights = third_weights(time)
    usual = float(np.median(np.diff(time)))
    alike, groups = _alike(known)
    length = len(time) - 3
    speeds = np.full((len(signals), len(time)), np.nan)
    thirds = np.zeros((len(signals), length))
    use = np.zeros((len(signals), length), dtype=bool)
    # Over whole periods samples are equally late at both ends.
    apart = time[2 * period :] - time[: -2 * period]
    for speed, third, good, (values, step) in zip(speeds, thirds, use, signals, strict=True):
        speed[period:-period] = (values[2 * period :] - values[: -2 * period]) / apart
        third[:] = weighted(weights, values)
        moving = np.abs(speed) * usual > 1.5 * step
        seen = np.isfinite(speed)
        good[:] = np.isfinite(third) & moving[:-3] & moving[3:] & seen[:-3] & seen[1:-2] & seen[2:-1] & seen[3:]
        scale = float(np.sqrt(np.mean(third[good] ** 2))) if good.any() else 0.0
        good &= scale > 0.0
        third /= scale or 1.0
        speed /= scale or 1.0
    count = int(use.sum())
    if count == 0 or count < FEWEST * (period - 1) * own:
        return None
    # What a pattern at the knots beside each of the four samples would add, (8, signals, T − 3), those alike together.
    added = np.empty((4, 2, *use.shape))
    for j in range(4):
        share = np.where(use, weights[j] * speeds[:, j : length + j], 0.0)
        added[j, 0], added[j, 1] = share * lower[j : length + j], share * upper[j : length + j]
    order = np.argsort(alike, kind="stable")
    added, right = added.reshape(8, *use.shape)[..., order], np.where(use, thirds, 0.0)[:, order]
    edges = np.searchsorted(alike[order], np.arange(len(groups) + 1))
    blocks = [
        (group, added[..., first:last].reshape(8, -1), right[:, first:last].ravel())
        for group, (first, last) in zip(groups, pairwise(edges.tolist()), strict=True)
        if last > first
    ]
    normal, turned = np.zeros((period * own, period * own)), np.zeros(period * own)
    for group, rows, values in blocks:
        np.add.at(normal, (group[:, None], group), rows @ rows.T)
        np.add.at(turned, group, rows @ values)
    before = float(np.sum(right**2))
    # Only what differs between the samples of a pattern shows: the last kind is late by what makes the mean nothing.
    contrast = np.concatenate([np.eye((period - 1) * own), np.tile(-np.eye(own), (1, period - 1))])
    solved = contrast @ np.linalg.lstsq(contrast.T @ normal @ contrast, contrast.T @ turned, rcond=1e-12)[0]
    after = sum(float(np.sum((values - solved[group] @ rows) ** 2)) for group, rows, values in blocks)
    late = lower * solved[known[0]] + upper * solved[known[1]]
    return late, before, max(after, 1e-300), count


def _beside(time: Array, knots: Array) -> tuple[NDArray[np.intp], Array, Array]:
    """The knot before each sample, and the shares (T,) that it and the next one have in what is linear between them."""
    if len(knots) == 1:
        return np.zeros(len(time), dtype=np.intp), np.ones(len(time)), np.zeros(len(time))
    along = (time - knots[0]) / (knots[1] - knots[0])
    which = np.clip(np.floor(along).astype(np.intp), 0, len(knots) - 2)
    return which, np.maximum(1.0 - (along - which), 0.0), np.maximum(along - which, 0.0)


def _alike(known: NDArray[np.intp]) -> tuple[NDArray[np.int16], NDArray[np.intp]]:
    """Which third differences know the same, (T − 3,), and what each kind of them knows, (kinds, 8).

    known: the two numbers that each sample knows, (2, T). Where nothing is missing, the first of four says what the others know.
    """
    count = known.shape[1] - 3
    eight = np.stack([known[i, j : count + j] for j in range(4) for i in range(2)])
    code = known[0, :count].astype(np.int16)
    usual = np.zeros((int(known.max()) + 1, 8), dtype=np.intp)
    usual[code[::-1]] = eight[:, ::-1].T
    rare = np.flatnonzero(np.any(usual[code] != eight.T, axis=1))
    further, index = np.unique(eight[:, rare].T, axis=0, return_inverse=True)
    code[rare] = len(usual) + index.ravel()
    return code, np.concatenate([usual, further])
