"""A joint law of its own as a function at an address, which the recursions of the lanes call.

That of teeth with play belongs to the catalogue and is kept on disk like the recursions; one of the user's is compiled once a
process.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from numba import carray, cfunc, njit, types

Law = Callable[..., float]

_SIGNATURE = types.float64(types.float64, types.float64, types.float64, types.CPointer(types.float64))


def teeth(position: float, velocity: float, time: float, p: Any) -> float:
    """Torque of teeth with play: nothing within ±p[0], beyond it stiffness p[1] and damping p[2], which never pulls.

    Damping sets in over half a hundredth of half the play, so that the torque has no jump for the integrator to stumble over.
    """
    beyond = abs(position) - p[0]
    if beyond <= 0.0:
        return 0.0
    side = 1.0 if position > 0.0 else -1.0
    share = min(beyond / max(0.005 * p[0], 1e-6), 1.0)
    push = p[1] * beyond + p[2] * share * side * velocity
    return -side * max(push, 0.0)


def servo(position: float, velocity: float, time: float, p: Any) -> float:
    """Force of a drive with feedback: offset p[0] less stiffness p[1] · position and damping p[2] · velocity, within ± p[3]."""
    return min(max(p[0] - p[1] * position - p[2] * velocity, -p[3]), p[3])


def commanded_servo(position: float, velocity: float, time: float, p: Any) -> float:
    """The same of a drive whose command is recorded: its force beyond the effort p[4] that the command asks for by itself."""
    return min(max(p[4] + p[0] - p[1] * position - p[2] * velocity, -p[3]), p[3]) - p[4]


@functools.lru_cache(maxsize=64)
def compiled_law(law: Law) -> Any:
    """A law ``(q, qd, t, p) -> force`` of four parameters p as plain code, for as long as what is returned: its ``address``."""
    if law is teeth:
        return _teeth()
    return _own(law, 5 if law is commanded_servo else 4)


def _own(function: Law, size: int) -> Any:
    law = function if hasattr(function, "py_func") else njit(function)

    def call(q: float, qd: float, t: float, pointer: Any) -> float:
        return law(q, qd, t, carray(pointer, size))

    return cfunc(_SIGNATURE)(call)


_teeth_law = njit(teeth)


# It uses names at module level alone: a function that closes over another is never found in the cache again.
def _teeth() -> Any:
    @cfunc(_SIGNATURE, cache=True)
    def teeth_at(q: float, qd: float, t: float, pointer: Any) -> float:
        return _teeth_law(q, qd, t, carray(pointer, (4,)))

    return teeth_at
