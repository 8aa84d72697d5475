"""How much was said: what a share of right answers, or of intervals that hold the truth, does not tell by itself.

Both can be had by saying little: a finding among many, an interval without end. These say how little.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.proof.score import CaseScore

BEYOND = 2.0 / 0.05  # what a truth outside costs beside its distance, of intervals of 95 %


def sharpness(scores: Sequence[CaseScore]) -> dict[str, float | None]:
    """All of it, by name: of single effects, whether they show or not."""
    single = [s for s in scores if s.kind == "single"]
    return {
        "worth_single": worth(single),
        "listed_single": listed(single),
        "interval_width": widths(scores),
        "interval_score": interval_score(scores),
    }


def listed(scores: Sequence[CaseScore]) -> float | None:
    """Among how many effects a finding is told, itself included: mean; None without findings."""
    sizes = [size for s in scores for size in s.listed]
    return float(np.mean(sizes)) if sizes else None


def worth(scores: Sequence[CaseScore]) -> float | None:
    """Mean of ``CaseScore.worth``; None without cases."""
    return float(np.mean([s.worth for s in scores])) if scores else None


def widths(scores: Sequence[CaseScore]) -> float | None:
    """Width of 95 % intervals over the size of the truth: median; None without any."""
    low, high, true = _intervals(scores)
    with np.errstate(over="ignore"):
        return float(np.median((high - low) / np.abs(true))) if len(true) else None


def interval_score(scores: Sequence[CaseScore]) -> float | None:
    """Mean interval score over the size of the truth (Gneiting and Raftery, J. Am. Stat. Assoc. 102 (2007) 359): an interval's
    width, and forty times as far as it lies beside the truth; least for who states what they believe. None without any."""
    low, high, true = _intervals(scores)
    if not len(true):
        return None
    with np.errstate(over="ignore"):
        beside = np.maximum(low - true, 0.0) + np.maximum(true - high, 0.0)
        return float(np.mean((high - low + BEYOND * beside) / np.abs(true)))


def _intervals(scores: Sequence[CaseScore]) -> tuple[NDArray[np.float64], ...]:
    """Ends and truths of what is rightly named; without phases and what truly is zero, which have no size."""
    rows = [
        (low, high, true)
        for s in scores
        if s.in_class
        for _, name, true, _, _, low, high in s.parameters
        if name != "phase" and true
    ]
    return tuple(np.array(rows, dtype=np.float64).reshape(-1, 3).T)
