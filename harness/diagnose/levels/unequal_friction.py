"""Whether recordings ask for different levels of friction: a linear estimate and its chance, before anything is fitted.

At a fit with one law for all recordings, short stretches with initial states of their own say how much more or less friction of a
kind each recording asks for, beside everything that recordings share: the fit's own parameters, any friction or force that is a
fixed function of speed or of position, and friction that yields before it slides. The scatter between stretches of the same
recording is what the estimate is held against, so a law that is merely wrong, and wrong alike in every recording, says nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr
from scipy.stats import f as f_distribution

from harness.diagnose.criticism.constants import END_QUANTILES, FASTEST_QUANTILE
from harness.diagnose.criticism.probe import Probe, probe
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.linear_response import Response, to_channels
from harness.diagnose.estimation.linearisation import linearise
from harness.diagnose.levels.constants import (
    FURTHEST_LEVEL,
    LEVEL_DIFFERENCE,
    LEVEL_STRETCHES,
    RESOLVED_DIRECTION,
    SHARED_PLACES,
    SHARED_SPEEDS,
    TURNING_SPEED_SHARE,
    UNTOLD_LEVEL,
    YIELDING_WAYS,
)
from harness.diagnose.levels.kinds import DRY, Kind
from harness.diagnose.problem.constants import SHORT_WINDOW_SWINGS
from harness.diagnose.problem.windows import Window, cut
from harness.diagnose.selection.study import Study
from harness.effects.scale import references

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Unequal:
    """What every recording asks for, as a factor on a kind of friction of a fit, relative to the last training recording.

    levels, std: shape (R,), those held out included; 1 and 0 for the last training recording. chance: of such differences if
    friction were equal (Hotelling's T², the covariance a jackknife's over stretches; Efron and Stein, Ann. Statist. 9 (1981) 586).
    share: of what short stretches leave above the noise, that levels take away.
    """

    levels: Array
    std: Array
    chance: float
    share: float


def rubbing(study: Study, fitted: Fit, kind: Kind = DRY) -> tuple[str, ...]:
    """Joints that have a kind of friction in a fit."""
    model = study.predictor.mechanism(fitted.hypothesis).model
    row = study.predictor.row(fitted.hypothesis, fitted.x)
    return tuple(
        joint
        for joint in study.problem.system.joint_names
        if any(row[model.slot(joint, slot)] > 0.0 for slot in kind.acting)
    )


def unequal_friction(study: Study, fitted: Fit, kind: Kind = DRY) -> Unequal | None:
    """Levels of a kind of friction of all recordings to first order; None where there is nothing to compare.

    fitted: to all recordings, of free motion in which every channel is a joint's.
    """
    # Held against the scatter between stretches, and so in need of no other model of error.
    study = replace(study, likelihood=study.likelihood.of_sensors)
    problem = study.problem
    joints = rubbing(study, fitted, kind)
    count = len(problem.runs)
    if count < 2 or not joints:
        return None
    stretches = _stretched(study, fitted)
    grams, rights, size = _normal_equations(study, stretches, joints, kind)
    if len(grams) < 2 * count:
        return None
    prior = np.zeros(size)
    prior[: len(study.predictor.nominal)] = 1.0
    pull = np.zeros(size)
    pull[: len(study.predictor.nominal)] = fitted.x[: len(study.predictor.nominal)]
    whole, right = sum(grams) + np.diag(prior), sum(rights) + pull
    last = slice(size - (count - 1), size)
    every = _solved(whole, right)
    found = every[last]
    shared = _solved(whole[: last.start, : last.start], right[: last.start])
    gain = float(right[: last.start] @ shared - right @ every)
    excess = max(
        float(sum(r @ r for r in stretches.linear.residuals)) - study.likelihood.samples(stretches.windows), 1e-300
    )
    # Without one stretch after the other: what stretches of one recording disagree about is the scatter that counts.
    left_out = np.array([_solved(whole - g, right - r)[last] for g, r in zip(grams, rights, strict=True)])
    if not np.abs(left_out).max() < UNTOLD_LEVEL:
        return None  # one of the stretches alone tells a level: whether others would say the same is not known
    away = left_out - left_out.mean(axis=0)
    covariance = (len(grams) - 1.0) / len(grams) * away.T @ away
    square = float(found @ np.linalg.pinv(covariance) @ found)
    freedom = len(grams) - count
    rest = freedom - (count - 1) + 1
    chance = float(f_distribution.sf(square * rest / (freedom * (count - 1)), count - 1, rest)) if rest > 0 else 1.0
    base = len(problem.train) - 1
    levels = np.insert(np.exp(np.clip(found, -FURTHEST_LEVEL, FURTHEST_LEVEL)), base, 1.0)
    return Unequal(
        levels, np.insert(np.sqrt(np.diag(covariance)), base, 0.0), chance, min(max(gain, 0.0) / excess, 1.0)
    )


def _stretched(study: Study, fitted: Fit) -> Fit:
    """The same parameters over short stretches of all recordings, initial states fitted."""
    problem = study.problem
    windows: list[Window] = []
    for k, run in enumerate(problem.runs):
        own = [w for w in fitted.windows if w.run == k]
        shortest = SHORT_WINDOW_SWINGS * study.swing
        windows += (
            own
            if len(own) >= LEVEL_STRETCHES
            else cut(problem.runs, [k], max(shortest, run.duration / LEVEL_STRETCHES))
        )
    states = {w: study.read_off(fitted.hypothesis, w) for w in windows}
    held = np.ones(len(fitted.x), dtype=bool)
    objective = study.objective(fitted.hypothesis).on(windows)
    found = fit(objective, fitted.x, states, fixed=held)
    _, upper = objective.bounds()
    linear = linearise(objective, found.x, found.states, upper=upper, fixed=~fitted.free)
    return Fit(found.hypothesis, found.windows, found.x, found.states, linear, found.prior, True, fitted.free)


def _normal_equations(
    study: Study, fitted: Fit, joints: tuple[str, ...], kind: Kind
) -> tuple[list[Array], list[Array], int]:
    """Per stretch AᵀA and Aᵀr of [parameters, shared shapes, common level, levels of all but the last one trained on]."""
    predictor, likelihood, problem = study.predictor, study.likelihood, study.problem
    probes = {j: probe(predictor, likelihood, fitted, references(problem.system, j).torque) for j in joints}
    shapes = [_shared_shapes(own, joint) for joint, own in probes.items()]
    motions = next(iter(probes.values())).motions
    others = [k for k in range(len(problem.runs)) if k != len(problem.train) - 1]
    grams, rights = [], []
    for k, window in enumerate(fitted.windows):
        level = _level_change(study, fitted, motions[window], joints, kind)
        own = level[:, None] * (np.array(others) == window.run)
        columns = np.hstack(
            [
                fitted.linear.shared[k],
                *(s[k].T for s in shapes),
                level[:, None],
                own,
                fitted.linear.residuals[k][:, None],
            ]
        )
        q, _ = qr(fitted.linear.bases[k], mode="economic", check_finite=False)
        columns = columns - q @ (q.T @ columns)
        gram = columns.T @ columns
        grams.append(gram[:-1, :-1])
        rights.append(gram[:-1, -1])
    return grams, rights, len(grams[0])


def _shared_shapes(own: Probe, joint: str) -> list[Array]:
    """Changes per stretch (K, M) by friction over speed and over place and by smooth forces, the same in every recording."""
    k = own.names.index(joint)
    q = np.concatenate([m.q[:, k] for m in own.motions.values()])
    fast = max(
        float(np.quantile(np.abs(np.concatenate([m.qd[:, k] for m in own.motions.values()])), FASTEST_QUANTILE)), 1e-9
    )
    low, high = (float(x) for x in np.quantile(q, END_QUANTILES))
    return own.changes(
        joint, partial(_forces, middle=0.5 * (low + high), reach=max(0.5 * (high - low), 1e-9), fast=fast)
    )


def _forces(q: Array, qd: Array, middle: float, reach: float, fast: float) -> Array:
    speed, place = np.abs(qd) / fast, (q - middle) / reach
    sense = np.tanh(qd / (TURNING_SPEED_SHARE * fast))
    friction = [*_hats(speed, SHARED_SPEEDS), *_hats(np.abs(place), SHARED_PLACES)[1:]]
    yielding = [_yielding(q, qd, way * reach) for way in YIELDING_WAYS]
    return np.array([*(h * sense for h in friction), place * sense, *yielding, *(place**a for a in range(4)), speed**2])


def _yielding(q: Array, qd: Array, way: float) -> Array:
    """Dahl's friction of unit torque that builds up over ``way``, sliding fully at the start; shape (G,)."""
    sense = np.where(qd < 0.0, -1.0, 1.0)
    out, level = np.empty(len(q)), sense[0]
    edges = np.flatnonzero(np.diff(sense)) + 1
    for first, last in pairwise([0, *edges, len(q)]):
        out[first:last] = sense[first] + (level - sense[first]) * np.exp(-np.abs(q[first:last] - q[first]) / way)
        level = out[last - 1]
    return out


