"""How estimates hang together: the correlations of all that was claimed, and of the nominal quantities that move with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.diagnose.answer.constants import TOLD_CORRELATION
from harness.diagnose.estimation.least_squares import Fit, covariance
from harness.diagnose.prediction.predictor import Predictor


def correlations(predictor: Predictor, fitted: Fit, keys: Sequence[str]) -> Mapping[str, Any] | None:
    """Names and matrix (k, k) of correlations between the estimates, initial states profiled out; None for fewer than two.

    keys: of the members that are told. A parameter that stands at a bound has no correlation and is left out; so is a nominal
    quantity that no told parameter leans on.
    """
    count = len(predictor.nominal)
    told: dict[int, str] = {}
    for k, member in enumerate(fitted.hypothesis.members):
        if member.key in keys:
            first = count + fitted.hypothesis.span(k).start
            told |= {first + j: f"{member.key}.{name}" for j, name in enumerate(member.effect.parameter_names)}
    matrix = covariance(fitted, count)
    deviation = np.sqrt(np.diag(matrix))
    known = np.isfinite(deviation) & (deviation > 0.0)
    rows = [i for i in told if known[i]]
    if not rows:
        return None
    with np.errstate(invalid="ignore", divide="ignore"):
        related = matrix / np.outer(deviation, deviation)
    names = {i: f"{q.kind} of {q.name}" for i, q in enumerate(predictor.nominal)}
    felt = [i for i in range(count) if known[i] and float(np.abs(related[i, rows]).max()) > TOLD_CORRELATION]
    every = [*rows, *felt]
    if len(every) < 2:
        return None
    return {"parameters": [(told | names)[i] for i in every], "matrix": related[np.ix_(every, every)]}
