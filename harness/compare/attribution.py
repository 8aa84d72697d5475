"""Which term of the dynamics is to blame when two engines accelerate differently.

The equation of motion is taken apart, M q'' = τ + damping + stiffness - Coriolis - gravity, in both engines through the
questions that every engine answers, and each term of one is put into the other's equation: what that changes in the
acceleration is the term's share. A body's mass and inertia show in the mass matrix, in the Coriolis force and in gravity
at once; then the mass matrix is named, because the others follow from it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.compare import quantities
from harness.engines.protocol import EngineModel

Array = NDArray[np.float64]

TERMS = ("mass_matrix", "coriolis", "gravity", "damping", "stiffness")


@dataclass(frozen=True)
class Blame:
    """One term's part in a disagreement.

    term: one of ``TERMS``, ``armature`` (a constant on the mass matrix's diagonal alone), or ``solution`` (an engine does
        not solve its own equation).
    difference: of the term itself, relative. share: of the acceleration's difference that it causes, about 1 if all.
    coordinate: where the term differs most. words: what kind of difference it is.
    """

    term: str
    difference: float
    share: float
    coordinate: str
    words: str


@dataclass(frozen=True)
class Attribution:
    """Why two engines accelerate differently.

    difference: of the accelerations, relative, in the mass matrix's norm, the largest over the states.
    blames: every term that differs, the cause first, then by share; empty if the engines agree.
    """

    difference: float
    allowed: float
    blames: tuple[Blame, ...]

    @property
    def culprit(self) -> Blame | None:
        return self.blames[0] if self.blames else None

    def sentence(self) -> str:
        """For a table."""
        if self.difference <= self.allowed:
            return "the accelerations agree"
        if not self.blames:
            return f"the accelerations differ by {self.difference:.1e}, and no term of the dynamics does"
        blame = self.blames[0]
        with_it = ", ".join(other.term.replace("_", " ") for other in self.blames[1:])
        return blame.words + (f" (with it: {with_it})" if with_it else "")


@dataclass(frozen=True, eq=False)
class Parts:
    """The terms at B states: mass (B, n, n); the others (B, n), damping and stiffness on the right-hand side."""

    mass: Array
    coriolis: Array
    gravity: Array
    damping: Array
    stiffness: Array
    acceleration: Array

    def with_term(self, term: str, other: Parts, tau: Array) -> Array:
        """Accelerations of this engine with one term taken from the other, shape (B, n)."""
        mass = other.mass if term == "mass_matrix" else self.mass
        coriolis, gravity, damping, stiffness = (getattr(other if term == name else self, name) for name in TERMS[1:])
        right = tau + damping + stiffness - coriolis - gravity
        return np.linalg.solve(mass, right[:, :, None])[:, :, 0]


def take_apart(model: EngineModel, q: Array, qd: Array, tau: Array) -> Parts:
    """The terms of the dynamics of an engine at B states, each shape (B, n)."""
    mass, gravity, bias, moving, held, acceleration = [], [], [], [], [], []
    for k in range(len(q)):
        still = np.zeros_like(qd[k])
        mass.append(model.mass_matrix(q[k]))
        gravity.append(model.gravity(q[k]))
        bias.append(model.bias(q[k], qd[k]))
        moving.append(model.inverse_dynamics(q[k], qd[k], still))
        held.append(model.inverse_dynamics(q[k], still, still))
        acceleration.append(model.forward_dynamics(q[k], qd[k], tau[k]))
    coriolis = np.array(bias) - np.array(gravity)
    stiffness = np.array(gravity) - np.array(held)
    return Parts(
        mass=np.array(mass),
        coriolis=coriolis,
        gravity=np.array(gravity),
        damping=np.array(bias) - np.array(moving) - stiffness,
        stiffness=stiffness,
        acceleration=np.array(acceleration),
    )


def attribute(
    reference: EngineModel,
    other: EngineModel,
    q: Array,
    qd: Array,
    tau: Array,
    *,
    allowed: float = 1e-9,
    called: tuple[str, str] = ("the reference engine", "the other engine"),
    derived: bool = False,
) -> Attribution:
    """Which term makes ``other`` accelerate differently from ``reference`` at B states.

    q, qd, tau: shape (B, n), several states in general position. allowed: relative difference that counts as
    agreement, of the accelerations and of each term. called: how the two engines are named. derived: the terms of ``other`` are
    worked out from its accelerations alone, so that forces which count otherwise look like every term scaled.
    """
    names = reference.names
    ours, theirs = take_apart(reference, q, qd, tau), take_apart(other, q, qd, tau)
    difference = float(quantities.accelerations(ours.mass, ours.acceleration, theirs.acceleration).max())
    if difference <= allowed:
        return Attribution(difference, allowed, ())
    counted = _counted(ours, theirs, allowed) if derived else None
    if counted is not None:
        words = f"as if the applied forces counted {counted:.6g} times"
        return Attribution(difference, allowed, (Blame("applied_force", abs(counted - 1.0), 1.0, "", words),))
    apart = theirs.acceleration - ours.acceleration
    solved = ours.with_term("", ours, tau)
    blames = []
    for term in TERMS:
        differs = term_difference(term, ours, theirs)
        if differs <= allowed:
            continue
        change = ours.with_term(term, theirs, tau) - solved
        share = _share(ours.mass, change, apart)
        if term == "mass_matrix":
            blames.append(blame_mass(names, ours, theirs, allowed, differs, share))
        else:
            blame = blame_force(term, names, ours, theirs, allowed, differs, share)
            blames.append(at_joint(blame, reference, other, q[0], _bias) if term == "coriolis" else blame)
    # An engine that does not solve its own equation: the recursion is wrong although every term is right.
    for label, parts in zip(called, (ours, theirs), strict=True):
        own = parts.with_term("", parts, tau)
        differs = float(quantities.accelerations(parts.mass, parts.acceleration, own).max())
        if differs > allowed:
            # What of each equation is not fulfilled, over the inertia there, so that radians and metres count alike.
            unmet = np.einsum("bij,bj->bi", parts.mass, parts.acceleration - own)
            unmet /= np.sqrt(np.diagonal(parts.mass, axis1=1, axis2=2))
            worst = int(np.argmax(np.abs(unmet).max(axis=0)))
            words = f"the forward dynamics of {label} does not solve its own equation of motion, most at {names[worst]}"
            change = parts.acceleration - own if parts is theirs else own - parts.acceleration
            blames.append(Blame("solution", differs, _share(parts.mass, change, apart), names[worst], words))
    blames.sort(key=lambda blame: (blame.term != "mass_matrix", -blame.share))
    return Attribution(difference, allowed, tuple(blames))


def _counted(ours: Parts, theirs: Parts, allowed: float) -> float | None:
    """How many times the applied forces count, where every term is that many times too small; else None."""
    factor = float(np.sum(ours.mass * theirs.mass) / np.sum(ours.mass**2))
    if not (abs(factor - 1.0) > allowed and factor > 0.0):
        return None
    tolerance = max(allowed, 1e-6)
    # Forces against all of them: one that is none is rounding.
    largest = max(float(np.abs(getattr(ours, name)).max()) for name in TERMS[1:])
    # Springs are taken as the other has them; what acts at rest has them in it.
    pairs = [(parts.coriolis, parts.damping, parts.gravity - parts.stiffness) for parts in (ours, theirs)]
    apart = [float(np.abs(b - factor * a).max()) for a, b in zip(*pairs, strict=True)]
    masses = float(np.abs(theirs.mass - factor * ours.mass).max() / np.abs(ours.mass).max())
    return 1.0 / factor if max(masses, *(x / largest for x in apart)) <= tolerance else None


def _bias(model: EngineModel, q: Array, qd: Array) -> Array:
    return np.asarray(model.bias(q, qd))


def at_joint(
    blame: Blame,
    reference: EngineModel,
    other: EngineModel,
    q: Array,
    force: Callable[[EngineModel, Array, Array], Array],
) -> Blame:
    """Which joint's motion a difference of the Coriolis force hangs on: that of all products of two velocities that differ.

    The force is quadratic, so that it is taken apart by moving two joints at a time: where it acts says little, since
    all joints below carry it. force: of a model at q and qd, with the Coriolis force in it.
    """
    n = len(reference.names)
    still = np.zeros(n)

    def velocity_force(model: EngineModel, qd: Array) -> Array:
        # What is the same forwards and backwards: damping is not.
        return 0.5 * (force(model, q, qd) + force(model, q, -qd)) - force(model, q, still)

    single = [velocity_force(other, unit) - velocity_force(reference, unit) for unit in np.eye(n)]
    differs = np.zeros((n, n))
    for i in range(n):
        differs[i, i] = np.abs(single[i]).max()
        for j in range(i):
            both = np.eye(n)[i] + np.eye(n)[j]
            apart = velocity_force(other, both) - velocity_force(reference, both) - single[i] - single[j]
            differs[i, j] = np.abs(apart).max()
    pairs = np.argwhere(differs > 1e-6 * differs.max(initial=0.0))
    common = [k for k in range(n) if all(k in pair for pair in pairs)]
    if not common or len(pairs) == 0:
        return blame
    # Of two that always move together the outer one: the inner one turns it, and is right about others.
    joint = reference.names[max(common)]
    return replace(blame, coordinate=joint, words=f"{blame.words}, where {joint} moves")


def term_difference(term: str, ours: Parts, theirs: Parts) -> float:
    if term == "mass_matrix":
        return float(quantities.mass_matrices(ours.mass, theirs.mass).max())
    a, b = getattr(ours, term), getattr(theirs, term)
    # Against all forces at the state, so that the rounding of a term that is nearly zero is not taken for a difference.
    size = sum(np.abs(getattr(parts, name)) for parts in (ours, theirs) for name in TERMS[1:])
    scale = np.maximum(size.max(axis=1), quantities.FLOOR * size.max(initial=0.0))
    apart = np.abs(a - b).max(axis=1)
    return float(np.max(np.where(apart == 0.0, 0.0, apart / np.where(scale > 0.0, scale, 1.0))))


def _share(mass: Array, change: Array, apart: Array) -> float:
    """Projection of the change on the whole difference, in the mass matrix's norm, over all states."""
    along = np.einsum("bi,bij,bj->", change, mass, apart)
    whole = np.einsum("bi,bij,bj->", apart, mass, apart)
    return float(along / whole) if whole > 0.0 else 0.0


