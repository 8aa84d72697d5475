"""The shortest solution of a few equations: rows made orthogonal, those that say nothing new left out.

Equations y_k · z = r_k in coordinates where the mass matrix is the identity: the shortest z is what constraint forces add to the
free acceleration (Gauss's principle), and the span of the rows is theirs; what is orthogonal to it is the loops' natural
orthogonal complement. Rows are orthogonalised by Gram and Schmidt, twice for rounding; where that shows that rows depend on one
another, by one-sided Jacobi rotations, which reveal the rank and treat all equations alike (Demmel and Veselić, Jacobi's method
is more accurate than QR, SIAM J. Matrix Anal. Appl. 13 (1992)).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.denoc.compiling.compiled import internal
from harness.denoc.loops.places import condition, copy, list_of_coefficients, list_of_rows, row
from harness.denoc.loops.tables import CONDITIONS, KIND, OF, RANK, N

Places = Any
Numbers = Any

# What is left of a row of length one below which rows are taken to depend on one another.
_DEPENDENT = 1e-3
# Times as many coefficients as a row has, that there are in all: from here on they are worth a list.
_FEW = 4
# Of rows made orthogonal, the longest that is left out, relative to the longest of all: it is rounding.
NOTHING = 1e-11
# Next to a singular position, where a row vanishes, rounding of positions turns the motion that is lost there into the wrong way
# out of it: on from here what the row asks is let go, smoothly, as integrators of high order want it.
_FADING = 5e-6
_SWEEPS = 30
_ROUNDING = 1e-14


@internal
def dot(x: Numbers, a: int, b: int, n: int) -> float:
    """The scalar product of the n numbers at x[a:] and at x[b:]."""
    total = 0.0
    for i in range(n):
        total += x[a + i] * x[b + i]
    return total


@internal
def shortest(places: Places, x: Numbers, out: int, least: float) -> int:
    """The shortest solution to x[out:out + n]; the rows are overwritten. Returns the number of independent equations.

    least: rows that are shorter, relative to the longest, are left out.
    """
    c, n = places[CONDITIONS], places[N]
    _scale(places, x)
    for k in range(c):
        for i in range(n + 1):
            x[copy(places, k) + i] = x[row(places, k) + i]
    if places[RANK] >= c and _gram_schmidt(places, x, max(_DEPENDENT, least)):
        return _sum_of_all(places, x, out)
    for k in range(c):
        for i in range(n + 1):
            x[row(places, k) + i] = x[copy(places, k) + i]
    _jacobi(places, x)
    return _sum(places, x, out, least)


@internal
def group_end(places: Places, first: int) -> int:
    """Behind the last of the conditions that are of one loop and one kind with ``first``, so that their rows can be compared."""
    here, last = condition(places, first), first + 1
    while (
        last < places[CONDITIONS]
        and places[condition(places, last) + KIND] == places[here + KIND]
        and places[condition(places, last) + OF] == places[here + OF]
    ):
        last += 1
    return last


@internal
def _scale(places: Places, x: Numbers) -> None:
    """Make the longest row of the shifts, and of the turns, of every loop as long as one.

    Not every row: one that vanishes at a singular position is to be seen to.
    """
    c, n = places[CONDITIONS], places[N]
    first = 0
    while first < c:
        last = group_end(places, first)
        longest = 0.0
        for k in range(first, last):
            longest = max(longest, dot(x, row(places, k), row(places, k), n))
        scale = 1.0 / np.sqrt(longest) if longest > 1e-300 else 0.0
        for k in range(first, last):
            for i in range(n + 1):
                x[row(places, k) + i] *= scale
        first = last


@internal
def _normalise(x: Numbers, at: int, n: int) -> None:
    length = np.sqrt(dot(x, at, at, n))
    scale = 1.0 / length if length > 1e-150 else 0.0
    for i in range(n + 1):
        x[at + i] *= scale


@internal
def _gram_schmidt(places: Places, x: Numbers, least: float) -> bool:
    """Make rows orthogonal, of length one; False where less than ``least`` is left of one.

    A cut moves the joints of its own loop alone: of many loops most rows have nothing in common, which the few coefficients that
    a row has tell. What a row has nothing of it need not be freed of a second time either.
    """
    n = places[N]
    has, met = list_of_coefficients(places), list_of_rows(places)
    for k in range(places[CONDITIONS]):
        at, stated = row(places, k), copy(places, k)
        count = 0
        for i in range(n):
            if x[stated + i] != 0.0:
                x[has + count] = i
                count += 1
        few = _FEW * count < n
        meets = 0
        for j in range(k):
            before = row(places, j)
            share = 0.0
            if few:
                for i in range(count):
                    place = int(x[has + i])
                    share += x[stated + place] * x[before + place]
            else:
                share = dot(x, stated, before, n)
            if share != 0.0:
                x[met + meets] = j
                meets += 1
                for i in range(n + 1):
                    x[at + i] -= share * x[before + i]
        for m in range(meets):
            before = row(places, int(x[met + m]))
            share = dot(x, at, before, n)
            for i in range(n + 1):
                x[at + i] -= share * x[before + i]
        if not dot(x, at, at, n) > least * least:
            return False
        _normalise(x, at, n)
    return True


@internal
def _sum_of_all(places: Places, x: Numbers, out: int) -> int:
    """Σ r_k y_k over rows that are orthogonal and of length one."""
    c, n = places[CONDITIONS], places[N]
    for i in range(n):
        x[out + i] = 0.0
    for k in range(c):
        at = row(places, k)
        for i in range(n):
            x[out + i] += x[at + n] * x[at + i]
    return c


@internal
def _jacobi(places: Places, x: Numbers) -> None:
    """Turn pairs of equations into one another until all rows are orthogonal."""
    c, n = places[CONDITIONS], places[N]
    for _ in range(_SWEEPS):
        turned = False
        for j in range(c):
            for k in range(j + 1, c):
                a, b = row(places, j), row(places, k)
                aa, bb, ab = dot(x, a, a, n), dot(x, b, b, n), dot(x, a, b, n)
                if abs(ab) <= _ROUNDING * np.sqrt(aa * bb) or ab == 0.0:
                    continue
                turned = True
                zeta = (bb - aa) / (2.0 * ab)
                tangent = 1.0 / (abs(zeta) + np.sqrt(1.0 + zeta * zeta))
                if zeta < 0.0:
                    tangent = -tangent
                cosine = 1.0 / np.sqrt(1.0 + tangent * tangent)
                sine = cosine * tangent
                for i in range(n + 1):
                    one, other = x[a + i], x[b + i]
                    x[a + i], x[b + i] = cosine * one - sine * other, sine * one + cosine * other
        if not turned:
            return


@internal
def _sum(places: Places, x: Numbers, out: int, least: float) -> int:
    """Σ r_k y_k / |y_k|² over the longest rows, RANK of them at most."""
    c, n = places[CONDITIONS], places[N]
    for i in range(n):
        x[out + i] = 0.0
    longest = 0.0
    for k in range(c):
        longest = max(longest, dot(x, row(places, k), row(places, k), n))
    used = 0
    while used < places[RANK]:
        best, found = 0.0, -1
        for k in range(c):
            length = dot(x, row(places, k), row(places, k), n)
            if length > best:
                best, found = length, k
        if found < 0 or best <= least * least * longest:
            break
        at = row(places, found)
        share = x[at + n] / best / (1.0 + (_FADING * _FADING * longest / best) ** 4)
        for i in range(n):
            x[out + i] += share * x[at + i]
            # Used up.
            x[at + i] = 0.0
        used += 1
    return used


@internal
def cholesky(x: Numbers, at: int, n: int) -> int:
    """Factor L of a symmetric matrix at x[at:], in its lower half; 0, or one more than where it is not positive."""
    for j in range(n):
        pivot = x[at + j * n + j]
        for k in range(j):
            pivot -= x[at + j * n + k] ** 2
        if not pivot > 0.0:
            return j + 1
        pivot = np.sqrt(pivot)
        x[at + j * n + j] = pivot
        for i in range(j + 1, n):
            value = x[at + i * n + j]
            for k in range(j):
                value -= x[at + i * n + k] * x[at + j * n + k]
            x[at + i * n + j] = value / pivot
    return 0


@internal
def solve_lower(x: Numbers, at: int, n: int, b: int) -> None:
    """L⁻¹ b in place at x[b:]."""
    for i in range(n):
        value = x[b + i]
        for k in range(i):
            value -= x[at + i * n + k] * x[b + k]
        x[b + i] = value / x[at + i * n + i]


@internal
def solve_upper(x: Numbers, at: int, n: int, b: int) -> None:
    """L⁻ᵀ b in place at x[b:]."""
    for i in range(n - 1, -1, -1):
        value = x[b + i]
        for k in range(i + 1, n):
            value -= x[at + k * n + i] * x[b + k]
        x[b + i] = value / x[at + i * n + i]
