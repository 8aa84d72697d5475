"""Whether small motion is that of the forces it is of: their derivative, taken once more by another rule."""

from __future__ import annotations

import numpy as np

from harness.denoc import Denoc
from harness.denoc.motion.frequencies import coordinate_steps, tangent_stiffness
from harness.system.description import Array

# Of the largest entry: what a difference over a hundredth of the steps and its rounding leave is below a tenth of it.
ENOUGH = 1e-5


def astray(model: Denoc, q: Array, qd: Array) -> bool:
    """Whether the native tangent stiffness at a state (nq,), (n,) is not the derivative of the native forces."""
    found = tangent_stiffness(model, q, qd) - model.linear_passive()[0]
    again = np.empty_like(found)
    for k, step in enumerate(1e-2 * coordinate_steps(model)):
        shift = np.zeros(model.n)
        shift[k] = step
        ahead, behind = (model.bias(model.integrate(q, way * shift), qd) for way in (1.0, -1.0))
        again[:, k] = (ahead - behind) / (2.0 * step)
    size = float(np.abs(again).max())
    return bool(np.abs(found - again).max() > ENOUGH * size) if np.isfinite(size) else False
