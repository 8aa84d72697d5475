"""Pinocchio: articulated-body and recursive Newton-Euler algorithms, built through its API, not through files.

Pinocchio knows ``armature`` and no other joint property, so damping, springs and the joint laws of attached
effects are put on the right-hand side here.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.compiled_packages import loaded
from harness.engines.checked import (
    finite_result,
    held_forces,
    no_dry_friction,
    positive_step,
    sample_times,
    vector,
    vectors,
)
from harness.engines.expressed import JointForces
from harness.engines.march import march
from harness.engines.pinocchio_axes import Axes
from harness.engines.protocol import Array
from harness.engines.small_motion import frequencies, jacobian
from harness.errors import UnsupportedError, cannot_be_loaded, install
from harness.system import Joint, JointType, Link, System, Trajectory

# pinocchio.Data holds four tensors of n³ doubles: 0.26 GB at n = 200, 3.9 GB at n = 500.
LARGEST = 200


def _pinocchio() -> Any:
    try:
        return loaded("pinocchio")
    except ImportError as error:
        raise cannot_be_loaded("Pinocchio", error, install("engines")) from None


def pinocchio_model(system: System) -> Any:
    """The rigid system as a ``pinocchio.Model``; what hangs on the base by fixed joints is left out of it.

    Conventions, all of them: the link frame is Pinocchio's joint frame; a fixed link rides on the joint frame of the
    nearest movable joint above it; inertias are given about the centre of mass in link axes, as Pinocchio's are;
    continuous joints get one coordinate, an angle, like revolute ones (not Pinocchio's cosine and sine);
    gravity is the acceleration of free fall in both. A free joint is Pinocchio's free flyer, whose quaternion has w last and whose
    linear velocity is in the child's axes, where ours is in the joint frame's (``Axes``); a ball is its spherical joint, whose
    quaternion has w last and whose velocity is ours. Joints are added depth first, because ``crba`` takes a subtree's
    velocities to be contiguous and is silently wrong otherwise; ``Axes.order`` maps by name.
    """
    pin = _pinocchio()
    model = pin.Model()
    model.name = system.name
    model.gravity.linear = np.array(system.gravity)
    model.gravity.angular = np.zeros(3)
    frames = {system.base: (0, pin.SE3.Identity())}
    armature = []
    for joint, link in depth_first(system):
        parent, ride = frames[joint.parent]
        placement = ride * pin.SE3(np.array(joint.rotation), np.array(joint.xyz))
        if joint.turns_in_space:
            made = pin.JointModelFreeFlyer() if joint.type is JointType.FREE else pin.JointModelSpherical()
            parent = model.addJoint(parent, made, placement, joint.name)
            placement = pin.SE3.Identity()
            armature += [joint.armature] * len(joint.velocity_names)
        elif joint.movable:
            kind = pin.JointModelPrismaticUnaligned if joint.prismatic else pin.JointModelRevoluteUnaligned
            parent = model.addJoint(parent, kind(np.array(joint.axis)), placement, joint.name)
            placement = pin.SE3.Identity()
            armature.append(joint.armature)
        frames[joint.child] = (parent, placement)
        if parent:
            inertia = pin.Inertia(float(link.mass), np.array(link.com), np.array(link.inertia))
            model.appendBodyToJoint(parent, inertia, placement)
    model.armature = np.array(armature, dtype=np.float64)
    return model


def depth_first(system: System) -> Iterator[tuple[Joint, Link]]:
    """Joints with the links they carry, every subtree in one run."""
    carried: dict[str, list[tuple[Joint, Link]]] = {}
    for joint, link in zip(system.joints, system.links, strict=True):
        carried.setdefault(joint.parent, []).append((joint, link))
    waiting = carried.get(system.base, [])[::-1]
    while waiting:
        joint, link = waiting.pop()
        yield joint, link
        waiting += carried.get(link.name, [])[::-1]


@dataclass(frozen=True, eq=False)
class PinocchioModel:
    """A system in Pinocchio; see ``EngineModel``.

    axes: of its coordinates. local: where our positions stand that joint laws see, -1 for none. bare: the model without armature.
    lifts: signs and models of what is carried of the links' weight: Pinocchio sums no negative masses.
    """

    names: tuple[str, ...]
    position_names: tuple[str, ...]
    axes: Axes
    local: NDArray[np.int64]
    system: System
    model: Any
    bare: Any
    data: Any
    armature: Array = field(repr=False)
    damping: Array = field(repr=False)
    stiffness: Array = field(repr=False)
    rest: Array = field(repr=False)
    forces: JointForces = field(repr=False)
    lifts: tuple[tuple[float, PinocchioModel], ...] = field(repr=False, default=())

    def _carried(self, q: Array) -> Array | float:
        """Generalized forces of what compensates weight."""
        return sum((sign * lift.gravity(q) for sign, lift in self.lifts), 0.0)

    def _angles(self, q: Array) -> Array:
        """Positions by velocity, zero for spins, as joint laws want them."""
        return q if len(q) == len(self.names) else np.where(self.local >= 0, q[self.local], 0.0)

    def _passive(self, q: Array, qd: Array) -> Array:
        x = self._angles(q)
        return -self.damping * qd - self.stiffness * (x - self.rest) + self.forces(x, qd)

    def _q(self, q: Array) -> Array:
        found = self.axes.position(q)
        if len(q) != len(self.names):
            # Quaternions that are not unit mean nothing to Pinocchio.
            found = _pinocchio().normalize(self.model, found)
        return np.asarray(found)

    def _acceleration(self, q: Array, qd: Array, tau: Array) -> Array:
        pin = _pinocchio()
        total = tau + self._passive(q, qd) + self._carried(q)
        # Armature resists v̇, not the rate of what turns.
        applied = (self.axes.turned(q, total) - self.armature * self.axes.turning(q, qd))[self.axes.order]
        found = pin.aba(self.model, self.data, self._q(q), self.axes.into(q, qd), applied)
        return self.axes.acceleration_out(q, qd, found)

    def _state(self, q: Array, **others: Array) -> Iterator[Array]:
        """Positions, and what has the size of velocities, checked."""
        yield vector("q", q, len(self.position_names))
        yield from vectors(len(self.names), **others)

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        q, qd, tau = self._state(q, qd=qd, tau=tau)
        return finite_result("pinocchio", "forward dynamics", self._acceleration(q, qd, tau))

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        q, qd, qdd = self._state(q, qd=qd, qdd=qdd)
        pin = _pinocchio()
        tau = pin.rnea(
            self.model, self.data, self._q(q), self.axes.into(q, qd), self.axes.acceleration_into(q, qd, qdd)
        )
        tau = tau + (self.armature * self.axes.turning(q, qd))[self.axes.order]
        return self.axes.out(q, tau) - self._passive(q, qd) - self._carried(q)

    def mass_matrix(self, q: Array) -> Array:
        q = vector("q", q, len(self.position_names))
        return self.axes.mass_out(q, _pinocchio().crba(self.model, self.data, self._q(q)))

    def bias(self, q: Array, qd: Array) -> Array:
        q, qd = self._state(q, qd=qd)
        idle = self.axes.acceleration_into(q, qd, np.zeros_like(qd))
        pin, at, rates = _pinocchio(), self._q(q), self.axes.into(q, qd)
        if not self.axes.free:
            found = pin.nonLinearEffects(self.model, self.data, at, rates)
        else:
            found = pin.rnea(self.bare, self.data, at, rates, idle)
        return self.axes.out(q, found.copy()) - self._carried(q)

    def gravity(self, q: Array) -> Array:
        q = vector("q", q, len(self.position_names))
        found = _pinocchio().computeGeneralizedGravity(self.model, self.data, self._q(q)).copy()
        return self.axes.out(q, found) - self._carried(q)

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        q, qd = self._state(q, qd=qd)
        pin = _pinocchio()
        x = self._angles(q)
        spring = 0.5 * float(self.stiffness @ (x - self.rest) ** 2) + self.forces.potential(x)
        potential = float(pin.computePotentialEnergy(self.model, self.data, self._q(q)))
        potential -= sum(sign * lift.energy(q, np.zeros_like(qd))[1] for sign, lift in self.lifts)
        # Pinocchio 4.1 counts the armature of some kinds of joint and forgets it for revolute ones with a general axis.
        kinetic = float(pin.computeKineticEnergy(self.bare, self.data, self._q(q), self.axes.into(q, qd)))
        kinetic += 0.5 * float(self.armature @ qd**2)
        return kinetic, potential + spring

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """RK4 with steps of at most ``step`` [s], or DOP853 (relative 1e-12) if it is None."""
        no_dry_friction("Pinocchio has", self.system)
        n = len(self.names)
        if len(self.position_names) != n:
            raise UnsupportedError(
                "motion with quaternions is not integrated over Pinocchio's accelerations", mend="take denoc or mujoco"
            )
        q0, qd0 = vectors(n, q0=q0, qd0=qd0)
        time = sample_times(time)
        position, velocity = march(
            self._acceleration, q0, qd0, time, held_forces(tau, time.size, n), positive_step(step)
        )
        energy = np.array([sum(self.energy(q, qd)) for q, qd in zip(position, velocity, strict=True)])
        return Trajectory(time=time, names=self.names, position=position, velocity=velocity, energy=energy)

    def frequencies(self, q: Array) -> Array:
        q = vector("q", q, len(self.position_names))
        if len(q) != len(self.names):
            raise UnsupportedError("frequencies beside joints that turn in space are not asked of Pinocchio")
        slope = _pinocchio().computeGeneralizedGravityDerivatives(self.model, self.data, q[self.axes.order])
        stiffness = np.empty_like(slope)
        stiffness[np.ix_(self.axes.order, self.axes.order)] = slope
        stiffness -= sum((sign * jacobian(lift.gravity, q) for sign, lift in self.lifts), 0.0)
        springs = np.diag(self.stiffness) - jacobian(lambda x: self.forces(x, np.zeros_like(x)), q)
        return frequencies(self.mass_matrix(q), stiffness + springs)


def _by_velocity(system: System, key: str) -> Array:
    """A number of the joints, one a velocity."""
    return np.array([getattr(joint, key) for joint in system.joints for _ in joint.velocity_names])
