"""What ways out of wrong valleys ask of the fits of one diagnosis; ``selection.study.Study`` is one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.objective import Objective
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]


class Bench(Protocol):
    """Fits of hypotheses on one set of training windows; see ``Study`` for what each member means."""

    problem: Problem
    predictor: Predictor
    rung: set[frozenset[str]]

    @property
    def samples(self) -> float: ...
    def objective(self, hypothesis: Hypothesis) -> Objective: ...
    def criterion(self, fitted: Fit) -> float: ...
    def states_for(self, hypothesis: Hypothesis, near: Fit | None = None) -> dict[Window, Array]: ...
    def others(self, hypothesis: Hypothesis) -> list[dict[Window, Array]]: ...
    def whole(self, hypothesis: Hypothesis) -> NDArray[np.bool_]: ...
    def fit(
        self,
        hypothesis: Hypothesis,
        starts: Sequence[Array],
        near: Fit | None,
        *,
        most_steps: int = ...,
        target: float = ...,
    ) -> Fit: ...
