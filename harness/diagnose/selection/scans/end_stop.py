"""An end stop: a contact from an angle on, by that angle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.selection.scan import Course, Scan


def _forces(parameters: NDArray[np.float64], course: Course) -> NDArray[np.float64]:
    """Forces (K, G) of stops, which push and never pull: angle, stiffness, damping."""
    angle, stiffness, damping = parameters.T[..., None]
    side = np.sign(angle)
    depth = side * course.q - np.abs(angle)
    push = stiffness * depth + damping * side * course.qd
    return np.asarray(-side * np.where(depth > 0.0, np.maximum(push, 0.0), 0.0))


# In its stiffness it is linear as long as that is small.
SCAN = Scan(_forces, linear=False)
