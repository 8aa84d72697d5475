"""Closed forms as an engine of their own: mechanisms with one coordinate.

The motion is known exactly for the undamped physical pendulum (elliptic functions) and for whatever is linear: a
slider, or a rotor without gravity torque, with spring, viscous and dry friction and forces held between samples.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from harness.engines.checked import held_forces, raise_if_refused, sample_times, vector, vectors
from harness.engines.expressed import bends, express, refusal
from harness.engines.folded import bodies
from harness.engines.oscillator import oscillate
from harness.engines.pendulum import swing
from harness.engines.protocol import Array
from harness.engines.small_motion import NEUTRAL
from harness.errors import UnsupportedError
from harness.system import Joint, System, Trajectory
from harness.system.inertia import point_inertia

# A gravity torque below this share of m g |c| is the rounding of an upright axis or a body balanced on it.
BALANCED = 1e-14


@dataclass(frozen=True, eq=False)
class AnalyticModel:
    """One joint: M q'' + d q' + k (q - rest) + g(q) = tau with g(q) = G sin(q - low) or constant G.

    inertia: M [kg·m² or kg]. gravity_force: G [N·m or N]. low: lower equilibrium of the swinging body [rad], nan
    where the gravity force is constant. potential_level: potential energy [J] at q = 0.
    """

    names: tuple[str, ...]
    joint: Joint
    inertia: float
    gravity_force: float
    low: float
    potential_level: float

    @property
    def swings(self) -> bool:
        return not np.isnan(self.low)

    @cached_property
    def small(self) -> float:
        """Circular frequency ω of small undamped swings about the lower equilibrium [rad/s], spring left out."""
        return float(np.sqrt(self.gravity_force / self.inertia))

    def _gravity(self, q: Array) -> Array:
        return self.gravity_force * np.sin(q - self.low) if self.swings else np.full_like(q, self.gravity_force)

    def _passive(self, q: Array, qd: Array) -> Array:
        return -self.joint.damping * qd - self.joint.stiffness * (q - self.joint.rest_position)

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        q, qd, tau = vectors(1, q=q, qd=qd, tau=tau)
        return (tau + self._passive(q, qd) - self._gravity(q)) / self.inertia

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        q, qd, qdd = vectors(1, q=q, qd=qd, qdd=qdd)
        return self.inertia * qdd + self._gravity(q) - self._passive(q, qd)

    def mass_matrix(self, q: Array) -> Array:
        vector("q", q, 1)
        return np.array([[self.inertia]])

    def bias(self, q: Array, qd: Array) -> Array:
        vector("qd", qd, 1)
        return self.gravity(q)

    def gravity(self, q: Array) -> Array:
        return self._gravity(vector("q", q, 1))

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        q, qd = vectors(1, q=q, qd=qd)
        spring = 0.5 * self.joint.stiffness * (q[0] - self.joint.rest_position) ** 2
        height = np.cos(self.low) - np.cos(q[0] - self.low) if self.swings else q[0]
        potential = self.gravity_force * height
        return float(0.5 * self.inertia * qd[0] ** 2), float(self.potential_level + potential + spring)

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """The exact motion; ``step`` is not needed. UnsupportedError where no closed form exists."""
        q0, qd0 = vectors(1, q0=q0, qd0=qd0)
        time = sample_times(time)
        held = held_forces(tau, time.size, 1)
        forces = np.zeros(time.size) if held is None else held[:, 0]
        joint = self.joint
        if self.swings:
            beside = {
                "damping": joint.damping,
                "stiffness": joint.stiffness,
                "dry friction": joint.friction,
                "an applied torque": np.max(np.abs(forces)),
            }
            for what, value in beside.items():
                if value:
                    raise UnsupportedError(f"a pendulum with {what} has no closed form (joint {joint.name})")
            angle, rate = swing(float(q0[0]) - self.low, float(qd0[0]), self.small, time)
            position = angle + self.low
        else:
            position, rate = oscillate(
                (float(q0[0]), float(qd0[0])),
                self.inertia,
                joint.damping,
                joint.stiffness,
                forces - self.gravity_force + joint.stiffness * joint.rest_position,
                joint.friction,
                time,
            )
        energy = np.array([sum(self.energy(np.array([q]), np.array([v]))) for q, v in zip(position, rate, strict=True)])
        return Trajectory(time, self.names, position[:, None], rate[:, None], energy=energy)

    def frequencies(self, q: Array) -> Array:
        q = vector("q", q, 1)
        slope = self.gravity_force * np.cos(q - self.low) if self.swings else np.zeros(1)
        square = (slope + self.joint.stiffness) / self.inertia
        floor = NEUTRAL * self.small**2 if self.swings else 0.0
        return np.sqrt(square[square > floor]) / (2.0 * np.pi)


@dataclass(frozen=True)
class Analytic:
    """Closed forms as an ``Engine``: mechanisms with one rigid coordinate."""

    name: str = "analytic"

    def version(self) -> str:
        return f"scipy {scipy.__version__}"

    def refuses(self, system: System) -> str | None:
        if system.loops:
            return "closed forms here have no loops"
        if not system.simple:
            return "closed forms here have joints of one independent degree of freedom each alone"
        if bends(system):
            return "closed forms here have no elastic links"
        reason = refusal("the closed form", system, forces=False)
        if reason:
            return reason
        n = len(express(system).system.joint_names)
        return None if n == 1 else f"closed forms exist for one coordinate, the system has {n}"

    def build(self, system: System) -> AnalyticModel:
        """The constants of the one equation of motion; raises UnsupportedError if the system is refused."""
        raise_if_refused(system, self.refuses(system))
        system = express(system).system
        (body,), _ = bodies(system)
        joint = body.joint
        fall = body.rotation.T @ system.gravity  # in the joint's frame at zero
        lost = body.mass * float(system.gravity @ body.xyz)
        if joint.prismatic:
            return AnalyticModel(
                names=system.joint_names,
                joint=joint,
                inertia=body.mass + joint.armature,
                gravity_force=-body.mass * float(fall @ joint.axis),
                low=float("nan"),
                potential_level=-lost - body.mass * float(fall @ body.com),
            )
        about_origin = body.inertia + point_inertia(body.mass, body.com)
        # The centre of mass moves as c∥ + c⊥ cos q + (axis × c) sin q, so U = level - A cos q - B sin q.
        along = float(joint.axis @ body.com) * joint.axis
        a = body.mass * float(fall @ (body.com - along))
        b = body.mass * float(fall @ np.cross(joint.axis, body.com))
        strength = float(np.hypot(a, b))
        reach = body.mass * float(np.linalg.norm(fall) * np.linalg.norm(body.com))
        balanced = strength <= BALANCED * reach
        return AnalyticModel(
            names=system.joint_names,
            joint=joint,
            inertia=float(joint.axis @ about_origin @ joint.axis) + joint.armature,
            gravity_force=0.0 if balanced else strength,
            low=float("nan") if balanced else float(np.arctan2(b, a)),
            potential_level=-lost - body.mass * float(fall @ body.com),
        )
