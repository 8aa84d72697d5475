"""Mechanisms part of whose weight is carried: at each body's centre of mass an upward force, a share of its own weight.

Such a force is that of gravity on a system of the same places, whose masses are the shares that are carried, with the other sign:
τ = g'(q), which the generalized forces are given. Source: MuJoCo's documentation, XML reference: body, gravcomp.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from harness.denoc.batch.results import apart, place_for
from harness.denoc.model import Array, Denoc
from harness.errors import UnsupportedError
from harness.system import System
from harness.system.description import constant


def carried(system: System, least: float = -np.inf) -> System:
    """The system that weighs what is carried of each link, shares from ``least`` on, and nothing else."""
    links = tuple(
        replace(link, mass=max(link.gravcomp, least) * link.mass, inertia=constant(np.zeros((3, 3))), gravcomp=0.0)
        for link in system.links
    )
    joints = tuple(
        replace(joint, armature=0.0, damping=0.0, friction=0.0, stiffness=0.0, rest_position=0.0)
        for joint in system.joints
    )
    return replace(system, links=links, joints=joints)


class Compensated(Denoc):
    """The equations of motion of a system with links of ``gravcomp``; what ``Denoc`` says holds, g(q) being the weight not carried.

    Raises UnsupportedError where a link bends. The eight-at-a-time kernels and the lanes do not know it.
    """

    __slots__ = ("_weight",)
    by_calls = True

    def __init__(self, system: System) -> None:
        if system.flexible:
            raise UnsupportedError(
                "gravity compensation of single links beside links that bend",
                mend="leave out gravcomp, or scale gravity",
                source=system.source,
            )
        super().__init__(system)
        self._weight = Denoc(carried(system))

    def forward_dynamics(
        self, q: Array, qd: Array, tau: Array | None = None, wrenches: ArrayLike | None = None
    ) -> Array:
        q = self.position("q", q)
        lifted = self._weight.gravity(q) + (0.0 if tau is None else self.vector("tau", tau))
        return super().forward_dynamics(q, qd, lifted, wrenches)

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array, wrenches: ArrayLike | None = None) -> Array:
        q = self.position("q", q)
        return np.asarray(super().inverse_dynamics(q, qd, qdd, wrenches) - self._weight.gravity(q))

    def bias(self, q: ArrayLike, qd: ArrayLike) -> Array:
        return np.asarray(super().bias(q, qd) - self._weight.bias(q, self._zero))

    def energies(self, Q: Array, Qd: Array) -> Array:
        out = super().energies(Q, Qd)
        out[:, 1] -= self._weight.energies(Q, np.zeros_like(Qd))[:, 1]
        return out

    def forward_dynamics_batch(
        self, Q: ArrayLike, Qd: ArrayLike, Tau: ArrayLike | None = None, *, out: Array | None = None
    ) -> Array:
        Q, Qd = self._table("Q", Q), self._table("Qd", Qd)
        Tau = np.zeros_like(Qd) if Tau is None else self._table("Tau", Tau)
        self._same_length(Q=Q, Qd=Qd, Tau=Tau)
        result = place_for(Qd.shape, out)
        return self.accelerations(apart(Q, out), apart(Qd, out), apart(Tau, out), result)

    def inverse_dynamics_batch(self, Q: ArrayLike, Qd: ArrayLike, Qdd: ArrayLike, *, out: Array | None = None) -> Array:
        Q, Qd, Qdd = self._table("Q", Q), self._table("Qd", Qd), self._table("Qdd", Qdd)
        self._same_length(Q=Q, Qd=Qd, Qdd=Qdd)
        result = place_for(Qd.shape, out)
        result[:] = [self.inverse_dynamics(*row) for row in zip(Q, Qd, Qdd, strict=True)]
        return result

    def accelerations(self, Q: Array, Qd: Array, Tau: Array, out: Array | None = None) -> Array:
        if out is None:
            out = np.empty_like(Qd)
        forces = Tau if len(Tau) else np.zeros_like(Qd)
        out[:] = [self.forward_dynamics(*row) for row in zip(Q, Qd, forces, strict=True)]
        return out


Denoc.of_carried_weight = Compensated
