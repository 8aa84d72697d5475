"""Which term is to blame where two engines accelerate alike and one answer alone differs.

The answer is taken apart by what it hangs on: inverse dynamics asked at rest, in motion forwards and backwards and with a
unit of acceleration at one joint after the other gives the weight, the Coriolis force, the damping and the mass matrix that
its own recursion has, whatever the other answers of the engine are. Energy hangs on the mass matrix by the squares and products of
velocities, and on weight and springs by its slope; momentum on the inertia that each joint carries.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.compare.attribution import TERMS, Blame, Parts, at_joint, blame_force, blame_mass, term_difference
from harness.engines.protocol import EngineModel
from harness.system.description import Array

STATES = 4  # looked at: what is constant over them is an armature
# Central difference of order 6 of the potential energy, how far it is moved [rad or m], and what that leaves.
_WEIGHTS, _STEP, _SLOPES = (45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0), 0.01, 1e-8


def blame_answer(
    quantity: str, reference: EngineModel, other: EngineModel, q: Array, qd: Array, *, allowed: float = 1e-10
) -> Blame | None:
    """The term in which ``other`` answers otherwise than ``reference`` at B states, None where it cannot be told.

    quantity: ``inverse_dynamics``, ``mass_matrix``, ``bias``, ``gravity`` or ``energy``. q, qd: shape (B, n). allowed: as for
    ``attribute``.
    """
    if quantity not in _TAKEN_APART:
        return None
    names = reference.names
    if quantity == "energy" and (said := _no_energy(other, q[0], qd[0])):
        return Blame("energy", 1.0, 1.0, "", said)
    take = _TAKEN_APART[quantity]
    ours, theirs = (take(model, q[:STATES], qd[:STATES]) for model in (reference, other))
    if quantity == "energy":
        allowed = max(allowed, _SLOPES)
    opposing = [term_difference(term, ours, theirs) for term in ("coriolis", "gravity")]
    for term in TERMS:
        differs = term_difference(term, ours, theirs)
        if not differs > allowed:
            continue
        if term == "coriolis" and min(opposing) > allowed:
            return blame_opposing(names, ours, theirs, allowed, max(opposing))
        if term == "mass_matrix":
            return blame_mass(names, ours, theirs, allowed, differs, 1.0)
        blame = blame_force(term, names, ours, theirs, allowed, differs, 1.0)
        if quantity in ("inverse_dynamics", "energy") and term == "gravity" and _sprung(reference, q[:STATES]):
            if _of_springs(q[:STATES], ours, theirs, allowed):
                return blame_force("stiffness", names, *_as_springs(ours, theirs), allowed, differs, 1.0)
            return weight_or_spring(blame)
        asked = _inverse_dynamics if quantity == "inverse_dynamics" else _bias
        return at_joint(blame, reference, other, q[0], asked) if term == "coriolis" else blame
    return None


def blame_opposing(names: tuple[str, ...], ours: Parts, theirs: Parts, allowed: float, differs: float) -> Blame:
    """Weight and the forces of motion are wrong alike, while the mass matrix is right."""
    one, other = (replace(parts, coriolis=parts.coriolis + parts.gravity) for parts in (ours, theirs))
    blame = blame_force("coriolis", names, one, other, allowed, differs, 1.0)
    words = blame.words.replace(
        "the Coriolis and centrifugal force", "what opposes, weight and forces of motion alike,"
    )
    return replace(blame, term="bias", words=words)


def _no_energy(model: EngineModel, q: Array, qd: Array) -> str:
    """Said of a kinetic energy that does not go with the square of velocities, and of another that hangs on them."""
    still, once, twice = (model.energy(q, way * qd) for way in (0.0, 1.0, 2.0))
    if abs(still[0]) > 1e-9 * abs(once[0]) or abs(twice[0] - 4.0 * once[0]) > 1e-9 * abs(twice[0]):
        return "what it calls kinetic energy does not go with the square of velocities"
    if abs(once[1] - still[1]) > 1e-9 * (abs(still[1]) + abs(once[0])):
        return "what it calls potential energy hangs on velocities"
    return ""


def weight_or_spring(blame: Blame) -> Blame:
    """What is blamed on gravity where weight and springs are known together alone."""
    return replace(blame, term="gravity_or_stiffness", words=blame.words.replace("gravity", "gravity or a spring"))


def _sprung(model: EngineModel, q: Array) -> bool:
    """Whether springs hold the mechanism beside its weight: by what drives it from rest, not by the answers that may be wrong."""
    still = np.zeros(len(model.names))
    weight = np.array([model.gravity(x) for x in q])
    driven = np.array([model.mass_matrix(x) @ model.forward_dynamics(x, still, still) for x in q])
    return bool(np.abs(driven + weight).max() > _SLOPES * np.abs(weight).max())


def _of_springs(q: Array, ours: Parts, theirs: Parts, allowed: float) -> bool:
    """Whether what differs at rest is in proportion to the position of the coordinate it is at, or constant where weight is not.

    So do springs; a weight hangs on the positions of others too.
    """
    apart = theirs.gravity - ours.gravity
    if q.shape != apart.shape or len(q) < STATES:
        return False
    for k in np.flatnonzero(np.abs(apart).max(axis=0) > allowed * np.abs(ours.gravity).max()):
        course = np.column_stack([np.ones(len(q)), q[:, k]])
        left = apart[:, k] - course @ np.linalg.lstsq(course, apart[:, k], rcond=None)[0]
        weight = ours.gravity[:, k]
        if np.abs(left).max() > 1e-6 * np.abs(apart[:, k]).max() or np.ptp(weight) <= 1e-3 * np.abs(weight).max():
            return False
    return True


def _as_springs(ours: Parts, theirs: Parts) -> tuple[Parts, Parts]:
    """What acts at rest put where springs stand, on the right-hand side."""
    one, other = (replace(parts, stiffness=-parts.gravity) for parts in (ours, theirs))
    return one, other


def _inverse_dynamics(model: EngineModel, q: Array, qd: Array, qdd: Array | None = None) -> Array:
    return np.asarray(model.inverse_dynamics(q, qd, np.zeros_like(qd) if qdd is None else qdd))


def _bias(model: EngineModel, q: Array, qd: Array) -> Array:
    return np.asarray(model.bias(q, qd))


def _of_inverse_dynamics(model: EngineModel, q: Array, qd: Array) -> Parts:
    parts = []
    for x, v in zip(q, qd, strict=True):
        held = _inverse_dynamics(model, x, 0.0 * v)
        forwards, backwards = (_inverse_dynamics(model, x, way * v) - held for way in (1.0, -1.0))
        columns = [_inverse_dynamics(model, x, 0.0 * v, unit) - held for unit in np.eye(len(v))]
        # Springs act at rest as weight does, and stand in it.
        parts.append(
            (np.array(columns).T, 0.5 * (forwards + backwards), held, 0.5 * (backwards - forwards), np.zeros_like(v))
        )
    return _parts(parts, qd)


def _of_bias(model: EngineModel, q: Array, qd: Array) -> Parts:
    still = [_bias(model, x, 0.0 * v) for x, v in zip(q, qd, strict=True)]
    moving = [_bias(model, x, v) for x, v in zip(q, qd, strict=True)]
    none = np.zeros_like(qd[0])
    return _parts([(np.eye(len(none)), m - s, s, none, none) for m, s in zip(moving, still, strict=True)], qd)


def _of_mass_matrix(model: EngineModel, q: Array, qd: Array) -> Parts:
    none = np.zeros_like(qd[0])
    return _parts([(np.asarray(model.mass_matrix(x)), none, none, none, none) for x in q], qd)


def _of_gravity(model: EngineModel, q: Array, qd: Array) -> Parts:
    none = np.zeros_like(qd[0])
    return _parts([(np.eye(len(none)), none, np.asarray(model.gravity(x)), none, none) for x in q], qd)


def _parts(rows: list[tuple[Array, Array, Array, Array, Array]], qd: Array) -> Parts:
    mass, coriolis, gravity, damping, stiffness = (np.array(column) for column in zip(*rows, strict=True))
    return Parts(mass, coriolis, gravity, damping, stiffness, np.zeros_like(qd[: len(rows)]))


def _of_energy(model: EngineModel, q: Array, qd: Array) -> Parts:
    n = qd.shape[1]
    units, none = np.eye(n), np.zeros(n)
    rows = []
    for x in q:
        single = np.array([model.energy(x, unit)[0] for unit in units])
        mass = np.diag(2.0 * single)
        for i in range(n):
            for j in range(i):
                mass[i, j] = mass[j, i] = model.energy(x, units[i] + units[j])[0] - single[i] - single[j]
        slope = np.zeros(n)
        # Positions on a manifold have no differences of their own: there the kinetic energy alone is looked at.
        if len(x) == n:
            for k, unit in enumerate(units):
                rises = (
                    model.energy(x + (j + 1) * _STEP * unit, none)[1]
                    - model.energy(x - (j + 1) * _STEP * unit, none)[1]
                    for j in range(3)
                )
                slope[k] = sum(weight * rise for weight, rise in zip(_WEIGHTS, rises, strict=True)) / _STEP
        rows.append((mass, none, slope, none, none))
    return _parts(rows, qd)


def blame_momentum(names: tuple[str, ...], ours: Array, theirs: Array, allowed: float) -> tuple[str, dict[str, object]]:
    """Where momenta by unit velocities, angular then linear, (B, 6, n), differ: the outermost joint whose own does, and in what.

    A body's inertia is in the momentum of every joint that carries it, so that it is at the last of them.
    """
    size = np.maximum(np.abs(ours).max(axis=(0, 2)), 1e-300)
    apart = np.abs(theirs - ours).max(axis=0) / size[:, None]
    far = np.flatnonzero(apart.max(axis=0) > allowed)
    if not len(far):
        return "", {}
    place = names[far[-1]]
    linear = bool((apart[3:, far] > allowed).any())
    what = "mass, its place or its speed" if linear else "inertia, or what it is taken about"
    words = f"momentum differs by what {place} carries: {what}"
    return words, {"term": "momentum", "at": place, "part": "linear" if linear else "angular"}


_TAKEN_APART = {
    "energy": _of_energy,
    "inverse_dynamics": _of_inverse_dynamics,
    "mass_matrix": _of_mass_matrix,
    "bias": _of_bias,
    "gravity": _of_gravity,
}
