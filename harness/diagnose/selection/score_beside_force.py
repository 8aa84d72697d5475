"""Score tests beside a force over the state: what a further effect explains that neither that force nor the set itself can.

The likeliest force is pushed, and its deviations from there join what the set may adjust, held by their prior covariance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, cholesky, solve_triangular

from harness.diagnose.estimation.beside_state_force import looked_at, stiffness
from harness.diagnose.estimation.discrepancy import profiled
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.linearisation import linearise
from harness.diagnose.estimation.state_force import Force, StateForce
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.hypothesis import Candidate, compatible
from harness.diagnose.selection.score_tests import Nuisance, Score, carry_state, score
from harness.diagnose.selection.state_evidence import Evidence
from harness.diagnose.selection.study import Study

Array = NDArray[np.float64]


def ranked_beside(evidence: Evidence, study: Study, fitted: Fit, candidates: Sequence[Candidate]) -> list[Score]:
    """Score tests of candidates against a set and the force that it leaves out, at the mode of both; best first."""
    found = evidence.beside(study, fitted)
    loud = evidence.loudness(found)
    colours = tuple(c.louder(v) for c, v in zip(evidence.rough.colours, loud.tolist(), strict=True))
    likelihood = replace(evidence.rough, colours=colours)
    objective = replace(study.objective_under(likelihood, fitted), predictor=found.predictor)
    at = linearise(
        objective, found.x, found.states, upper=objective.bounds()[1], fixed=study.whole(fitted.hypothesis)
    )  # fmt: skip
    here = replace(fitted, x=found.x, states=found.states, linear=at)
    space = adjustable(evidence.force, found.shape, found.nodes, here, objective.nominal, loud)
    asked = [c for c in candidates if compatible(fitted.hypothesis, c) and not c.effect.switch]
    return score(here, found.predictor, likelihood, asked, study.problem, [space])


def promised(evidence: Evidence, study: Study, fitted: Fit, found: Score) -> float:
    """By how much less surprising recordings would be with one effect more, its price paid, in a linear view of where its score
    test starts it; unlike the score, the force that is left beside it may be another one.
    """
    beside = evidence.beside(study, fitted)
    hypothesis = fitted.hypothesis.with_(found.candidate)
    objective = study.objective(hypothesis).on(fitted.windows)
    states = {w: carry_state(study.predictor, fitted.hypothesis, hypothesis, s) for w, s in beside.states.items()}
    x = np.concatenate([beside.x, to_internal(found.candidate, found.start)])
    there = looked_at(
        evidence.force, replace(objective, likelihood=evidence.rough), beside.nodes, x, states, study.whole(hypothesis)
    )
    aim = evidence.force.likeliest(there.sums(evidence.force), beside.shape)
    return beside.surprise - aim.value - evidence.price(study, found.candidate)


def adjustable(
    force: StateForce, shape: Force | None, nodes: Array | None, here: Fit, nominal: int, loud: Array
) -> Nuisance:
    """What a set and the force beside it may adjust, at their mode. loud: variance by which channels are whitened."""
    size, free = len(here.x), here.free
    root = np.zeros((len(force.joint), 0))
    away = np.zeros(0)
    if shape is not None and nodes is not None:
        root = force.prior_root(shape)
        away = solve_triangular(root, nodes, lower=True, check_finite=False)
    own = profiled(here.linear)
    columns = []
    for window, part, shared in zip(here.windows, own, here.linear.shared, strict=True):
        rows = np.repeat(1.0 / np.sqrt(loud), window.size)[:, None]
        both = np.hstack([shared[:, free], -(rows * force.answers[window]) @ root])
        columns.append(both - part.states @ (part.states.T @ both))
    held = block_diag(np.diag(np.sqrt(stiffness(size, nominal)))[:, free], np.eye(len(away)))
    stacked = np.vstack([*columns, held])
    # Held as everything is, the columns are independent.
    lower = cholesky(stacked.T @ stacked, lower=True, check_finite=False)
    basis = solve_triangular(lower, stacked.T, lower=True, check_finite=False).T
    stated = np.where(np.arange(size) < nominal, here.x, 0.0)
    right = np.concatenate([*(part.residual for part in own), stated, away])
    return Nuisance(tuple(part.states for part in own), basis, right - basis @ (basis.T @ right), here.x[:nominal])
