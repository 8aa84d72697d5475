"""Loops over any tree by its inverse dynamics, one call a velocity: beside links that bend, followers, massless struts.

Inverse dynamics are linear in accelerations: what they give beyond those of none is a column of the mass matrix, and what the
rows of the bodies then hold is a column of the frames' twists. Unit accelerations are made large, so that nothing cancels. O(n²)
in the tree.

J M⁻¹ Jᵀ is made with M + s JᵀJ in place of M: the same motions in the loops (J q̈ is given there, and s Jᵀ times it goes to the
right), and positive definite too where a strut has no mass of its own.
"""

from __future__ import annotations

from typing import Any

from harness.denoc.compiling.compiled import allocating, internal
from harness.denoc.loops import places as at_
from harness.denoc.loops.conditions import accelerate_frames, evaluate, place_frames
from harness.denoc.loops.elimination import cholesky, dot, group_end, solve_lower, solve_upper
from harness.denoc.loops.tables import (
    ACCELERATION,
    CONDITIONS,
    COUPLED,
    FIRST,
    KIND,
    LOOPS,
    OF,
    RATE,
    TWIST,
    N,
)
from harness.denoc.recursion.binding import BODIES, INVERSE, header_at
from harness.denoc.recursion.dynamics_call import call
from harness.denoc.recursion.rows import PARENT, POSITION, REACH

Places = Any
Numbers = Any
Rows = Any
Topology = Any
Vector = Any

# Unit accelerations: gravity and velocities are nothing beside them.
_LARGE = 1e8
# Entries of the mass matrix from here on are joints that dry friction locks.
_LOCKED = 1e20
# Square of a row over that of the longest of its kind up to which it says nothing.
_VANISHED = 1e-12


@allocating
def linearise(
    places: Places, x: Numbers, tree: int, d: Rows, t: Topology, q: int, qd: int, v: Vector, qv: Vector
) -> int:
    """Mass matrix, opposing forces (vector 1), the frames' twists by velocity, and the conditions with accelerations zero.

    tree: header address; q, qd: addresses of the state, v, qv: the same as vectors.
    """
    n = places[N]
    base = x.ctypes.data
    header = header_at(tree)
    asked, opposing, made = at_.vector(places, 0), at_.vector(places, 1), at_.vector(places, 2)
    for i in range(n):
        x[asked + i] = 0.0
    status = call(header[INVERSE], tree, q, qd, base + 8 * asked, base + 8 * opposing)
    if status != 0:
        return status
    for i in range(1, header[BODIES] + 1):
        p = t[i, PARENT]
        for k in range(3):
            d[i, POSITION + k] = d[p, POSITION + k] + d[i, REACH + k]
    # Velocities are not known yet; origins and accelerations are.
    place_frames(places, x, d)
    matrix = at_.mass(places)
    for j in range(n):
        for f in range(2 * places[LOOPS]):
            for k in range(6):
                x[at_.twists(places, f) + k * n + j] = -x[at_.moving(places, f) + RATE + k]
    for j in range(n):
        x[asked + j] = _LARGE
        status = call(header[INVERSE], tree, q, qd, base + 8 * asked, base + 8 * made)
        x[asked + j] = 0.0
        if status != 0:
            return status
        for i in range(n):
            x[matrix + i * n + j] = (x[made + i] - x[opposing + i]) / _LARGE
        accelerate_frames(places, x, d)
        for f in range(2 * places[LOOPS]):
            for k in range(6):
                at = at_.twists(places, f) + k * n + j
                x[at] = (x[at] + x[at_.moving(places, f) + RATE + k]) / _LARGE
    call(header[INVERSE], tree, q, qd, base + 8 * asked, base + 8 * opposing)
    place_frames(places, x, d)
    for f in range(2 * places[LOOPS]):
        for k in range(6):
            value = 0.0
            for j in range(n):
                value += x[at_.twists(places, f) + k * n + j] * v[j]
            x[at_.moving(places, f) + TWIST + k] = value
    evaluate(places, x, qv, v, x[asked : asked + n])
    return 0


@internal
def jacobian_row(places: Places, x: Numbers, k: int, out: int) -> None:
    """Row k of the conditions' Jacobian to x[out:out + n]."""
    n = places[N]
    here, s = at_.condition(places, k), at_.state(places, k)
    of = places[here + OF]
    for j in range(n):
        x[out + j] = 0.0
    if places[here + KIND] == COUPLED:
        coupled = at_.coupling(places, of)
        x[out + places[coupled + 1]] += 1.0
        if places[coupled + 3] >= 0:
            x[out + places[coupled + 3]] -= x[s + FIRST]
        return
    for side in range(2):
        for c in range(6):
            weight = x[s + FIRST + 6 * side + c]
            if weight != 0.0:
                at = at_.twists(places, 2 * of + side) + c * n
                for j in range(n):
                    x[out + j] += weight * x[at + j]


@internal
def factor(places: Places, x: Numbers) -> int:
    """Cholesky factor of M + s JᵀJ in place of M; Jᵀ times s times the accelerations that conditions ask, to vector 3."""
    n = places[N]
    matrix, extra = at_.mass(places), at_.vector(places, 3)
    scale = 0.0
    for i in range(n):
        own = x[matrix + i * n + i]
        if own < _LOCKED:
            scale = max(scale, own)
        x[extra + i] = 0.0
    first = 0
    while first < places[CONDITIONS]:
        last = group_end(places, first)
        longest = 0.0
        for k in range(first, last):
            jacobian_row(places, x, k, at_.row(places, k))
            longest = max(longest, dot(x, at_.row(places, k), at_.row(places, k), n))
        for k in range(first, last):
            j = at_.row(places, k)
            length = dot(x, j, j, n)
            # A row that vanishes at a singular position is rounding: made long, it would hold what nothing holds.
            if length <= _VANISHED * longest:
                continue
            weight = scale / length
            for i in range(n):
                x[extra + i] -= weight * x[j + i] * x[at_.state(places, k) + ACCELERATION]
                for l in range(n):
                    x[matrix + i * n + l] += weight * x[j + i] * x[j + l]
        first = last
    return cholesky(x, matrix, n)


@internal
def equations(places: Places, x: Numbers, which: int, have: int) -> None:
    """Rows L⁻¹ Jᵀ; right-hand sides, minus number ``which`` of each condition's state; with ``have`` ≥ 0 minus J x[have:] too."""
    n = places[N]
    for k in range(places[CONDITIONS]):
        out = at_.row(places, k)
        jacobian_row(places, x, k, out)
        right = -x[at_.state(places, k) + which]
        if have >= 0:
            right -= dot(x, out, have, n)
        solve_lower(x, at_.mass(places), n, out)
        x[out + n] = right


@internal
def accelerations(places: Places, x: Numbers, tau: Vector) -> int:
    """Accelerations without constraint forces to vector 4, once the mass matrix is factored."""
    n = places[N]
    free = at_.vector(places, 4)
    for i in range(n):
        x[free + i] = tau[i] - x[at_.vector(places, 1) + i] + x[at_.vector(places, 3) + i]
    solve_lower(x, at_.mass(places), n, free)
    solve_upper(x, at_.mass(places), n, free)
    return free


@internal
def add(places: Places, x: Numbers, z: int, out: Vector) -> None:
    """Add the solution z at x[z:], which is overwritten, to ``out``."""
    n = places[N]
    solve_upper(x, at_.mass(places), n, z)
    for i in range(n):
        out[i] += x[z + i]
