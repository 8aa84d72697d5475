"""Errors of what is told beside those of the nominal model and of other sets."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.diagnose.answer.constants import SHOWN_HYPOTHESES
from harness.diagnose.answer.predictive import Predictive
from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.claims.model_comparison import why_lost
from harness.diagnose.claims.rivals import ranking as likeliest
from harness.diagnose.criticism.locate import rmse
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.outcome import Outcome, as_read, judge, trained


def fit_rows(outcome: Outcome, conclusion: Conclusion, best: Predictive | None = None) -> list[dict[str, Any]]:
    """Errors of every channel before and after, on the data fitted and on those held out."""
    fits = {
        "nominal": (outcome.nominal, judge(outcome, outcome.nominal)),
        "refitted": (trained(outcome, outcome.empty), judge(outcome, outcome.empty)),
        "augmented": (conclusion.own, conclusion.held),
        **({"predictive": (best.fitted, best.held)} if best is not None else {}),
    }
    rows = []
    for c, channel in enumerate(outcome.problem.channels):
        row: dict[str, Any] = {"channel": channel.name, "unit": channel.unit}
        for name, (train, held) in fits.items():
            train, held = as_read(outcome, train), as_read(outcome, held)
            row[name] = {"train_rmse": rmse(outcome, train, c), "heldout_rmse": rmse(outcome, held, c)}
        rows.append({**row, "noise_floor": outcome.noise[c]})
    return rows


def likeliest_sets(outcome: Outcome, conclusion: Conclusion) -> list[dict[str, Any]]:
    """The likeliest hypotheses without their errors and why they lost: nothing has to be run."""
    study = outcome.study
    return [
        {
            "effects": list(f.hypothesis.keys),
            "bic": f.score + study.paid(f),
            "heldout_rmse": None,
            "heldout": {},
            "lost": "",
        }
        for f in likeliest(outcome, conclusion.best, SHOWN_HYPOTHESES)
    ]


def ranking(outcome: Outcome, conclusion: Conclusion) -> list[dict[str, Any]]:
    """The likeliest hypotheses, the one claimed first, and why the others lost.

    ``heldout`` has the error of every channel, ``heldout_rmse`` that of the first one.
    """
    study, best = outcome.study, conclusion.best
    least = _over_noise(outcome, _errors(outcome, best))
    rows: list[dict[str, Any]] = []
    for fitted in likeliest(outcome, best, SHOWN_HYPOTHESES):
        errors = _errors(outcome, fitted)
        # A set that fits better and was not taken beside a force over the state is one whose work that force does as well.
        imitated = conclusion.imitated if outcome.evidence is None else fitted.hypothesis.keys
        rows.append(
            {
                "effects": list(fitted.hypothesis.keys),
                "bic": fitted.score + study.paid(fitted),
                "heldout_rmse": next(iter(errors.values())),
                "heldout": errors,
                "lost": why_lost(study, best, fitted, _over_noise(outcome, errors), least, imitated),
            }
        )
    return rows


def _errors(outcome: Outcome, fitted: Fit) -> dict[str, float]:
    """What a set fitted to the training leaves of every channel held out, by its name."""
    held = as_read(outcome, judge(outcome, fitted))
    return {channel.name: rmse(outcome, held, c) for c, channel in enumerate(outcome.problem.channels)}


def _over_noise(outcome: Outcome, errors: dict[str, float]) -> float:
    """The same of all channels together, over the noise of each."""
    return float(
        np.sqrt(np.mean([(error / std) ** 2 for error, std in zip(errors.values(), outcome.noise, strict=True)]))
    )
