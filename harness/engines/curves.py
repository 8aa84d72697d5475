"""Joints whose positions are polynomials of others' (``Coupling``), as functions of those that remain.

With velocities G(q) v of the tree's joints, G what the polynomials' slopes make of the independent ones, motions are integrated
over the independent joints alone: nothing drifts open.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.engines.checked import finite_result
from harness.engines.march import adaptive
from harness.engines.protocol import Array
from harness.engines.soft_motion import LONGEST_STEP, SoftJoints
from harness.system import Coupling, System


@dataclass(frozen=True, eq=False)
class Curves:
    """Couplings in a tree of nq positions and n velocities, of which m follow from others.

    couplings: in an order in which each follows from what is known by then. positions, velocities: where the joint and its
    leader (-1 for none) stand among them, (m, 2). free_positions, free_velocities: which are independent, (nq − m,) and (n − m,).
    """

    couplings: tuple[Coupling, ...]
    positions: NDArray[np.intp]
    velocities: NDArray[np.intp]
    free_positions: NDArray[np.intp]
    free_velocities: NDArray[np.intp]

    def position(self, y: Array, nq: int) -> Array:
        """Positions (nq,) of independent ones, (nq − m,)."""
        q = np.zeros(nq)
        q[self.free_positions] = y
        for coupling, (own, leader) in zip(self.couplings, self.positions, strict=True):
            q[own] = coupling.value(q[leader])[0] if leader >= 0 else coupling.coefficients[0]
        return q

    def basis(self, q: Array, n: int) -> Array:
        """G (n, n − m): velocities of all joints by those of the independent ones."""
        directions = np.zeros((n, len(self.free_velocities)))
        directions[self.free_velocities, range(len(self.free_velocities))] = 1.0
        for coupling, (own, leader), (_, at) in zip(self.couplings, self.velocities, self.positions, strict=True):
            if leader >= 0:
                directions[own] = coupling.value(q[at])[1] * directions[leader]
        return directions


def curves(system: System, couplings: tuple[Coupling, ...]) -> Curves:
    """Where the couplings stand in a system; they are in the order that ``harness.system.loop.explicit`` gives."""

    def places(names: tuple[str, ...]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        own = [[names.index(c.joint), -1 if c.leader is None else names.index(c.leader)] for c in couplings]
        table = np.array(own, dtype=np.intp).reshape(-1, 2)
        return table, np.array([k for k in range(len(names)) if k not in table[:, 0]], dtype=np.intp)

    positions, free_positions = places(system.position_names)
    velocities, free_velocities = places(system.coordinate_names)
    return Curves(couplings, positions, velocities, free_positions, free_velocities)


def march_along(
    curves: Curves,
    acceleration: Callable[[Array, Array, Array], Array],
    mass: Callable[[Array], Array],
    soft: SoftJoints | None,
    q0: Array,
    v0: Array,
    time: Array,
    tau: Array | None,
    rates: Callable[[Array, Array], Array] | None,
    *,
    step: float | None = None,
) -> tuple[Array, Array]:
    """Positions (T, nq) and velocities (T, n) at ``time`` [s] by DOP853, the couplings kept exactly.

    acceleration: (q, v, tau) -> accelerations (n,) of the coupled system. mass: its tree's. soft: limits and dry friction.
    tau: (T, n), held. rates: (q, v) -> rates of positions where those are not v. Raises EngineError where the motion cannot be
    followed.
    """
    nq, n, free = len(q0), len(v0), len(curves.free_positions)

    def whole(y: Array) -> tuple[Array, Array, Array]:
        q = curves.position(y[:free], nq)
        basis = curves.basis(q, n)
        return q, basis @ y[free:], basis

    def slope(y: Array, force: Array) -> Array:
        q, v, basis = whole(y)
        a = acceleration(q, v, force)
        if soft is not None:
            a = soft.acceleration(mass(q), a, q, v, basis)
        moving = v[curves.free_velocities] if rates is None else rates(q, v)[curves.free_positions]
        return np.concatenate([moving, finite_result("the run", "motion", a)[curves.free_velocities]])

    longest = min(step or np.inf, LONGEST_STEP if soft is not None else np.inf)
    start = np.concatenate([q0[curves.free_positions], v0[curves.free_velocities]])
    states = adaptive(slope, start, time, tau, np.zeros(n), rtol=1e-10, atol=1e-12, longest=longest)
    found = [whole(y)[:2] for y in states]
    return np.array([q for q, _ in found]), np.array([v for _, v in found])
