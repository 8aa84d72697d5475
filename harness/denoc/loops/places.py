"""Where things begin in the arrays of ``tables``, for kernels: indices into the two flat arrays."""

from __future__ import annotations

from typing import Any

from harness.denoc.compiling.compiled import allocating, internal
from harness.denoc.loops.tables import (
    CONDITION,
    CONDITIONS,
    COUPLING,
    COUPLINGS,
    FRAME,
    HEAD,
    LOOPS,
    MOVING,
    NQ,
    STATE,
    N,
)
from harness.denoc.recursion.binding import CUT_NUMBERS, CUTS, vector_at, words_at

Places = Any
Numbers = Any


@allocating
def places_of(header: Any) -> Any:
    """The loops' integers."""
    head = words_at(header[CUTS], HEAD)
    size = HEAD + 2 * head[LOOPS] + CONDITION * head[CONDITIONS] + COUPLING * head[COUPLINGS]
    return words_at(header[CUTS], size)


@allocating
def numbers_of(header: Any, places: Any) -> Any:
    """The loops' floats, workspace included."""
    return vector_at(header[CUT_NUMBERS], list_of_rows(places) + places[CONDITIONS])


@internal
def condition(places: Places, k: int) -> int:
    """Integers of condition k."""
    return HEAD + 2 * places[LOOPS] + CONDITION * k


@internal
def coupling(places: Places, k: int) -> int:
    """Integers of coupling k."""
    return HEAD + 2 * places[LOOPS] + CONDITION * places[CONDITIONS] + COUPLING * k


@internal
def frame(k: int) -> int:
    """Constants of frame k, two a loop."""
    return 1 + FRAME * k


@internal
def sign(places: Places, k: int) -> int:
    """The sign of condition k."""
    return 1 + 2 * FRAME * places[LOOPS] + k


@internal
def terms(places: Places, k: int) -> int:
    """Coefficients of coupling k."""
    return 1 + 2 * FRAME * places[LOOPS] + places[CONDITIONS] + 5 * k


@internal
def moving(places: Places, k: int) -> int:
    """Frame k in base axes."""
    return terms(places, places[COUPLINGS]) + MOVING * k


@internal
def state(places: Places, k: int) -> int:
    """Condition k at a state."""
    return moving(places, 2 * places[LOOPS]) + STATE * k


@internal
def row(places: Places, k: int) -> int:
    """Equation k: n coefficients and the right-hand side."""
    return state(places, places[CONDITIONS]) + (places[N] + 1) * k


@internal
def copy(places: Places, k: int) -> int:
    """A copy of equation k."""
    return row(places, places[CONDITIONS] + k)


@internal
def twists(places: Places, k: int) -> int:
    """What velocities make of the twist of frame k: six times n numbers."""
    return row(places, 2 * places[CONDITIONS]) + 6 * places[N] * k


@internal
def mass(places: Places) -> int:
    """The mass matrix, n times n."""
    return twists(places, 2 * places[LOOPS])


@internal
def vector(places: Places, k: int) -> int:
    """Six vectors of n."""
    return mass(places) + places[N] * (places[N] + k)


@internal
def nq_vector(places: Places) -> int:
    """A vector of nq."""
    return vector(places, 6)


@internal
def list_of_coefficients(places: Places) -> int:
    """Which coefficients of an equation are not zero, up to n."""
    return nq_vector(places) + places[NQ]


@internal
def list_of_rows(places: Places) -> int:
    """Which equations another one has something in common with, up to c."""
    return list_of_coefficients(places) + places[N]
