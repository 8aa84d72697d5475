"""Joints that follow others, in engines that know independent ones: their equations reduced by the constant matrix G.

With velocities G v of a system without mimics, Gᵀ M G v̇ + Gᵀ bias = Gᵀ τ. Positions follow by multiplier and offset.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.engines.checked import held_forces, positive_step, sample_times, vector, vectors
from harness.engines.march import march
from harness.engines.protocol import Array, EngineModel
from harness.engines.soft_motion import soft_joints, soft_march
from harness.errors import UnsupportedError
from harness.system import System, Trajectory
from harness.system.lowering import followed


def follows(system: System) -> bool:
    """Whether a joint follows another."""
    return any(joint.mimic is not None for joint in system.joints)


def without_mimics(system: System) -> System:
    """The system with every joint independent, its limits and dry friction left to the runs of what is coupled."""
    return replace(system, joints=tuple(replace(joint, mimic=None, friction=0.0) for joint in system.joints), stops=())


@dataclass(frozen=True, eq=False)
class CoupledModel:
    """A system with joints that follow others, over an engine's model of it without; see ``EngineModel``.

    rates: G (m, n). take, factor, shift (positions of the model): which of our positions, by how much, and offset.
    system: with the limits and dry friction that act in runs.
    """

    names: tuple[str, ...]
    position_names: tuple[str, ...]
    model: EngineModel
    rates: Array
    take: NDArray[np.intp]
    factor: Array
    shift: Array
    system: System

    def _q(self, q: Array) -> Array:
        return self.shift + self.factor * vector("q", q, len(self.position_names))[self.take]

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        qd, tau = vectors(len(self.names), qd=qd, tau=tau)
        theirs, speed = self._q(q), self.rates @ qd
        opposing = self.rates.T @ self.model.inverse_dynamics(theirs, speed, np.zeros(len(speed)))
        return np.asarray(np.linalg.solve(self.mass_matrix(q), tau - opposing))

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        qd, qdd = vectors(len(self.names), qd=qd, qdd=qdd)
        return np.asarray(self.rates.T @ self.model.inverse_dynamics(self._q(q), self.rates @ qd, self.rates @ qdd))

    def mass_matrix(self, q: Array) -> Array:
        return np.asarray(self.rates.T @ self.model.mass_matrix(self._q(q)) @ self.rates)

    def bias(self, q: Array, qd: Array) -> Array:
        return np.asarray(self.rates.T @ self.model.bias(self._q(q), self.rates @ vector("qd", qd, len(self.names))))

    def gravity(self, q: Array) -> Array:
        return np.asarray(self.rates.T @ self.model.gravity(self._q(q)))

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        return self.model.energy(self._q(q), self.rates @ vector("qd", qd, len(self.names)))

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """RK4 with steps of at most ``step`` [s], or DOP853 (relative 1e-12) if it is None.

        With limits or dry friction DOP853, both as MuJoCo's soft constraints.
        """
        n = len(self.names)
        if len(self.position_names) != n:
            raise UnsupportedError(
                "mimicking joints beside joints that turn in space are simulated by the native dynamics alone"
            )
        q0, qd0 = vectors(n, q0=q0, qd0=qd0)
        time = sample_times(time)
        forces, step = held_forces(tau, time.size, n), positive_step(step)
        soft = soft_joints(self.system, np.asarray(np.linalg.inv(self.mass_matrix(np.zeros(n)))), rubbing=True)
        if soft is not None:
            position, velocity = soft_march(self, soft, q0, qd0, time, forces, step=step)
        else:
            position, velocity = march(self.forward_dynamics, q0, qd0, time, forces, step)
        return Trajectory(time=time, names=self.names, position=position, velocity=velocity)

    def frequencies(self, q: Array) -> Array:
        del q
        raise UnsupportedError("natural frequencies with mimicking joints are those of the native dynamics alone")


def couple(system: System, model: EngineModel, names: tuple[str, ...], positions: tuple[str, ...]) -> CoupledModel:
    """The model of ``without_mimics(system)``, with velocities ``names`` and ``positions``, as one of the system."""
    own, own_positions = system.coordinate_names, system.position_names
    leaders = {joint.name: followed(system, joint) for joint in system.joints if joint.mimic is not None}
    rates = np.zeros((len(names), len(own)))
    for k, name in enumerate(names):
        leader, multiplier, _ = leaders.get(name, (name, 1.0, 0.0))
        rates[k, own.index(leader)] = multiplier
    of = [leaders.get(name, (name, 1.0, 0.0)) for name in positions]
    return CoupledModel(
        own,
        own_positions,
        model,
        rates,
        np.array([own_positions.index(leader) for leader, _, _ in of], dtype=np.intp),
        np.array([multiplier for _, multiplier, _ in of]),
        np.array([offset for _, _, offset in of]),
        system,
    )
