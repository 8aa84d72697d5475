"""The kernels of the recursions with the types that they are used with, for compiling ahead of use."""

from __future__ import annotations

from harness.denoc.compiling import signature
from harness.denoc.compiling.signature import CUBE, FLEXIBLE, MATRIX, RIGID, VECTOR
from harness.denoc.recursion import flexible, flexible_address, rigid, rigid_address, rigid_mass
from harness.denoc.recursion.binding import entry
from harness.denoc.recursion.dynamics_call import forward_entry, inverse_entry


def rigid_dynamics() -> None:
    """Forward and inverse dynamics of rigid mechanisms, and their ways in from Python."""
    rigid_address.addresses()
    entry(forward_entry, 4)
    entry(inverse_entry, 4)


def rigid_chain() -> None:
    """Forward dynamics of a short rigid chain."""
    rigid_address.chain_address()


def rigid_others() -> None:
    """What else is asked of rigid mechanisms: mass matrix, energies, passive forces, poses."""
    entry(rigid_address.mass_entry, 2)
    signature.compile_for(rigid_mass.mass_matrix_rows, *RIGID, MATRIX, CUBE)
    signature.compile_for(rigid.energy_rows, *RIGID, MATRIX, MATRIX, MATRIX)
    signature.compile_for(rigid.subtract_passive, *RIGID, VECTOR, VECTOR, VECTOR)
    signature.compile_for(rigid.locate, *RIGID, VECTOR, VECTOR)


def flexible_dynamics() -> None:
    """Forward and inverse dynamics of mechanisms with flexible links."""
    flexible_address.addresses()


def flexible_others() -> None:
    """What else is asked of flexible mechanisms: mass matrix, energies, motion of hubs, passive forces, poses."""
    signature.compile_for(flexible.mass_matrix_rows, *FLEXIBLE, MATRIX, CUBE)
    signature.compile_for(flexible.energy_rows, *FLEXIBLE, MATRIX, MATRIX, MATRIX)
    signature.compile_for(flexible.hub_rows, 1, 1, MATRIX, 1, MATRIX, MATRIX, MATRIX, VECTOR, MATRIX)
    signature.compile_for(flexible.subtract_passive, *FLEXIBLE, VECTOR, VECTOR, VECTOR)
    signature.compile_for(flexible.locate, *FLEXIBLE, VECTOR, VECTOR)
