"""Many states of mechanisms whose joints turn in space, eight at a time: as states of what they are lowered to (``turns``)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.denoc.batch import dynamics as sweeps
from harness.denoc.batch import trunk as trunks
from harness.denoc.batch import turns as kernels
from harness.denoc.batch.model import BatchModel
from harness.system import Joint, JointType, System
from harness.system.description import constant
from harness.system.lowering import Lowered

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

ROWS = 1024  # converted at a time: what lies between two kernels stays in the cache


class SpaceBatch:
    """``BatchModel`` for positions (B, nq) with quaternions; rows near where the turns are singular are left to ``by_row``.

    serial: as of ``BatchModel``. Each method of ``BatchModel`` that takes ``by_row`` hands it the rows concerned.
    """

    def __init__(self, system: System, lowered: Lowered) -> None:
        balls = [joint for joint in system.movable_joints if joint.turns_in_space]
        firsts = {int(first) for _, first in lowered.balls}
        spins = {lowered.system.coordinate_names[first + k] for first in firsts for k in range(3)}
        # Dampers of a ball resist its spin, not its turns.
        joints = (replace(j, damping=0.0) if j.name in spins else j for j in lowered.system.joints)
        # Where all hangs on what floats, weight comes in with the conversions.
        floats = all(joint.type is JointType.FREE for joint in system.joints if joint.parent == system.base)
        gravity = constant([0.0, 0.0, 0.0]) if floats else system.gravity
        self.inner = BatchModel(replace(lowered.system, joints=tuple(joints), gravity=gravity))
        self.serial = self.inner.serial
        roots = [floats and ball.parent == system.base for ball in balls]
        self._balls: Integers = np.array(
            [[at, first, root] for (at, first), root in zip(lowered.balls, roots, strict=True)], dtype=np.int64
        )
        self._damping = np.array([joint.damping for joint in balls])
        # Of each ball in the axes that it is placed in, which a floating one moves in.
        self._gravity = np.array([np.asarray(joint.rotation).T @ np.array(system.gravity) for joint in balls])
        self._take, self._factor, self._shift = lowered.take, lowered.factor.copy(), lowered.shift.copy()
        self._trunk = self._as_trunk(balls[0], lowered) if floats and len(balls) == 1 else None

    def _as_trunk(self, joint: Joint, lowered: Lowered) -> Array | None:
        """Numbers of the trunk (``batch.trunk``) if all else hangs on it by joints whose positions are as they stand; else None."""
        tree, constants = self.inner.bodies
        behind = np.arange(trunks.BODIES, self.inner.n)
        hangs = tree[: trunks.BODIES, sweeps.PARENT].tolist() == list(range(-1, trunks.BODIES - 1))
        hangs = hangs and bool((tree[trunks.BODIES :, sweeps.PARENT] >= trunks.BODIES - 1).all())
        plain = (lowered.take[behind] == behind + 1) & (lowered.factor[behind] == 1.0) & (lowered.shift[behind] == 0.0)
        if not (hangs and plain.all()):
            return None
        # The trunk's body stands in its link about z, the last of the turns that it is lowered to.
        turn = np.asarray(joint.rotation).T
        for row in constants[: trunks.BODIES]:
            turn = turn @ _about(2, row, sweeps.GAMMA) @ _about(0, row, sweeps.ALPHA) @ _about(2, row, sweeps.DELTA)
        return np.array([*self._gravity[0], turn[0, 0], turn[1, 0], joint.damping])

    @staticmethod
    def takes(system: System, lowered: Lowered) -> bool:
        """Whether a system is such a one: rigid, every rate a velocity, no weight carried, no armature that resists a spin."""
        balls = [joint for joint in system.movable_joints if joint.turns_in_space]
        plain = not system.flexible and lowered.independent and not any(link.gravcomp for link in system.links)
        return bool(balls) and plain and not any(ball.armature for ball in balls)

    def forward_dynamics(
        self, Q: Array, Qd: Array, Tau: Array, out: Array, by_row: Callable[[Array, Array, Array, Array], object]
    ) -> Array:
        """Accelerations (B, n), written to ``out``."""
        if self._trunk is not None:
            return self.inner.floating_dynamics(self._trunk, Q, Qd, Tau, out)
        for rows, local, rates, kept, near in self._stretches(Q, Qd):
            forces = np.empty_like(local)
            kernels.forces_to_turns(self._balls, self._damping, Qd[rows], Tau[rows], kept, forces)
            self.inner.forward_dynamics(local, rates, forces, out=out[rows])
            kernels.accelerations_from_turns(self._balls, self._gravity, rates, kept, out[rows])
            self._left(near, out[rows], by_row, Q[rows], Qd[rows], Tau[rows])
        return out

    def inverse_dynamics(
        self, Q: Array, Qd: Array, Qdd: Array, out: Array, by_row: Callable[[Array, Array, Array, Array], object]
    ) -> Array:
        """Generalized forces (B, n), written to ``out``."""
        for rows, local, rates, kept, near in self._stretches(Q, Qd):
            asked = np.empty_like(local)
            kernels.accelerations_to_turns(self._balls, self._gravity, Qdd[rows], rates, kept, asked)
            self.inner.inverse_dynamics(local, rates, asked, out=out[rows])
            kernels.forces_from_turns(self._balls, self._damping, Qd[rows], kept, out[rows])
            self._left(near, out[rows], by_row, Q[rows], Qd[rows], Qdd[rows])
        return out

    def mass_matrix(self, Q: Array, out: Array, by_row: Callable[[Array, Array], object]) -> Array:
        """Generalized inertia matrices (B, n, n), written to ``out``."""
        for rows, local, _, kept, near in self._stretches(Q):
            self.inner.mass_matrix(local, out=out[rows])
            kernels.masses_from_turns(self._balls, kept, out[rows])
            self._left(near, out[rows], by_row, Q[rows])
        return out

    def _stretches(self, Q: Array, Qd: Array | None = None) -> Iterator[tuple[slice, Array, Array, Array, Array]]:
        """Rows one stretch after another: lowered positions and rates, what is kept of balls, which rows are to be left out."""
        for first in range(0, len(Q), ROWS):
            rows = slice(first, min(first + ROWS, len(Q)))
            count = rows.stop - first
            local, rates = np.empty((count, self.inner.n)), np.empty((count, self.inner.n))
            kept, near = np.empty((count, kernels.TURN * len(self._balls))), np.empty(count)
            moving = np.zeros_like(rates) if Qd is None else Qd[rows]
            kernels.to_turns(
                self._balls, self._take, self._factor, self._shift, Q[rows], moving, local, rates, kept, near
            )
            yield rows, local, rates, kept, near

    @staticmethod
    def _left(near: Array, out: Array, by_row: Callable[..., object], *arrays: Array) -> None:
        """Rows that are left out, by the recursion over the manifold."""
        if near.any():
            which = np.flatnonzero(near)
            found = np.empty((len(which), *out.shape[1:]))
            by_row(*(np.ascontiguousarray(array[which]) for array in arrays), found)
            out[which] = found


def _about(axis: int, row: Array, at: int) -> Array:
    """Rotation about a body's x (0) or z (2), cosine and sine from its constants."""
    c, s = row[at : at + 2]
    return np.array([[1.0, 0, 0], [0, c, -s], [0, s, c]] if axis == 0 else [[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
