"""With what theory foretells of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.beginning import Addition, Beginning
from harness.system import System

Array = NDArray[np.float64]


def foretold(candidate: Candidate, system: System, start: Array) -> Array | None:
    """Starting values with what theory foretells of them in their place; none where it does not."""
    reshape = candidate.effect.reshape
    if reshape is None or reshape.expected is None:
        return None
    values = candidate.effect.named(start) | dict(reshape.expected(system, candidate.site))
    return np.array([values[name] for name in candidate.effect.parameter_names])


def _starts(addition: Addition) -> list[Array]:
    likely = foretold(addition.candidate, addition.bench.problem.system, addition.promised)
    return [] if likely is None else [addition.beside(likely)]


BEGINNING = Beginning("as theory foretells", _starts, likeliest=True)