def _hats(x: Array, knots: tuple[float, ...]) -> list[Array]:
    """Functions that are one at a knot and fall linearly to zero at its neighbours; constant beyond the ends."""
    return [np.interp(x, knots, np.eye(len(knots))[k]) for k in range(len(knots))]


def _level_change(study: Study, fitted: Fit, motion: Response, joints: tuple[str, ...], kind: Kind) -> Array:
    """Whitened change of the channels (M,) by the logarithm of the level of all friction of a kind in one stretch."""
    predictor = study.predictor
    mechanism = predictor.mechanism(fitted.hypothesis)
    model, n = mechanism.model, len(mechanism.names)
    rows = np.tile(predictor.row_in(fitted.hypothesis, fitted.x, motion.window.run), (2, 1))
    for joint in joints:
        for slot in kind.slots:
            rows[1, model.slot(joint, slot)] *= 1.0 + LEVEL_DIFFERENCE
    state = np.tile(fitted.states[motion.window], (2, 1))
    q, qd, _ = model.simulate(
        rows, state[:, :n].copy(), state[:, n:].copy(), motion.time, tolerance=predictor.tolerance
    )
    change = np.concatenate([q[1] - q[0], qd[1] - qd[0]], axis=1)[:, :, None] / LEVEL_DIFFERENCE
    return to_channels(predictor, study.likelihood, fitted, motion, change)[0]


def _solved(matrix: Array, right: Array) -> Array:
    """The step that normal equations ask for, directions that nothing is known of left alone."""
    size = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    values, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    strong = values > RESOLVED_DIRECTION * values[-1]
    along = vectors[:, strong].T @ (right / size)
    return np.asarray(-(vectors[:, strong] @ (along / values[strong])) / size)
