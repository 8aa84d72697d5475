"""What a way to begin a fit with one more effect is: starting values of it, and of what is there already.

A way is a file of ``beginnings/`` that says ``BEGINNING = Beginning(what, starts, …)``, and its name stands in
``beginnings/catalogue.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.bench import Bench

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Addition:
    """One more effect beside a fitted set. promised: the values of it [SI] that its score test promises most of."""

    bench: Bench
    base: Fit
    candidate: Candidate
    promised: Array

    def beside(self, values: Array) -> Array:
        """Where a fit begins with the effect at some values [SI] and the set as it stands."""
        return np.concatenate([self.base.x, to_internal(self.candidate, values)])


@dataclass(frozen=True, eq=False)
class Beginning:
    """One way to begin. what: in words. starts: parameter vectors of the set with the effect.

    likeliest: whether it is gone on with where nothing else leads out of how the nominal quantities are bent; the last such way is.
    """

    what: str
    starts: Callable[[Addition], list[Array]]
    likeliest: bool = False
