"""Closed loops in engines of others: what they are told of a cut, and what our side of a comparison does with their matrices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.engines.protocol import Array
from harness.errors import InputError, UnsupportedError
from harness.system import Coupling, System
from harness.system.closure import completed
from harness.system.loop import BALL, REVOLUTE, WELD, Connection, connections

# Singular values below this share of the largest are none: states are closed to 1e-12.
_RANK = 1e-8


@dataclass(frozen=True, eq=False)
class Closing:
    """Connections and couplings of a system's loops."""

    connections: tuple[Connection, ...]
    couplings: tuple[Coupling, ...]


def closing(system: System) -> Closing:
    """Loops as balls, revolute joints and welds; UnsupportedError where a cut is none of these."""
    cut = completed(system, (BALL, *REVOLUTE.values(), WELD)) if system.loops else ()
    couplings = tuple(loop for loop in system.loops if isinstance(loop, Coupling))
    return Closing(tuple(c for loop in cut for c in connections(loop)), couplings)


def refuses_loops(engine: str, system: System, *, couplings: bool) -> str | None:
    """Why an engine cannot hold the system's loops, or None."""
    if not system.loops:
        return None
    try:
        found = closing(system)
    except (UnsupportedError, InputError) as error:
        return f"{engine} closes balls, revolute joints and welds: {error.what}"
    if found.couplings and not couplings:
        return f"{engine} has no polynomial coupling of joints, as {found.couplings[0].name!r} is"
    return None


def eliminated(mass: Array, forces: Array, jacobian: Array, asked: Array) -> Array:
    """Accelerations a with M a = f + Jᵀ λ and J a = asked, by the singular value decomposition of J L⁻ᵀ, M = L Lᵀ."""
    lower = np.linalg.cholesky(mass)
    free = np.linalg.solve(mass, forces)
    rows = np.linalg.solve(lower, jacobian.T).T
    scale = np.linalg.norm(rows, axis=1)
    scale[scale == 0.0] = 1.0
    more = np.linalg.lstsq(rows / scale[:, None], (asked - jacobian @ free) / scale, rcond=_RANK)[0]
    return np.asarray(free + np.linalg.solve(lower.T, more))


def least(forces: Array, jacobian: Array) -> Array:
    """Generalized forces that move a closed mechanism as ``forces`` do, the least ones."""
    return np.asarray(forces - jacobian.T @ np.linalg.lstsq(jacobian.T, forces, rcond=_RANK)[0])
