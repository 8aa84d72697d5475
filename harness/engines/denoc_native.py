"""The native DeNOC dynamics as an engine; its conventions are the project's, so there is nothing to transform."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.engines.checked import held_forces, positive_step, sample_times, vector, vectors
from harness.engines.protocol import Array
from harness.errors import UnsupportedError
from harness.system import System, Trajectory


@dataclass(frozen=True, eq=False)
class NativeModel:
    """A system in the native dynamics; see ``EngineModel``. ``model`` is the ``harness.denoc.Denoc``."""

    names: tuple[str, ...]
    system: System
    model: Any

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        q, qd, tau = vectors(len(self.names), q=q, qd=qd, tau=tau)
        return np.asarray(self.model.forward_dynamics(q, qd, tau))

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        q, qd, qdd = vectors(len(self.names), q=q, qd=qd, qdd=qdd)
        return np.asarray(self.model.inverse_dynamics(q, qd, qdd))

    def mass_matrix(self, q: Array) -> Array:
        return np.asarray(self.model.mass_matrix(vector("q", q, len(self.names))))

    def bias(self, q: Array, qd: Array) -> Array:
        q, qd = vectors(len(self.names), q=q, qd=qd)
        return np.asarray(self.model.bias(q, qd))

    def gravity(self, q: Array) -> Array:
        return np.asarray(self.model.gravity(vector("q", q, len(self.names))))

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        q, qd = vectors(len(self.names), q=q, qd=qd)
        kinetic, potential = self.model.energy(q, qd)
        return float(kinetic), float(potential)

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """RK4 with steps of at most ``step`` [s], or the adaptive method if it is None."""
        n = len(self.names)
        q0, qd0 = vectors(n, q0=q0, qd0=qd0)
        time = sample_times(time)
        forces = held_forces(tau, time.size, n)
        trajectory: Trajectory = self.model.simulate(q0, qd0, time, tau=forces, step=positive_step(step))
        return trajectory

    def frequencies(self, q: Array) -> Array:
        return np.asarray(self.model.frequencies(vector("q", q, len(self.names))))


@dataclass(frozen=True)
class Native:
    """The native DeNOC dynamics as an ``Engine``."""

    name: str = "denoc"

    def version(self) -> str:
        from harness import __version__

        return __version__

    def refuses(self, system: System) -> str | None:
        if not system.coordinate_names:
            return "the system has no movable joint and no elastic link"
        return None

    def build(self, system: System) -> NativeModel:
        """The system compiled; raises UnsupportedError if the native dynamics does not model it."""
        reason = self.refuses(system)
        if reason:
            raise UnsupportedError(reason, source=system.source)
        from harness.denoc import Denoc

        return NativeModel(names=system.coordinate_names, system=system, model=Denoc(system))
