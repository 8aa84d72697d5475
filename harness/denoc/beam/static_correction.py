"""What the modes of a beam leave out of its deflection: how modes that the model does not keep give way to slow loads.

Modes as mounted vibrate at true frequencies, but a few of them give the deflection under a slow load only to a few per cent.
The load that bends the beam is known (its own weight and acceleration, and the payload's), and so is what a clamped beam gives
under it; the difference to what the kept modes give belongs to the reading.

Source: R. E. Cornwell, R. R. Craig and C. P. Johnson, On the application of the mode-acceleration method to structural
engineering problems, Earthquake Engineering and Structural Dynamics 11 (1983) 679.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from harness.denoc.beam.integrals import BENDING, BeamData
from harness.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LeftOut:
    """Readings per unit acceleration of the undeformed line and of the modes, each (2 + m,), for the bending plane.

    Factors on: acceleration less gravity of the beam's root along the bending direction [m/s²], angular acceleration in the
    bending plane [rad/s²], accelerations of the plane's m modes. tip: [m]; curvature: at the root [1/m].
    """

    tip: Array
    curvature: Array

    @property
    def nothing(self) -> bool:
        """Whether nothing is added to any reading."""
        return not (np.any(self.tip) or np.any(self.curvature))

    def read(self, factors: Array, root: Array, turning: Array, modes: Array) -> Array:
        """A reading (...) from accelerations of the root (...), of turning (...) and of the modes (..., m)."""
        return np.asarray(factors[0] * root + factors[1] * turning + modes @ factors[2:])


# Asked for again with every channel of a motion.
@lru_cache(maxsize=256)
def left_out(system: System, data: BeamData) -> LeftOut:
    """What a flexible link's modes leave out of its tip deflection and root curvature; nothing where further links ride on it."""
    kept = np.flatnonzero(data.plane == BENDING)
    beam = system.link(data.link).beam
    assert beam is not None
    if any(joint.parent == data.link for joint in system.joints):
        # Their forces on the beam are no such load.
        return LeftOut(np.zeros(2 + len(kept)), np.zeros(2 + len(kept)))
    x, l, s = data.x, data.length, data.s[:, kept]
    # Shapes of the acceleration along the beam: even, rising, and the modes'; then at the tip, with their slopes there.
    along = np.column_stack([np.ones_like(x), x, s])
    tip = np.concatenate([[1.0, l], data.tip.s[kept]])
    slope = np.concatenate([[0.0, 1.0], data.tip.slope[kept]])
    normal = data.normal
    turning = float(normal @ data.payload_inertia @ normal)
    loads = -data.rho * data.weights[:, None] * along
    force, moment = -data.payload * tip, -turning * slope
    # A clamped beam under a load at x, and under a force and a moment at its end.
    rigidity = beam.bending_stiffness
    deflection = (x**2 * (3.0 * l - x) / 6.0) @ loads + l**3 / 3.0 * force + l**2 / 2.0 * moment
    curvature = x @ loads + l * force + moment
    curved = data.curvature[:, kept]
    stiffness = rigidity * np.einsum("p,pk,pl->kl", data.weights, curved, curved)
    modal = np.linalg.solve(stiffness, s.T @ loads + np.outer(tip[2:], force) + np.outer(slope[2:], moment))
    return LeftOut(
        deflection / rigidity - data.tip.s[kept] @ modal,
        curvature / rigidity - data.at(0.0).curvature[kept] @ modal,
    )
