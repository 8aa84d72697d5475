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
    beside_force = outcome.evidence is not None
    # Sets are compared as they are fitted; what is told may have its numbers from beside a force, and its errors are of those.
    least = _over_noise(outcome, _errors(outcome, judge(outcome, best)))
    rows: list[dict[str, Any]] = []
    for fitted in likeliest(outcome, best, SHOWN_HYPOTHESES):
        told = fitted.hypothesis.identity == best.hypothesis.identity
        errors = _errors(outcome, conclusion.held if told else judge(outcome, fitted))
        # What more a set has that was not taken beside a force over the state is what that force does as well.
        more = [key for key in fitted.hypothesis.keys if key not in best.hypothesis.keys]
        rows.append(
            {
                "effects": list(fitted.hypothesis.keys),
                "bic": fitted.score + study.paid(fitted),
                "heldout_rmse": next(iter(errors.values())),
                "heldout": errors,
                "lost": why_lost(
                    study, best, fitted, _over_noise(outcome, errors), least,
                    more if beside_force else conclusion.imitated, beside_force=beside_force,
                ),
            }
        )  # fmt: skip
    return rows


def _errors(outcome: Outcome, held: Fit) -> dict[str, float]:
    """What a fit, judged on the data held out, leaves of every channel there, by its name."""
    held = as_read(outcome, held)
    return {channel.name: rmse(outcome, held, c) for c, channel in enumerate(outcome.problem.channels)}


def _over_noise(outcome: Outcome, errors: dict[str, float]) -> float:
    """The same of all channels together, over the noise of each."""
    return float(
        np.sqrt(np.mean([(error / std) ** 2 for error, std in zip(errors.values(), outcome.noise, strict=True)]))
    )
