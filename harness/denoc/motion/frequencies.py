"""Natural frequencies of small motion about a state, or about steady rotation.

The equations, damping left out, are F(q, q̇, q̈) = M q̈ + C q̇ + g + K (q - rest) = τ. Small motion about a state obeys
M δq̈ + G δq̇ + S δq = 0 with G = ∂F/∂q̇ (gyroscopic) and S = ∂F/∂q, which holds gravity, the beams' stiffness and, about
rotation, centrifugal softening and, through the foreshortening, stiffening.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from harness.denoc.motion.mechanism import Mechanism
from harness.denoc.recursion.rows import FIRST, FIXED, KIND
from harness.denoc.recursion.tree import Array

#: Central difference of order 6 as (steps, weight): with steps of 0.02 rad its error is 5e-13 for sines, and none for the
#: polynomials of degree six and less that elastic coordinates enter by.
CENTRAL = ((1, 45.0 / 60.0), (2, -9.0 / 60.0), (3, 1.0 / 60.0))
_STEP = 0.02
# Eigenvalues below this share of the largest are rounding: motion without restoring force.
_ROUNDING = 1e-13
# An eigenvalue with this share of growth or decay is no vibration.
_STRAIGHT = 1e-6


def frequencies(model: Mechanism, q: ArrayLike, qd: ArrayLike | None = None) -> Array:
    """Undamped natural frequencies [Hz], ascending; what has no restoring force, or is unstable, is left out.

    q (n,): the state, best one of equilibrium. qd (n,): coordinates whose velocity is not zero are driven at that
    speed (a rotor in steady rotation) and take no part in the vibration.
    Raises InputError for wrong sizes and what is not finite.
    """
    state = model.position("q", q)
    speed = np.zeros(model.n) if qd is None else model.vector("qd", qd)
    mass = model.mass_matrix(state)
    stiffness = tangent_stiffness(model, state, speed)
    free = speed == 0.0
    part = np.ix_(free, free)
    if not free.any():
        return np.zeros(0)
    if free.all():
        # A potential's second derivative is symmetric.
        values = scipy.linalg.eigh(0.5 * (stiffness + stiffness.T), mass, eigvals_only=True)
        values = values[values > _ROUNDING * np.abs(values).max()]
        return np.asarray(np.sqrt(values) / (2.0 * np.pi))
    gyroscopic = np.linalg.solve(mass[part], velocity_matrix(model, state, speed)[part])
    restoring = np.linalg.solve(mass[part], stiffness[part])
    count = int(free.sum())
    companion = np.block([[np.zeros((count, count)), np.eye(count)], [-restoring, -gyroscopic]])
    roots = np.linalg.eigvals(companion)
    omega = roots.imag
    keep = (omega > np.sqrt(_ROUNDING) * np.abs(roots).max()) & (np.abs(roots.real) < _STRAIGHT * np.abs(roots))
    return np.asarray(np.sort(omega[keep]) / (2.0 * np.pi))


def tangent_stiffness(model: Mechanism, q: Array, qd: Array) -> Array:
    """∂F/∂q at (q, q̇) and q̈ = 0, damping left out, shape (n, n)."""
    linear, _ = model.linear_passive()
    result = np.empty((model.n, model.n))
    for k, step in enumerate(coordinate_steps(model)):
        shift = np.zeros(model.n)
        shift[k] = step
        result[:, k] = sum(
            weight
            * (model.bias(model.integrate(q, times * shift), qd) - model.bias(model.integrate(q, -times * shift), qd))
            for times, weight in CENTRAL
        )
        result[:, k] /= step
    return result + linear


def velocity_matrix(model: Mechanism, q: Array, qd: Array) -> Array:
    """∂F/∂q̇ at (q, q̇), damping left out, shape (n, n): exact, since F is quadratic in the velocities."""
    unit = np.eye(model.n)
    return np.array([0.5 * (model.bias(q, qd + e) - model.bias(q, qd - e)) for e in unit]).T


def coordinate_steps(model: Mechanism) -> Array:
    """Changes of the coordinates [rad, m or modal] that turn or shift what they move by about 0.02, shape (n,)."""
    steps = np.full(model.n, _STEP)
    for body, data in model.beams.items():
        own = int(model.tree.topology[body, FIRST] + (model.tree.topology[body, KIND] != FIXED))
        first, _ = model.velocity_share(own)
        size = np.maximum(np.abs(data.slope).max(axis=0), np.abs(data.s).max(axis=0) / data.length)
        steps[first : first + data.coordinates] = _STEP / size
    return steps
