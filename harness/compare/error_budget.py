"""What the difference of two motions is made of: integration error, rounding, and what is left to be explained."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.compare.trajectories import separation
from harness.engines.protocol import EngineModel

Array = NDArray[np.float64]

# RK4: halving the step takes the error down sixteen times.
ORDER = 4


@dataclass(frozen=True)
class Budget:
    """Largest errors of one engine's motion over a run [rad or m].

    integration: of the step size, by halving it. order: the order measured by halving twice, 4 for RK4 that
    converges; nan where rounding hides it. rounding: what a change in the last digit of the state grows to.
    """

    step: float
    integration: float
    order: float
    rounding: float

    @property
    def total(self) -> float:
        return self.integration + self.rounding

    def explains(self, difference: float, other: Budget, *, margin: float = 3.0) -> bool:
        """Whether a difference between two motions with these budgets is within ``margin`` times their sum."""
        return difference <= margin * (self.total + other.total)


def error_budget(model: EngineModel, q0: Array, qd0: Array, time: Array, *, step: float) -> Budget:
    """The errors of a fixed-step run from (q0, qd0) sampled at ``time`` [s] with steps of ``step`` [s]."""
    coarse, middle, fine = (model.simulate(q0, qd0, time, step=step / 2**k) for k in range(3))
    first = float(separation(coarse, middle)[1].max())
    second = float(separation(middle, fine)[1].max())
    nudged = model.simulate(np.nextafter(q0, q0 + 1.0), qd0, time, step=step)
    rounding = float(separation(coarse, nudged)[1].max())
    above_rounding = second > 3.0 * rounding and second > 0.0
    return Budget(
        step=step,
        # Richardson: x_h - x_{h/2} is 15/16 of the error of x_h.
        integration=first * 2**ORDER / (2**ORDER - 1),
        order=float(np.log2(first / second)) if above_rounding else float("nan"),
        rounding=rounding,
    )
