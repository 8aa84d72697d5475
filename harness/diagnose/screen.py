"""Linearised score tests: how much of what a fitted hypothesis leaves would each further effect take away?

The change that an effect makes to the prediction is projected off everything that the hypothesis may adjust anyway
(initial states, nominal quantities, the parameters of the effects it already has); what remains is held against the
residual. Nothing is fitted, so the whole catalogue costs little more than one run for each starting point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from harness.diagnose.fit import Fit
from harness.diagnose.hypothesis import Candidate, Hypothesis
from harness.diagnose.likelihood import Likelihood
from harness.diagnose.predict import Predictor, to_internal
from harness.diagnose.problem import Problem
from harness.diagnose.response import Response, respond, responsive, to_channels
from harness.diagnose.starts import Ray, rays
from harness.diagnose.windows import Window

Array = NDArray[np.float64]

MOST_LANES = 512  # run at once, to bound memory
WEAK = 1e-4  # norm of a projected direction [noise standard deviations] below which nothing can be seen of it


@dataclass(frozen=True, eq=False)
class Score:
    """A candidate's best starting point against a fit.

    gain: reduction of the cost that the linear model promises; start: SI values scaled accordingly; share: of the cost that
    lies outside the adjustable directions; visible: norm of the projected direction [noise standard deviations].
    """

    candidate: Candidate
    gain: float
    start: Array
    visible: float


@dataclass(frozen=True, eq=False)
class Nuisance:
    """Orthonormal bases of what a fit may adjust: per window the initial state, over all windows the shared parameters."""

    states: tuple[Array, ...]
    shared: Array
    residual: Array
    prior: Array

    def project(self, columns: Sequence[Array]) -> Array:
        """Whitened changes per window (each (k, M_w)) as one matrix (M + P, k) without their adjustable part."""
        parts = [c.T - q @ (q.T @ c.T) for c, q in zip(columns, self.states, strict=True)]
        stacked = np.vstack([*parts, np.zeros((len(self.prior), columns[0].shape[0]))])
        return stacked - self.shared @ (self.shared.T @ stacked)


def nuisance(fitted: Fit, predictor: Predictor) -> Nuisance:
    """Bases of what a fit may adjust, at the fit."""
    states = []
    for basis in fitted.linear.bases:
        q, r = qr(basis, mode="economic", check_finite=False)
        diagonal = np.abs(np.diag(r))
        states.append(q[:, diagonal > 1e-9 * max(float(diagonal.max(initial=0.0)), 1e-300)])
    parts = [j - q @ (q.T @ j) for j, q in zip(fitted.linear.shared, states, strict=True)]
    residuals = [r - q @ (q.T @ r) for r, q in zip(fitted.linear.residuals, states, strict=True)]
    k = len(predictor.nominal)
    size = len(fitted.x)
    prior_rows = np.eye(size)[:k] if k else np.zeros((0, size))
    stacked = np.vstack([*parts, prior_rows])[:, fitted.free]
    u, s, _ = np.linalg.svd(stacked, full_matrices=False) if stacked.shape[1] else (stacked, np.zeros(0), None)
    basis = u[:, s > 1e-9 * max(float(s.max(initial=0.0)), 1e-300)] if len(s) else np.zeros((stacked.shape[0], 0))
    right = np.concatenate([*residuals, fitted.x[:k]])
    return Nuisance(tuple(states), basis, right - basis @ (basis.T @ right), fitted.x[:k])


def score(
    fitted: Fit,
    predictor: Predictor,
    likelihood: Likelihood,
    candidates: Sequence[Candidate],
    problem: Problem,
    space: Nuisance,
) -> list[Score]:
    """Every candidate against a fit, best first; candidates that change nothing visible are left out."""
    found = []
    motions: dict[Window, Response] = {}
    for candidate in candidates:
        best = _best_ray(fitted, predictor, likelihood, candidate, rays(candidate, problem), space, motions)
        if best is not None:
            found.append(best)
    return sorted(found, key=lambda s: -s.gain)


def change(
    fitted: Fit, predictor: Predictor, likelihood: Likelihood, candidate: Candidate, points: Sequence[Array]
) -> list[Array]:
    """Whitened changes of the prediction when a candidate is switched on at SI ``points``: per window (k, M)."""
    wider = fitted.hypothesis.with_(candidate)
    x = np.array([np.concatenate([fitted.x, to_internal(candidate, point)]) for point in points])
    out = []
    for window in fitted.windows:
        state = carry_state(predictor, fitted.hypothesis, wider, fitted.states[window])
        chunks = []
        for first in range(0, len(points), MOST_LANES):
            part = x[first : first + MOST_LANES]
            predictions = predictor.predict(wider, part, [(row, window, state) for row in range(len(part))])
            chunks.append(likelihood.whiten(window, predictions))
        out.append(np.vstack(chunks) - fitted.linear.residuals[fitted.windows.index(window)])
    return out


def wave(candidate: Candidate) -> bool:
    """Whether the candidate is a force that goes as a sine, so that scanning it needs the linear response only."""
    return candidate.effect.name in ("cogging_torque", "base_excitation")


def wave_change(
    fitted: Fit,
    predictor: Predictor,
    likelihood: Likelihood,
    candidate: Candidate,
    points: Sequence[Array],
    motions: dict[Window, Response],
) -> list[Array]:
    """The same as ``change`` for waves of force over angle or time, to first order; ``motions`` keeps the linear responses."""
    parameters = np.array(points)
    names = predictor.mechanism(fitted.hypothesis).names
    out = []
    for window in fitted.windows:
        if window not in motions:
            motions[window] = respond(predictor, fitted, window, candidate.references.torque)
        found = motions[window]
        run = predictor.runs[window.run]
        if candidate.effect.name == "base_excitation":
            time = found.time + float(run.time[window.first] - run.time[0])
            phase = 2.0 * np.pi * parameters[:, 1:2] * time + parameters[:, 2:3]
            deviations = found.by_shaking(parameters[:, :1] * np.sin(phase))
        else:
            joint = names.index(candidate.site)
            phase = parameters[:, 1:2] * found.q[:, joint] + parameters[:, 2:3]
            deviations = found.by_force(joint, parameters[:, :1] * np.sin(phase))
        out.append(to_channels(predictor, likelihood, fitted, found, deviations))
    return out


def carry_state(predictor: Predictor, before: Hypothesis, after: Hypothesis, state: Array) -> Array:
    """A state vector of one hypothesis in the coordinates of another, by name; new coordinates begin at rest at zero."""
    old, new = predictor.mechanism(before).names, predictor.mechanism(after).names
    if old == new:
        return state
    out = np.zeros(2 * len(new))
    for k, name in enumerate(new):
        if name in old:
            j = old.index(name)
            out[k], out[len(new) + k] = state[j], state[len(old) + j]
    return out


def _best_ray(
    fitted: Fit,
    predictor: Predictor,
    likelihood: Likelihood,
    candidate: Candidate,
    lines: Sequence[Ray],
    space: Nuisance,
    motions: dict[Window, Response],
) -> Score | None:
    points = [point for line in lines for point in line]
    if wave(candidate) and responsive(predictor, fitted):
        changes = wave_change(fitted, predictor, likelihood, candidate, points, motions)
    else:
        changes = change(fitted, predictor, likelihood, candidate, points)
    finite = np.ones(len(points), dtype=bool)
    for part in changes:
        finite &= np.all(np.isfinite(part), axis=1)
    changes = [np.nan_to_num(part) for part in changes]
    directions = space.project(changes)
    residual = space.residual
    best: Score | None = None
    place = 0
    for line in lines:
        columns = directions[:, place : place + len(line)]
        usable = bool(np.all(finite[place : place + len(line)]))
        first = place
        place += len(line)
        norms = np.linalg.norm(columns, axis=0)
        if not usable or norms.max() < WEAK:
            continue
        amplitude = candidate.effect.parameters[0]
        linear = amplitude.neutral == 0.0
        if len(line) == 2:
            a, *_ = np.linalg.lstsq(columns, -residual, rcond=None)
            gain = float(residual @ residual - np.sum((residual + columns @ a) ** 2))
            start = points[first].copy()
            quarter = [p.name for p in candidate.effect.parameters].index("phase")
            start[0] = start[0] * float(np.hypot(a[0], a[1]))
            start[quarter] = float(np.arctan2(a[1], a[0]))
            visible = float(norms.max())
        else:
            column = columns[:, 0]
            size = float(column @ column)
            a0 = -float(column @ residual) / size
            if amplitude.neutral == 0.0 and amplitude.lower >= 0.0 and a0 <= 0.0:
                continue
            if not linear and a0 <= 0.0 and not _may_reverse(candidate):
                continue
            gain = a0 * a0 * size
            start = points[first].copy()
            if linear:
                # Scale what acts in proportion; but not beyond what the linear view can vouch for.
                factor = float(np.clip(a0, -30.0, 30.0))
                for k, parameter in enumerate(candidate.effect.parameters):
                    if k == 0 or parameter.unit == amplitude.unit:
                        start[k] *= factor
            elif np.isfinite(amplitude.neutral):
                start[0] = amplitude.neutral + (start[0] - amplitude.neutral) * float(np.clip(a0, -30.0, 30.0))
            start = np.clip(start, candidate.effect.lower, candidate.effect.upper)
            visible = float(np.sqrt(size))
        if best is None or gain > best.gain:
            best = Score(candidate, gain, start, visible)
    return best


def _may_reverse(candidate: Candidate) -> bool:
    """Whether the first parameter may lie on either side of its neutral value."""
    p = candidate.effect.parameters[0]
    return bool(np.isfinite(p.neutral) and p.lower < p.neutral)