def blame_mass(
    names: tuple[str, ...], ours: Parts, theirs: Parts, allowed: float, differs: float, share: float
) -> Blame:
    apart = quantities.entries(ours.mass, theirs.mass).max(axis=0)
    off_diagonal = (apart - np.diag(np.diagonal(apart))).max(initial=0.0)
    changed = np.flatnonzero(apart.max(axis=1) > allowed)
    change = np.diagonal(theirs.mass - ours.mass, axis1=1, axis2=2)
    constant = np.ptp(change, axis=0) <= 1e-6 * np.abs(change).max(axis=0) + allowed * np.abs(ours.mass).max()
    # One coordinate has no others to couple with, but there an armature and an inertia are the same thing.
    if off_diagonal <= allowed and constant[changed].all() and len(ours.mass) > 1:
        where = " and ".join(f"{names[k]} by {change[:, k].mean():+.3g}" for k in changed)
        return Blame("armature", differs, share, names[changed[-1]], f"the armature differs at {where}")
    # What hangs on a joint enters its own entry of the diagonal and those of all joints below it, which come earlier; what
    # is farther out has other entries beside the diagonal alone.
    own = np.flatnonzero(np.diagonal(apart) > allowed)
    carrier = names[(own if len(own) else changed)[-1]]
    words = f"the mass matrix differs: mass, inertia or place of what {carrier} carries"
    factor = float(np.sum(ours.mass * theirs.mass) / np.sum(ours.mass * ours.mass))
    if (
        len(names) > 1
        and np.abs(theirs.mass - factor * ours.mass).max() <= max(allowed, 1e-9) * np.abs(ours.mass).max()
    ):
        # Of all bodies alike: of no one of them.
        words = f"the mass matrix is {_times(factor)} times the reference's"
    return Blame("mass_matrix", differs, share, carrier, words)


