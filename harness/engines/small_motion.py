"""Natural frequencies of small motion from a mass and a stiffness matrix; shared by the adapters."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import LinAlgError, eigh

from harness.engines.protocol import Array, EngineError

# Stiffnesses below this share of the greatest are rounding of a neutral direction (a joint with an upright axis).
NEUTRAL = 1e-9


def frequencies(mass: Array, stiffness: Array) -> Array:
    """Natural frequencies [Hz], ascending, of M x'' + K x = 0; neutral and unstable directions are left out.

    mass, stiffness: symmetric, shape (n, n). Raises EngineError if the mass matrix is not positive definite.
    """
    symmetric = 0.5 * (stiffness + stiffness.T)
    try:
        squares = eigh(symmetric, mass, eigvals_only=True)
    except LinAlgError:
        raise EngineError("small motion has no frequencies: the mass matrix is not positive definite") from None
    floor = NEUTRAL * float(np.max(np.abs(squares), initial=0.0))
    return np.sqrt(squares[squares > floor]) / (2.0 * np.pi)


def jacobian(function: Callable[[Array], Array], at: Array, step: float = 1e-4) -> Array:
    """∂function/∂x at ``at`` by central differences with one Richardson step, error O(step⁴); shape (m, n)."""
    columns = []
    for k in range(at.size):
        slopes = []
        for h in (step, 0.5 * step):
            forward, backward = at.copy(), at.copy()
            forward[k] += h
            backward[k] -= h
            slopes.append((function(forward) - function(backward)) / (forward[k] - backward[k]))
        columns.append((4.0 * slopes[1] - slopes[0]) / 3.0)
    return np.array(columns).T.reshape(-1, at.size)
