"""Fits carried over to another study of the same windows: other noise, or efforts taken otherwise."""

from __future__ import annotations

from collections.abc import Sequence

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.constants.search import FAR_COST_RATIO
from harness.diagnose.selection.study import Study


def fitted_again(study: Study, fits: Sequence[Fit], best: Fit) -> list[Fit]:
    """Fits of another study from where those stand that do not leave far more than the best one."""
    return [study.fit(f.hypothesis, [f.x], f) for f in fits if f is best or f.score < FAR_COST_RATIO * best.score]
