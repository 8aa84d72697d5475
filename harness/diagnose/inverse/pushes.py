"""Stretches of driven recordings in which something outside pushes: a person, a cable, an obstacle.

A demonstration of a controller is often one of its robustness: somebody pushes the arm while the recording runs. The
recorded effort knows nothing of that, and any effect fitted to it is an invention.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label

from harness.denoc.model import Denoc
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.system import System

Array = NDArray[np.float64]

ROUNDS = 20  # of reweighting
TUKEY = 4.685  # of a robust standard deviation: 95 % efficiency under Gaussian noise (Beaton and Tukey 1974)
BEGINS = 6.0  # robust standard deviations at which a push is noticed
ENDS = 2.5  # to which it reaches on either side
SHARE = 0.15  # of the efforts' 95th percentile, below which a push is not claimed
SHORTEST = 0.5  # of the shortest period that is looked at; shorter ones are outliers of the smoothing
MOST = 0.4  # of the recordings that may be pushed; beyond, it is the model that is wrong


@dataclass(frozen=True)
class Push:
    """Something outside acting: recording, joint, time [s] from and to, and the largest force seen after smoothing."""

    run: int
    joint: int
    first: float
    last: float
    peak: float


def ordinary_terms(system: System, run: EffortRun, joint: int) -> Array:
    """Torques that any model of the mechanism could have at a joint, up to a factor each, smoothed, shape (T, 7).

    Inertia, gravity and velocity-product torque of the nominal model, then viscous, dry, quadratic and constant torque.
    """
    model = Denoc(system)
    still, motion = np.zeros_like(run.q), run.qd
    gravity = model.inverse_dynamics_batch(run.q, still, still)
    moving = model.inverse_dynamics_batch(run.q, motion, still) - gravity
    inertia = model.inverse_dynamics_batch(run.q, still, run.qdd) - gravity
    v = motion[:, joint]
    terms = [
        inertia[:, joint],
        gravity[:, joint],
        moving[:, joint],
        v,
        np.tanh(v / run.still[joint]),
        v * np.abs(v),
        np.ones(len(v)),
    ]
    return run.smooth(np.stack(terms, axis=1))


def find_pushes(system: System, runs: Sequence[EffortRun]) -> tuple[Push, ...]:
    """Pushes in all recordings together, seen as what no combination of ordinary torques explains.

    The combination is fitted robustly (Tukey's biweight), so that pushes do not pull it. None are claimed where they would
    fill more than two fifths of the recordings.
    """
    found: list[Push] = []
    total = sum(run.time[-1] - run.time[0] for run in runs)
    for j in range(runs[0].q.shape[1]):
        if not any(run.driven[j] for run in runs):
            continue
        designs = [ordinary_terms(system, run, j) for run in runs]
        use = np.concatenate([run.usable for run in runs])
        design, target = np.concatenate(designs), np.concatenate([run.effort[:, j] for run in runs])
        left = robust_residual(design, target, use)
        spread = 1.4826 * float(np.median(np.abs(left[use])))
        least = max(BEGINS * spread, SHARE * float(np.percentile(np.abs(target[use]), 95)))
        at = 0
        for k, run in enumerate(runs):
            rest = np.where(run.inner, left[at : at + len(run.time)], 0.0)
            at += len(run.time)
            for first, last in _stretches(rest, run, least, ENDS * spread):
                peak = float(rest[first : last + 1][np.argmax(np.abs(rest[first : last + 1]))])
                found.append(Push(k, j, float(run.time[first]), float(run.time[last]), peak))
    if sum(p.last - p.first for p in found) > MOST * total:
        return ()
    return tuple(found)


def robust_residual(design: Array, target: Array, use: NDArray[np.bool_]) -> Array:
    """What a robust regression (Tukey's biweight, iteratively reweighted) leaves of every sample, shape (T,)."""
    size = np.sqrt(np.mean(design[use] ** 2, axis=0))
    columns = design[:, size > 0.0] / size[size > 0.0]
    weight = use.astype(np.float64)
    left = target
    for _ in range(ROUNDS):
        root = np.sqrt(weight)[:, None]
        found, *_ = np.linalg.lstsq(columns * root, target * root[:, 0], rcond=1e-8)
        left = target - columns @ found
        spread = 1.4826 * float(np.median(np.abs(left[use])))
        if spread <= 0.0:
            break
        weight = use * np.maximum(1.0 - (left / (TUKEY * spread)) ** 2, 0.0) ** 2
    return np.asarray(left)


def _stretches(rest: Array, run: EffortRun, begins: float, ends: float) -> list[tuple[int, int]]:
    """First and last samples of the stretches that reach ``begins`` and stay beyond ``ends``; neighbours are joined.

    The low-pass lets a push ring on either side of it, with the other sign.
    """
    out: list[tuple[int, int]] = []
    step = float(run.time[1] - run.time[0])
    for sign in (1.0, -1.0):
        beyond, count = label(sign * rest > ends)
        for k in range(1, count + 1):
            index = np.flatnonzero(beyond == k)
            long = (index[-1] - index[0]) * step >= SHORTEST / run.bandwidth
            if long and float(np.max(sign * rest[index])) > begins:
                out.append((int(index[0]), int(index[-1])))
    joined: list[tuple[int, int]] = []
    for first, last in sorted(out):
        if joined and (first - joined[-1][1]) * step < 1.0 / run.bandwidth:
            joined[-1] = (joined[-1][0], max(last, joined[-1][1]))
        else:
            joined.append((first, last))
    return joined


def mask_pushes(run: EffortRun, index: int, pushes: Sequence[Push]) -> EffortRun:
    """The run with pushed samples, and what the smoothing carries of them, not usable."""
    pushed = np.zeros(len(run.time), dtype=bool)
    for push in pushes:
        if push.run == index:
            pushed |= (run.time >= push.first) & (run.time <= push.last)
    if not pushed.any():
        return run
    reach = round(1.0 / (run.bandwidth * float(run.time[1] - run.time[0])))
    return run.without(binary_dilation(pushed, iterations=max(reach, 1)))
