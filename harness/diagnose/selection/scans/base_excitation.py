"""A base that shakes: waves over time, by their frequency."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.selection.scan import Course, Scan, wave


def _forces(parameters: NDArray[np.float64], course: Course) -> NDArray[np.float64]:
    return wave(parameters, 2.0 * np.pi * course.time)


SCAN = Scan(_forces, shakes=True)
