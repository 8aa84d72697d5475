"""Closed mechanisms compiled for computing: ``Denoc`` of a system with loops."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from harness.denoc.batch.results import place_for
from harness.denoc.loops.tables import tables
from harness.denoc.model import Array, Denoc
from harness.denoc.recursion.binding import CUT_NUMBERS, CUTS, FORWARD, RECURSION, SETTLE, TREE, entry
from harness.denoc.recursion.dynamics_call import forward_entry
from harness.errors import InputError, UnsupportedError
from harness.system import Frame, Joint, JointType, Link, Loop, System, Trajectory
from harness.system.check import idle_joint
from harness.system.closure import closed_position, size, usual_rank
from harness.system.loop import SHIFTS
from harness.system.lowering import lower

# What a state that is asked for may leave open, over the mechanism's size or in radians; runs close it exactly.
OPEN = 1e-6


class Closed(Denoc):
    """Equations of motion of a mechanism with loops, in the coordinates of its tree.

    What ``Denoc`` says holds, with

    M q̈ + C q̇ + g = τ + passive forces + Jᵀ λ,  J q̈ = γ,

    J q̇ = 0 being what the loops hold and λ constraint forces. Forward dynamics eliminate λ; they want a state whose loops are
    closed (``assemble``). Mass matrix, bias, gravity and energy are the tree's.
    """

    __slots__ = ("_numbers", "_places", "_tree_header", "conditions")

    def __init__(self, system: System) -> None:
        if any(link.gravcomp for link in system.links):
            raise UnsupportedError(
                "gravity compensation of single links beside loops",
                mend="leave out gravcomp, or scale gravity",
                source=system.source,
            )
        tree, names = _with_frames(system)
        super().__init__(tree)
        self.system = system
        at = closed_position(system)
        coupled = self._chart is not None and not self._chart.lowered.independent
        columns = bool(self.beams) or coupled or idle_joint(lower(tree.rigid()).system) is not None
        self._places, self._numbers = tables(system, self.tree.seats, names, usual_rank(system, at), columns)
        self.conditions = tuple((loop.name, condition) for loop in _ordered(system) for condition in loop.conditions)
        self._tree_header = self._header
        from harness.denoc.loops.address import address

        dynamics = address()
        header = self._header.copy()
        header[TREE], header[CUTS] = self._tree_header.ctypes.data, self._places.ctypes.data
        header[CUT_NUMBERS] = self._numbers.ctypes.data
        header[FORWARD], header[RECURSION], header[SETTLE] = dynamics, dynamics, dynamics
        self._header = header
        self._model = int(header.ctypes.data)
        if self._chart is None:
            self._forward = entry(forward_entry, 4)

    def __reduce__(self) -> tuple[type[Denoc], tuple[System]]:
        return Denoc, (self.system,)

    def assemble(self, q: ArrayLike | None = None, *, held: Collection[str] = ()) -> Array:
        """Positions (nq,) where the loops are closed, the nearest to q (the file's zero if None) that is found.

        held: names of coordinates that stay as they are in q. Raises InputError where the loops cannot close so.
        """
        for name in held:
            if name not in self.names:
                raise InputError(f"{name!r} is no coordinate", mend=f"coordinates are {', '.join(self.names[:8])}")
        q = closed_position(self.system, None if q is None else self.position("q", q), held=held)
        self._settle(q, np.zeros(self.n))
        return q

    def closed_velocity(self, q: ArrayLike, qd: ArrayLike) -> Array:
        """The velocities (n,) nearest to qd, in the norm of the mass matrix, that keep the loops closed at closed positions q."""
        q, qd = self.position("q", q).copy(), self.vector("qd", qd).copy()
        self._settle(q, qd)
        return qd

    def _settle(self, q: Array, qd: Array) -> None:
        """Close positions and velocities again, in place."""
        from harness.denoc.loops.address import called

        status = called()(self._model, q.ctypes.data, qd.ctypes.data, 0, 0)
        if status > 0:
            raise self.singular(status)

    def open_by(self, q: ArrayLike) -> Array:
        """How far each of ``conditions`` is open at positions q [m, or rad], shape (c,)."""
        return self._described(self.position("q", q), self._zero)[0][:, 0]

    def loop_jacobian(self, q: ArrayLike) -> Array:
        """J(q), rates of the conditions by velocity, shape (c, n)."""
        return self._described(self.position("q", q), self._zero)[1]

    def _described(self, q: Array, qd: Array) -> tuple[Array, Array]:
        """Value, rate and acceleration without joint accelerations of every condition, (c, 3), and J, (c, n)."""
        from harness.denoc.loops.address import called

        c = len(self.conditions)
        found = np.empty(c * (3 + self.n))
        status = called()(self._model, q.ctypes.data, qd.ctypes.data, 0, found.ctypes.data)
        if status > 0:
            raise self.singular(status)
        return found[: 3 * c].reshape(c, 3), found[3 * c :].reshape(c, self.n)

    def constraint_forces(self, q: ArrayLike, qd: ArrayLike, tau: ArrayLike | None = None) -> Array:
        """Constraint forces λ of ``conditions`` in free motion under τ [N, or N·m], shape (c,).

        Where conditions say things twice these are not unique; the least ones (minimum norm) are returned.
        """
        q, qd = self.position("q", q), self.vector("qd", qd)
        applied = self._zero if tau is None else self.vector("tau", tau)
        accelerations = self.forward_dynamics(q, qd, applied)
        needed = Denoc.inverse_dynamics(self, q, qd, accelerations) - applied
        jacobian = self._described(q, qd)[1]
        return np.asarray(np.linalg.lstsq(jacobian.T, needed, rcond=1e-9)[0])

    def inverse_dynamics(
        self,
        q: Array,
        qd: Array,
        qdd: Array,
        wrenches: ArrayLike | None = None,
        actuated: Sequence[str] | None = None,
    ) -> Array:
        """Generalized forces τ that make the accelerations: of all that do, the least (minimum norm).

        actuated: names of the coordinates that are driven, others get none. q̈ has to keep the loops closed.
        Raises InputError where it does not, and where the actuated coordinates cannot make it.
        """
        needed = super().inverse_dynamics(q, qd, qdd, wrenches)
        states, jacobian = self._described(self.position("q", q), self.vector("qd", qd))
        gap = jacobian @ self.vector("qdd", qdd) + states[:, 2]
        terms = np.abs(jacobian) @ np.abs(self.vector("qdd", qdd)) + np.abs(states[:, 2])
        if np.any(np.abs(gap) > OPEN * (1.0 + terms)):
            name, motion = self.conditions[int(np.argmax(np.abs(gap) / (1.0 + terms)))]
            raise InputError(
                f"qdd opens loop {name!r} ({motion}) by {np.abs(gap).max():.3g} a second squared",
                mend="give accelerations that keep the loops closed, as forward_dynamics does",
            )
        driven = list(range(self.n)) if actuated is None else [self._place(name) for name in actuated]
        # τ of the driven and λ together, the least τ: λ is free.
        directions = np.zeros((self.n, len(driven)))
        directions[driven, range(len(driven))] = 1.0
        # What constraint forces can take over is left to them.
        basis = np.linalg.svd(jacobian.T, full_matrices=True)
        independent = int((basis[1] > 1e-9 * max(basis[1].max(initial=0.0), 1e-300)).sum())
        complement = basis[0][:, independent:].T
        forces = np.linalg.lstsq(complement @ directions, complement @ needed, rcond=1e-9)[0]
        left = complement @ (directions @ forces - needed)
        if np.abs(left).max(initial=0.0) > 1e-8 * (1.0 + np.abs(needed).max()):
            raise InputError(
                f"{', '.join(actuated or ())} alone cannot make these accelerations: {np.abs(left).max():.3g} N·m are left",
                mend="actuate as many joints as the closed mechanism has degrees of freedom",
            )
        return np.asarray(directions @ forces)

    def _place(self, name: str) -> int:
        if name not in self.names:
            raise InputError(f"{name!r} is no coordinate", mend=f"coordinates are {', '.join(self.names[:8])}")
        return self.names.index(name)

    def _eight_at_a_time(self, Q: Array) -> None:
        return None

    def inverse_dynamics_batch(self, Q: ArrayLike, Qd: ArrayLike, Qdd: ArrayLike, *, out: Array | None = None) -> Array:
        Q, Qd, Qdd = self._table("Q", Q), self._table("Qd", Qd), self._table("Qdd", Qdd)
        self._same_length(Q=Q, Qd=Qd, Qdd=Qdd)
        found = np.array([self.inverse_dynamics(*row) for row in zip(Q, Qd, Qdd, strict=True)]).reshape(Qd.shape)
        result = place_for(Qd.shape, out)
        result[:] = found
        return result

    def simulate(self, q0: ArrayLike, qd0: ArrayLike, time: ArrayLike, **more: Any) -> Trajectory:
        """Motion as ``Denoc.simulate`` says, the loops closed after every step.

        Raises InputError where q0 or qd0 leave a loop open: ``assemble`` and ``closed_velocity`` close them.
        """
        q0, qd0 = self.position("q0", q0).copy(), self.vector("qd0", qd0).copy()
        rubbing = [joint.name for joint in self.system.joints if joint.friction]
        if len(rubbing) > 1:
            # Joints of a loop stop at once, and the events of each would have to be told apart.
            raise UnsupportedError(
                f"dry friction at several joints ({', '.join(rubbing)}) of a closed mechanism",
                mend="give it at one joint, or damping in its place",
                source=self.system.source,
            )
        if more.get("method") == "gauss":
            raise UnsupportedError("method 'gauss' does not keep loops closed", mend="leave method out, or take 'rk4'")
        self.refuse_open(q0, qd0)
        self._settle(q0, qd0)
        return super().simulate(q0, qd0, time, **{**more, "method": more.get("method") or "dop853"})

    def refuse_open(self, q: Array, qd: Array) -> None:
        """Raise InputError naming the loop that a state leaves open."""
        states, jacobian = self._described(q, qd)
        units = np.array([size(self.system) if motion in SHIFTS else 1.0 for _, motion in self.conditions])
        if np.any(np.abs(states[:, 0]) > OPEN * units):
            name, motion = self.conditions[int(np.argmax(np.abs(states[:, 0])))]
            raise InputError(
                f"q0 leaves loop {name!r} open ({motion}, by {np.abs(states[:, 0]).max():.3g})",
                mend="start from positions that close the loops: model.assemble(q0)",
            )
        speed = np.abs(states[:, 1]) - OPEN * (1e-3 + np.abs(jacobian) @ np.abs(qd))
        if speed.max(initial=0.0) > 0.0:
            name, motion = self.conditions[int(np.argmax(speed))]
            raise InputError(
                f"qd0 opens loop {name!r} ({motion}, by {np.abs(states[:, 1]).max():.3g} a second)",
                mend="start with velocities that keep the loops closed: model.closed_velocity(q0, qd0)",
            )

    def frequencies(self, q: ArrayLike | None = None, *, qd: ArrayLike | None = None) -> Array:
        raise UnsupportedError("natural frequencies of closed mechanisms", mend="read them from a small motion")


def _ordered(system: System) -> list[Any]:
    """Loops in the order of the tables: cut joints first."""
    return sorted(system.loops, key=lambda loop: not isinstance(loop, Loop))


def _with_frames(system: System) -> tuple[System, dict[Frame, str]]:
    """The tree, with a massless link at every frame that rides on a link that bends, and the link of each frame."""
    joints, links, names = list(system.joints), list(system.links), {}
    taken = {link.name for link in links} | {joint.name for joint in joints} | {system.base}
    bending = {link.name for link in links if link.flexible}
    for loop in system.loops:
        if not isinstance(loop, Loop):
            continue
        for frame, side in ((loop.first, "first"), (loop.second, "second")):
            names[frame] = frame.link
            if frame.link in bending:
                name = f"{loop.name}__{side}"
                while name in taken:
                    name += "_"
                taken.add(name)
                joints.append(Joint(name, JointType.FIXED, frame.link, name, xyz=frame.xyz, rotation=frame.rotation))
                links.append(Link(name))
                names[frame] = name
    return replace(system, joints=tuple(joints), links=tuple(links), loops=()), names


Denoc.of_loops = Closed