def _times(factor: float) -> str:
    """A factor with as many digits as tell it from one."""
    return f"{factor:.{6 if abs(factor - 1.0) > 1e-4 else 12}g}"


def blame_force(
    term: str, names: tuple[str, ...], ours: Parts, theirs: Parts, allowed: float, differs: float, share: float
) -> Blame:
    a, b = getattr(ours, term), getattr(theirs, term)
    apart = np.abs(a - b).max(axis=0)
    worst = names[int(np.argmax(apart))]
    # Elastic coordinates are named after their link, `rod.mode1`.
    what = "the elastic stiffness" if term == "stiffness" and ".mode" in worst else _NAMES[term]
    return Blame(term, differs, share, worst, _words(what, names, a, b, apart, allowed))


def _words(what: str, names: tuple[str, ...], a: Array, b: Array, apart: Array, allowed: float) -> str:
    tolerance = max(allowed, 1e-9)
    square = float(np.sum(a * a))
    if np.abs(a).max() <= tolerance * np.abs(b).max():
        return f"{what} is missing in the reference, most at {names[int(np.argmax(apart))]}"
    factor = float(np.sum(a * b)) / square
    if np.max(np.abs(b - factor * a)) <= tolerance * np.max(np.abs(a)):
        if abs(factor) < tolerance:
            return f"{what} is missing"
        if abs(factor + 1.0) < tolerance:
            return f"{what} has the other sign"
        return f"{what} is {_times(factor)} times the reference's"
    changed = [name for name, far in zip(names, apart, strict=True) if far > tolerance * np.abs(a).max()]
    if len(changed) < len(names):
        return f"{what} differs at {' and '.join(changed)} alone"
    return f"{what} differs, most at {names[int(np.argmax(apart))]}"


_NAMES = {
    "coriolis": "the Coriolis and centrifugal force",
    "gravity": "gravity",
    "damping": "the damping",
    "stiffness": "the joint stiffness",
}
