"""The kernels of the methods over many states with the types that they are used with, for compiling ahead of use."""

from __future__ import annotations

import numpy as np

from harness.denoc.batch import chain_mass, dynamics, tree_mass
from harness.denoc.compiling import signature
from harness.denoc.compiling.signature import TABLE, VECTOR


def batches() -> None:
    signature.compile_for(dynamics.forward_dynamics, 1, 1, TABLE, *[VECTOR] * 8)
    signature.compile_for(dynamics.inverse_dynamics, 1, 1, TABLE, *[VECTOR] * 7)
    signature.compile_for(tree_mass.mass_matrix, 1, 1, TABLE, np.zeros(1, dtype=np.uint64), *[VECTOR] * 5)
    signature.compile_for(dynamics.all_finite, VECTOR)
    signature.compile_for(chain_mass.chain_mass_matrix, 1, 1, TABLE, *[VECTOR] * 5)
