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

from harness.engines.checked import (
    finite_result,
    held_forces,
    installed_version,
    positive_step,
    sample_times,
    vector,
    vectors,
)
from harness.engines.expressed import JointForces, bends, express, refusal
from harness.engines.march import march
from harness.engines.protocol import Array
from harness.engines.small_motion import frequencies, jacobian
from harness.errors import EngineUnavailableError, UnsupportedError, install
from harness.system import Joint, Link, System, Trajectory

# pinocchio.Data holds four tensors of n³ doubles: 0.26 GB at n = 200, 3.9 GB at n = 500.
LARGEST = 200


def _pinocchio() -> Any:
    try:
        import pinocchio
    except ImportError as error:
        raise EngineUnavailableError(f"Pinocchio cannot be loaded ({error}): {install('engines')}") from None
    return pinocchio


def pinocchio_model(system: System) -> Any:
    """The rigid system as a ``pinocchio.Model``; what hangs on the base by fixed joints is left out of it.

    Conventions, all of them: the link frame is Pinocchio's joint frame; a fixed link rides on the joint frame of the
    nearest movable joint above it; inertias are given about the centre of mass in link axes, as Pinocchio's are;
    continuous joints get one coordinate, an angle, like revolute ones (not Pinocchio's cosine and sine);
    gravity is the acceleration of free fall in both. Joints are added depth first, because ``crba`` takes a subtree's
    velocities to be contiguous and is silently wrong otherwise; ``PinocchioModel.order`` maps by name.
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
        if joint.movable:
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

    order: [k] is our index of Pinocchio's coordinate k. bare: the model without armature.
    """

    names: tuple[str, ...]
    system: System
    model: Any
    bare: Any
    data: Any
    order: NDArray[np.intp]
    armature: Array = field(repr=False)
    damping: Array = field(repr=False)
    stiffness: Array = field(repr=False)
    rest: Array = field(repr=False)
    forces: JointForces = field(repr=False)

    def _passive(self, q: Array, qd: Array) -> Array:
        return -self.damping * qd - self.stiffness * (q - self.rest) + self.forces(q, qd)

    def _out(self, value: Array) -> Array:
        result = np.empty_like(value)
        result[self.order] = value
        return result

    def _acceleration(self, q: Array, qd: Array, tau: Array) -> Array:
        pin = _pinocchio()
        total = tau + self._passive(q, qd)
        return self._out(pin.aba(self.model, self.data, q[self.order], qd[self.order], total[self.order]))

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        q, qd, tau = vectors(len(self.names), q=q, qd=qd, tau=tau)
        return finite_result("pinocchio", "forward dynamics", self._acceleration(q, qd, tau))

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        q, qd, qdd = vectors(len(self.names), q=q, qd=qd, qdd=qdd)
        tau = _pinocchio().rnea(self.model, self.data, q[self.order], qd[self.order], qdd[self.order])
        return self._out(tau) - self._passive(q, qd)

    def mass_matrix(self, q: Array) -> Array:
        q = vector("q", q, len(self.names))
        # `crba` fills the upper triangle only in some releases.
        upper = np.triu(_pinocchio().crba(self.model, self.data, q[self.order]))
        result = np.empty_like(upper)
        result[np.ix_(self.order, self.order)] = upper + np.triu(upper, 1).T
        return result

    def bias(self, q: Array, qd: Array) -> Array:
        q, qd = vectors(len(self.names), q=q, qd=qd)
        return self._out(_pinocchio().nonLinearEffects(self.model, self.data, q[self.order], qd[self.order]).copy())

    def gravity(self, q: Array) -> Array:
        q = vector("q", q, len(self.names))
        return self._out(_pinocchio().computeGeneralizedGravity(self.model, self.data, q[self.order]).copy())

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        q, qd = vectors(len(self.names), q=q, qd=qd)
        pin = _pinocchio()
        spring = 0.5 * float(self.stiffness @ (q - self.rest) ** 2) + 0.25 * float(self.forces.cubic @ q**4)
        potential = float(pin.computePotentialEnergy(self.model, self.data, q[self.order]))
        # Pinocchio 4.1 counts the armature of some kinds of joint and forgets it for revolute ones with a general axis.
        kinetic = float(pin.computeKineticEnergy(self.bare, self.data, q[self.order], qd[self.order]))
        kinetic += 0.5 * float(self.armature @ qd**2)
        return kinetic, potential + spring

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """RK4 with steps of at most ``step`` [s], or DOP853 (relative 1e-12) if it is None."""
        sticky = [joint.name for joint in self.system.movable_joints if joint.friction]
        if sticky:
            raise UnsupportedError(
                f"Pinocchio has no dry friction, joint {sticky[0]} has", mend="simulate with denoc or mujoco"
            )
        n = len(self.names)
        q0, qd0 = vectors(n, q0=q0, qd0=qd0)
        time = sample_times(time)
        position, velocity = march(
            self._acceleration, q0, qd0, time, held_forces(tau, time.size, n), positive_step(step)
        )
        energy = np.array([sum(self.energy(q, qd)) for q, qd in zip(position, velocity, strict=True)])
        return Trajectory(time=time, names=self.names, position=position, velocity=velocity, energy=energy)

    def frequencies(self, q: Array) -> Array:
        q = vector("q", q, len(self.names))
        slope = _pinocchio().computeGeneralizedGravityDerivatives(self.model, self.data, q[self.order])
        stiffness = np.empty_like(slope)
        stiffness[np.ix_(self.order, self.order)] = slope
        springs = np.diag(self.stiffness) - jacobian(lambda x: self.forces(x, np.zeros_like(x)), q)
        return frequencies(self.mass_matrix(q), stiffness + springs)


@dataclass(frozen=True)
class Pinocchio:
    """Pinocchio as an ``Engine``: rigid trees of up to ``LARGEST`` coordinates, dry friction not simulated."""

    name: str = "pinocchio"

    def version(self) -> str:
        return installed_version("pin", "Pinocchio")

    def refuses(self, system: System) -> str | None:
        if bends(system):
            return "Pinocchio has no elastic links"
        n = len(system.joint_names)
        if n == 0:
            return "the system has no movable joint"
        if n > LARGEST:
            return f"{n} coordinates: pinocchio.Data would take {32 * n**3 / 1e9:.1f} GB (four tensors of n³)"
        return refusal("Pinocchio", system)

    def build(self, system: System) -> PinocchioModel:
        """The system in Pinocchio; raises UnsupportedError with the reason if it is refused."""
        reason = self.refuses(system)
        if reason:
            raise UnsupportedError(reason, source=system.source)
        pin = _pinocchio()
        expressed = express(system)
        system = expressed.system
        try:
            model = pinocchio_model(system)
        except (RuntimeError, ValueError) as error:  # inertia that no body can have, which it checks here and there
            raise UnsupportedError(f"Pinocchio refuses it: {error}", source=system.source) from error
        names = system.joint_names
        places = {name: k for k, name in enumerate(names)}
        order = np.empty(model.nv, dtype=np.intp)
        for k in range(1, model.njoints):
            order[model.joints[k].idx_v] = places[model.names[k]]
        joints = system.movable_joints
        bare = pin.Model(model)
        bare.armature = np.zeros(model.nv)
        return PinocchioModel(
            names=names,
            system=system,
            model=model,
            bare=bare,
            data=pin.Data(model),
            order=order,
            armature=np.array([joint.armature for joint in joints]),
            damping=np.array([joint.damping for joint in joints]),
            stiffness=np.array([joint.stiffness for joint in joints]),
            rest=np.array([joint.rest_position for joint in joints]),
            forces=expressed.forces,
        )
