"""The kernels of the methods over many states with the types that they are used with, for compiling ahead of use."""

from __future__ import annotations

import numpy as np

from harness.denoc.batch import chain_mass, dynamics, tree_mass, turns
from harness.denoc.compiling import signature
from harness.denoc.compiling.signature import CUBE, MATRIX, TABLE, VECTOR, WHOLE


def batches() -> None:
    """Dynamics and mass matrices of many states."""
    signature.compile_for(dynamics.forward_dynamics, 1, 1, TABLE, *[VECTOR] * 8)
    signature.compile_for(dynamics.inverse_dynamics, 1, 1, TABLE, *[VECTOR] * 7)
    signature.compile_for(tree_mass.mass_matrix, 1, 1, TABLE, np.zeros(1, dtype=np.uint64), *[VECTOR] * 5)
    signature.compile_for(dynamics.all_finite, VECTOR)
    signature.compile_for(chain_mass.chain_mass_matrix, 1, 1, TABLE, *[VECTOR] * 5)


def in_space() -> None:
    """What ``SpaceBatch`` converts states with."""
    signature.compile_for(dynamics.floating_dynamics, 1, 1, TABLE, *[VECTOR] * 8)
    signature.compile_for(turns.to_turns, TABLE, WHOLE, *[VECTOR] * 2, *[MATRIX] * 5, VECTOR)
    signature.compile_for(turns.forces_to_turns, TABLE, VECTOR, *[MATRIX] * 4)
    signature.compile_for(turns.accelerations_from_turns, TABLE, *[MATRIX] * 4)
    signature.compile_for(turns.accelerations_to_turns, TABLE, *[MATRIX] * 5)
    signature.compile_for(turns.forces_from_turns, TABLE, VECTOR, *[MATRIX] * 3)
    signature.compile_for(turns.masses_from_turns, TABLE, MATRIX, CUBE)
