"""What a scan is: an effect that is a force over angle or time, tried at many places by the linear response alone.

No slope leads from one place to another. A scan is a file of ``scans/`` with the effect's name that says
``SCAN = Scan(forces, …)``, and its name stands in ``scans/catalogue.py``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Course:
    """A motion that forces are scanned along: time of the recording [s], position and velocity of the joint, or neither, (G,)."""

    time: Array
    q: Array
    qd: Array


@dataclass(frozen=True, eq=False)
class Scan:
    """One effect's scan.

    forces: of parameters (K, …) along a course, (K, G). shakes: whether they are accelerations of the base and no forces of a
    joint. linear: whether they are linear in the effect's size, so that they need not be made small.
    """

    forces: Callable[[Array, Course], Array]
    shakes: bool = False
    linear: bool = True


def wave(parameters: Array, place: Array) -> Array:
    """Sines over an angle or over time as one (K, G): amplitude, periods in a turn, phase."""
    amplitude, periods, phase = parameters.T[..., None]
    return np.asarray(amplitude * np.sin(periods * place + phase))
