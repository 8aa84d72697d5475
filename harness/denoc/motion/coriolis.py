"""Coriolis matrix of mechanisms with flexible links, from the mass matrix's derivatives (Christoffel symbols)."""

from __future__ import annotations

import numpy as np

from harness.denoc.motion.frequencies import CENTRAL, coordinate_steps
from harness.denoc.motion.mechanism import Mechanism
from harness.denoc.recursion.tree import Array


def christoffel_matrix(model: Mechanism, q: Array, qd: Array) -> Array:
    """C_ij = ½ Σ_k (∂M_ij/∂q_k + ∂M_ik/∂q_j - ∂M_jk/∂q_i) q̇_k, shape (n, n).

    Derivatives are central differences of order 6, relative error about 1e-12 (see ``frequencies``).
    """
    n = model.n
    derivative = np.empty((n, n, n))
    for k, step in enumerate(coordinate_steps(model)):
        shift = np.zeros(n)
        shift[k] = step
        derivative[k] = sum(
            weight * (model.mass_matrix(q + times * shift) - model.mass_matrix(q - times * shift))
            for times, weight in CENTRAL
        )
        derivative[k] /= step
    rate = np.einsum("kij,k->ij", derivative, qd)
    cross = np.einsum("jik,k->ij", derivative, qd)
    return np.asarray(0.5 * (rate + cross - cross.T))
