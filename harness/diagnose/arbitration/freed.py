"""Free runs of a model in which the numbers compared are free: what a fit moves, and within which bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.arbitration.numbers import Number, values
from harness.diagnose.estimation.objective import Objective
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.deadline import Deadline
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.system import System

Array = NDArray[np.float64]

NOTHING = Hypothesis()


class Freed(Predictor):
    """Predictions of one model; parameters are changes of its numbers in units of their sizes, or none: the model as it
    is."""

    def __init__(self, problem: Problem, every: Sequence[Number] = (), *, deadline: Deadline | None = None) -> None:
        super().__init__(problem, deadline=deadline)
        self.nominal = ()
        self.numbers = tuple(every)
        lane = self.mechanism(NOTHING).model
        self.places = np.array([lane.slot(*n.key) for n in self.numbers], dtype=np.intp)
        self.sizes = np.array([n.size for n in self.numbers])
        self.start = values(problem.system, self.numbers) if self.numbers else np.zeros(0)

    def size(self, hypothesis: Hypothesis) -> int:
        return len(self.numbers)

    def made(self, hypothesis: Hypothesis, x: Array) -> tuple[Array, tuple[System, ...]]:
        """Rows of lanes: a base parameter is moved by the one of its parameters that has a factor of one."""
        first, systems = super().made(hypothesis, np.zeros((1, 0)))
        rows = np.repeat(first, len(x), axis=0)
        if x.shape[1]:
            rows[:, self.places] += x * self.sizes
        return rows, systems * len(x)

    def of(self, numbers: Array) -> Array:
        """The parameter vector at which the numbers (K,) are such [SI]."""
        return np.asarray((numbers - self.start) / self.sizes)

    def told(self, x: Array) -> Array:
        """The numbers (K,) at a parameter vector [SI]."""
        return np.asarray(self.start + x * self.sizes)

    @property
    def held(self) -> NDArray[np.bool_]:
        """Numbers that shape a term which the model has not, (K,)."""
        return np.array([n.shape and v == 0.0 for n, v in zip(self.numbers, self.start, strict=True)], dtype=bool)


@dataclass(frozen=True, eq=False)
class FreedObjective(Objective):
    """What a fit of a freed model makes small; ``least`` are the lower bounds of its parameters, (K,)."""

    least: Array = field(default_factory=lambda: np.zeros(0))

    def bounds(self) -> tuple[Array, Array]:
        return self.least, np.full(len(self.least), np.inf)


def lower_bounds(freed: Freed) -> Array:
    """Where each number of a freed model would be less than none, (K,)."""
    return np.array(
        [-v / s if n.positive else -np.inf for n, v, s in zip(freed.numbers, freed.start, freed.sizes, strict=True)]
    )
