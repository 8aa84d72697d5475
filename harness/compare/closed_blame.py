"""Which term is to blame where closed mechanisms accelerate differently: their accelerations are not free to be asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from harness.engines.protocol import EngineModel
from harness.system.description import Array

# In this order: what answers forces wrongly answers weight and motion wrongly too.
WORDS = {
    "mass_matrix": "the answer to forces differs: a mass, an inertia, or how loops pass forces on",
    "bias": "what opposes the forces differs: weight and the forces of motion alike",
    "gravity": "what it does at rest without forces differs: weight, springs or how loops pass them on",
    "coriolis": "what is of the square of velocities differs: Coriolis forces, or the rate at which loops turn",
    "damping": "what is of the sign of velocities differs: damping or friction",
}


@dataclass(frozen=True)
class ClosedBlame:
    """The term, and in words; no term where the accelerations agree."""

    term: str = ""
    words: str = ""


def blame_closed(
    reference: EngineModel, other: EngineModel, q: Array, qd: Array, tau: Array, *, allowed: float
) -> ClosedBlame:
    """By what they hang on, the accelerations of ``other`` are not those of ``reference``.

    q, qd, tau: states that loops are closed at, each (B, n). allowed: relative, of the largest acceleration of a state. Loops
    that are at rest, or move the other way, are closed too.
    """
    ours, theirs = _parts(reference, q, qd, tau), _parts(other, q, qd, tau)
    size = np.max([np.abs(part).max(axis=1) for part in ours.values()], axis=0)
    off = [term for term, part in ours.items() if not (np.abs(part - theirs[term]).max(axis=1) <= allowed * size).all()]
    if not off:
        return ClosedBlame()
    if "mass_matrix" not in off and {"gravity", "coriolis"} <= set(off):
        return ClosedBlame("bias", WORDS["bias"])
    return ClosedBlame(off[0], WORDS[off[0]])


def _parts(model: EngineModel, q: Array, qd: Array, tau: Array) -> dict[str, Array]:
    """Accelerations by what they are of, each (B, n)."""

    def asked(way: float, force: float) -> Array:
        pairs = zip(q, way * qd, force * tau, strict=True)
        return np.array([model.forward_dynamics(*state) for state in pairs])

    rest, forwards, backwards = asked(0.0, 0.0), asked(1.0, 0.0), asked(-1.0, 0.0)
    return {
        "mass_matrix": asked(0.0, 1.0) - rest,
        "gravity": rest,
        "coriolis": 0.5 * (forwards + backwards) - rest,
        "damping": 0.5 * (forwards - backwards),
    }
