"""What a model does not answer, from what it does: the terms of the dynamics of an engine that has few methods.

An engine may have its forward or its inverse dynamics alone. Each is the whole equation of motion, M q'' + h(q, q') = τ, with
passive forces in h: columns of M are what a unit of acceleration takes more; h at rest is gravity less the springs, which are taken
as the other model has them; what is the same forwards and backwards is of Coriolis, and the rest is damping.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.engines.protocol import EngineModel
from harness.errors import UnsupportedError
from harness.system import Trajectory

Array = NDArray[np.float64]


class Few:
    """A model that has some methods alone, given by name; any other raises UnsupportedError. See ``EngineModel``."""

    def __init__(self, names: tuple[str, ...], **methods: Callable[..., Array]) -> None:
        self.names = names
        for name, method in methods.items():
            setattr(self, name, method)

    def __getattr__(self, name: str) -> Any:
        raise UnsupportedError(f"there is no {name.replace('_', ' ')}")


@dataclass(frozen=True, eq=False)
class Completed:
    """A model with what it has no method for; beside: the model whose springs it is taken to have. See ``EngineModel``."""

    model: EngineModel
    beside: EngineModel

    @property
    def names(self) -> tuple[str, ...]:
        return self.model.names

    def mass_matrix(self, q: Array) -> Array:
        return self._or(lambda: self.model.mass_matrix(q), lambda: self._mass(q))

    def gravity(self, q: Array) -> Array:
        return self._or(lambda: self.model.gravity(q), lambda: self._held(q) + self._springs(q))

    def bias(self, q: Array, qd: Array) -> Array:
        def even() -> Array:
            still = np.zeros_like(qd)
            there, back = self.inverse_dynamics(q, qd, still), self.inverse_dynamics(q, -qd, still)
            return 0.5 * (there + back) + self._springs(q)

        return self._or(lambda: self.model.bias(q, qd), even)

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        def solved() -> Array:
            return np.asarray(self.mass_matrix(q) @ (qdd - self.model.forward_dynamics(q, qd, np.zeros_like(qd))))

        return self._or(lambda: self.model.inverse_dynamics(q, qd, qdd), solved)

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        def solved() -> Array:
            left = tau - self.model.inverse_dynamics(q, qd, np.zeros_like(qd))
            return np.asarray(np.linalg.solve(self.mass_matrix(q), left))

        return self._or(lambda: self.model.forward_dynamics(q, qd, tau), solved)

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        return self.model.energy(q, qd)

    def frequencies(self, q: Array) -> Array:
        return self.model.frequencies(q)

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        return self.model.simulate(q0, qd0, time, tau=tau, step=step)

    def weighs_apart(self, q: Array) -> bool:
        """Whether its weight is an answer of its own; else it is all that acts at rest but the springs of the other."""
        try:
            self.model.gravity(q)
        except UnsupportedError:
            return False
        return True

    def _mass(self, q: Array) -> Array:
        n = len(self.names)
        still = np.zeros(n)

        def by_accelerations() -> Array:
            held = self.model.inverse_dynamics(q, still, still)
            return np.array([self.model.inverse_dynamics(q, still, unit) - held for unit in np.eye(n)]).T

        def by_forces() -> Array:
            free = self.model.forward_dynamics(q, still, still)
            return np.linalg.inv(np.array([self.model.forward_dynamics(q, still, unit) - free for unit in np.eye(n)]).T)

        return self._or(by_accelerations, by_forces)

    def _held(self, q: Array) -> Array:
        still = np.zeros(len(self.names))
        return self.inverse_dynamics(q, still, still)

    def _springs(self, q: Array) -> Array:
        """Force of the springs [N·m or N]."""
        still = np.zeros(len(self.names))
        return np.asarray(self.beside.gravity(q)) - np.asarray(self.beside.inverse_dynamics(q, still, still))

    @staticmethod
    def _or(asked: Callable[[], Array], derived: Callable[[], Array]) -> Array:
        try:
            return np.asarray(asked())
        except UnsupportedError:
            return np.asarray(derived())
