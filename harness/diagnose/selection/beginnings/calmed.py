"""Without a vibration of its own, for what brings one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.beginning import Addition, Beginning

Array = NDArray[np.float64]


def calmed(candidate: Candidate, start: Array) -> Array | None:
    """Starting values whose own vibration dies out quickly; none where there is no such vibration.

    One that goes on has a valley at every phase. What gives without ringing has one, and leads to where the ringing is found.
    """
    if not candidate.effect.adds_coordinates:
        return None
    out = start.copy()
    for k, parameter in enumerate(candidate.effect.parameters):
        if parameter.name in ("damping", "damping_ratio"):
            out[k] = max(out[k], *parameter.start_values(candidate.references))
    return None if np.array_equal(out, start) else out


def _starts(addition: Addition) -> list[Array]:
    calm = calmed(addition.candidate, addition.promised)
    return [] if calm is None else [addition.beside(calm)]


BEGINNING = Beginning("with its vibration calmed", _starts)
