"""A signal at other times than it was sampled at: cubics between the samples, parabolas beyond them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from harness.kept_kernels import forgive
from harness.system.description import Array

forgive()

POINTS = 4  # of a cubic


def resample(signal: Array, time: Array, query: Array) -> Array:
    """Each lane's signal (B, T) at its own times (B, Q): cubic through four neighbours, parabola outside.

    Fewer than four samples are interpolated linearly.
    """
    if len(time) < POINTS:
        return np.stack([np.interp(q, time, s) for q, s in zip(query, signal, strict=True)])
    result = _between(signal, time, query)
    for outside, end in ((query < time[0], 0), (query > time[-1], -1)):
        if outside.any():
            _extrapolate(result, signal, time, query, outside, end)
    return result


def _between(signal: Array, time: Array, query: Array) -> Array:
    """The same for times (B, Q) that are known to lie between samples, of which there are at least four; beyond them, the outermost
    cubics go on."""
    stamps = np.ascontiguousarray(time, dtype=np.float64)
    asked = np.ascontiguousarray(query, dtype=np.float64)
    return np.asarray(_cubics(np.ascontiguousarray(signal, dtype=np.float64), stamps, asked))


@njit(cache=True, error_model="numpy", nogil=True)
def _cubics(signal: Any, time: Any, query: Any) -> Any:
    """Lagrange's cubic through the four samples around each time."""
    lanes, count = query.shape
    last = len(time)
    out = np.empty((lanes, count))
    for b in range(lanes):
        k = 0
        for c in range(count):
            t = query[b, c]
            # How many samples are not later: times go on from one to the next as a rule.
            while k < last and time[k] <= t:
                k += 1
            while k > 0 and time[k - 1] > t:
                k -= 1
            first = min(max(k - 2, 0), last - POINTS)
            total = 0.0
            for j in range(POINTS):
                weight = 1.0
                for m in range(POINTS):
                    if m != j:
                        weight *= (t - time[first + m]) / (time[first + j] - time[first + m])
                total += weight * signal[b, first + j]
            out[b, c] = total
    return out


def _extrapolate(result: Array, signal: Array, time: Array, query: Array, outside: Array, end: int) -> None:
    """Fill ``outside`` by parabolas through three samples about as far apart as the farthest query is out."""
    for lane in np.flatnonzero(outside.any(axis=1)):
        which = outside[lane].astype(bool)
        distance = float(np.abs(query[lane][which] - time[end]).max())
        inward = np.abs(time - time[end])
        order = np.argsort(inward, kind="stable")
        positions = np.unique(
            np.clip(np.searchsorted(inward[order], [0.0, distance, 2.0 * distance]), [0, 1, 2], len(time) - 1)
        )
        picked = order[positions]
        x, y = time[picked], signal[lane, picked]
        q = query[lane][which]
        total = np.zeros(q.shape)
        for j in range(len(x)):
            weight = np.ones(q.shape)
            for k in range(len(x)):
                if k != j:
                    weight *= (q - x[k]) / (x[j] - x[k])
            total += weight * y[j]
        result[lane, which] = total
