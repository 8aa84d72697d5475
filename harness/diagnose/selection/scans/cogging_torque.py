"""A cogging torque: waves over the joint's angle, by their number in a turn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.selection.scan import Course, Scan, wave


def _forces(parameters: NDArray[np.float64], course: Course) -> NDArray[np.float64]:
    return wave(parameters, course.q)


SCAN = Scan(_forces)
