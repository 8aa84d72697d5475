"""Stretches of driven recordings in which something outside pushes: a person, a cable, an obstacle.

A demonstration of a controller is often one of its robustness: somebody pushes the arm while the recording runs. The
recorded effort knows nothing of that, and any effect fitted to it is an invention.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, label

from harness.diagnose.conditioning.constants import MOST_LEFT_OUT_SHARE, ROBUST_SIGMA
from harness.diagnose.inverse.constants import (
    DRIVE_LIMITS,
    LIMITED_SHARE,
    PUSH_END_SIGMAS,
    PUSH_SHARE,
    PUSH_SIGMAS,
    SHORTEST_PUSH_PERIODS,
    STILL_PUSHED_SHARE,
)
from harness.diagnose.inverse.effort_fit import EffortFit
from harness.diagnose.inverse.effort_model import EffortModel
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.inverse.ordinary_torque import OrdinaryTorque, link_terms, ordinary_torque
from harness.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Push:
    """Something outside acting: recording, joint, time [s] from and to, and the largest force seen after smoothing."""

    run: int
    joint: int
    first: float
    last: float
    peak: float


def find_pushes(system: System, runs: Sequence[EffortRun]) -> tuple[Push, ...]:
    """Pushes in all recordings together, seen as what no combination of ordinary torques explains.

    The combination is fitted robustly, so that pushes do not pull it, and what dry friction may do at a turn is no push. None are
    claimed where they would fill more than two fifths of the recordings.
    """
    found: list[Push] = []
    total = sum(run.time[-1] - run.time[0] for run in runs)
    links = link_terms(system, runs)
    for j in range(runs[0].q.shape[1]):
        if not any(run.driven[j] for run in runs):
            continue
        use = np.concatenate([run.usable for run in runs])
        target = np.concatenate([run.effort[:, j] for run in runs])
        shown = PUSH_SHARE * float(np.percentile(np.abs(target[use]), 95))
        plain = ordinary_torque(system, runs, j, links)
        pushes = _beyond_ordinary(runs, j, plain, shown, np.inf)
        found += _beside_a_limit(system, runs, j, links, shown, plain, pushes) if pushes else ()
    if _lasting(found) > MOST_LEFT_OUT_SHARE * total:
        return ()
    return tuple(found)


def still_pushing(
    system: System, runs: Sequence[EffortRun], pushes: tuple[Push, ...], found: EffortFit
) -> tuple[Push, ...]:
    """Of what ordinary torques do not explain, what a set of effects does not either: half of the force at least is left."""
    if not pushes:
        return pushes
    residuals = EffortModel(system, runs).residuals(found.hypothesis, found.x)

    def left(push: Push) -> float:
        run = runs[push.run]
        during = (run.time >= push.first) & (run.time <= push.last)
        return float(np.abs(residuals[push.run][during, push.joint]).max())

    return tuple(push for push in pushes if left(push) > STILL_PUSHED_SHARE * abs(push.peak))


def _beyond_ordinary(
    runs: Sequence[EffortRun], joint: int, ordinary: OrdinaryTorque, shown: float, quietest: float
) -> tuple[Push, ...]:
    """What ordinary torques of a joint leave that counts as pushes.

    shown: the least force that is told; quietest: the standard deviation that the noise has at most [N·m or N].
    """
    found = []
    spread = min(_spread(runs, ordinary), quietest)
    least = max(PUSH_SIGMAS * spread, shown)
    for k, (run, surely) in enumerate(zip(runs, ordinary.surely(runs, joint), strict=True)):
        rest = np.where(run.inner, surely, 0.0)
        for first, last in _stretches(rest, run, least, PUSH_END_SIGMAS * spread):
            peak = float(rest[first : last + 1][np.argmax(np.abs(rest[first : last + 1]))])
            found.append(Push(k, joint, float(run.time[first]), float(run.time[last]), peak))
    return tuple(found)


def _spread(runs: Sequence[EffortRun], ordinary: OrdinaryTorque) -> float:
    """Robust standard deviation of what ordinary torques leave where it can be compared [N·m or N]."""
    use = np.concatenate([run.usable for run in runs])
    return ROBUST_SIGMA * float(np.median(np.abs(np.concatenate(ordinary.left)[use])))


def _beside_a_limit(
    system: System,
    runs: Sequence[EffortRun],
    joint: int,
    links: Sequence[Array],
    shown: float,
    plain: OrdinaryTorque,
    pushes: tuple[Push, ...],
) -> tuple[Push, ...]:
    """The pushes that are left where the drive gives no more than some torque, if most of them go with that; else all.

    A drive that is asked for more than it can give looks, wherever it is, as if something pushed against it. plain, pushes: what
    ordinary torques leave of efforts without a limit.
    """
    most, quietest = max(float(np.abs(run.raw[:, joint]).max()) for run in runs), _spread(runs, plain)
    best = pushes
    for share in DRIVE_LIMITS:
        limited = []
        for run in runs:
            raw = run.raw.copy()
            raw[:, joint] = np.clip(raw[:, joint], -share * most, share * most)
            limited.append(replace(run, raw=raw, effort=run.smooth(raw)))
        ordinary = ordinary_torque(system, limited, joint, links)
        left = _beyond_ordinary(limited, joint, ordinary, shown, quietest)
        best = min(best, left, key=_lasting)
    return best if _lasting(best) < LIMITED_SHARE * _lasting(pushes) else pushes


def _lasting(pushes: Sequence[Push]) -> float:
    """How long pushes last together [s]."""
    return sum(p.last - p.first for p in pushes)


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
            long = (index[-1] - index[0]) * step >= SHORTEST_PUSH_PERIODS / run.bandwidth
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
