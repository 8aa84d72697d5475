"""One protocol for every engine, so that a comparison need not know whom it asks.

Arrays follow ``System.coordinate_names`` (joints, each followed by its link's elastic coordinates) whatever the
engine's own order is; an adapter states its permutation and sign conventions as one commented transform.
An engine that has other elastic coordinates than ours (a finite-element beam) leaves the coordinate-wise
quantities out and speaks through ``simulate`` (channels) and ``frequencies``.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from harness.system import System, Trajectory

Array = NDArray[np.float64]


class EngineError(RuntimeError):
    """An engine gave up, reset itself or answered with NaN; the message names the engine and where in time."""


@runtime_checkable
class EngineModel(Protocol):
    """One system, built in one engine. Shapes: q (nq,); qd, qdd, tau (n,); mass matrix (n, n); SI units.

    nq and n are the same but where a joint turns in space: positions follow ``System.position_names`` there.

    A quantity the engine cannot give raises ``harness.errors.UnsupportedError`` with the reason.
    """

    @property
    def names(self) -> tuple[str, ...]: ...

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        """Accelerations qdd; passive joint forces (damping, stiffness) act as well, dry friction does not."""
        ...

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        """Generalized forces that make the accelerations, passive joint forces counted as in ``forward_dynamics``."""
        ...

    def mass_matrix(self, q: Array) -> Array:
        """Generalized inertia matrix, armature included."""
        ...

    def bias(self, q: Array, qd: Array) -> Array:
        """Coriolis, centrifugal and gravity forces C(q, qd) qd + g(q), without passive joint forces."""
        ...

    def gravity(self, q: Array) -> Array:
        """Gravity forces g(q), on the left-hand side as in M qdd + C qd + g = tau."""
        ...

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        """Kinetic and potential energy [J], springs included.

        The potential is zero with every centre of mass at height zero, and links that cannot move do not count.
        """
        ...

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """Motion from (q0, qd0) at time[0], sampled at ``time``; tau (T, n), held between samples."""
        ...

    def frequencies(self, q: Array) -> Array:
        """Natural frequencies of small motion about q [Hz], ascending, unstable ones left out."""
        ...


@runtime_checkable
class Engine(Protocol):
    """A dynamics engine as the harness sees it."""

    name: str

    def version(self) -> str:
        """Installed version; raises ``EngineUnavailableError`` if it is not installed."""
        ...

    def refuses(self, system: System) -> str | None:
        """Why this engine cannot express the system, or None."""
        ...

    def build(self, system: System) -> EngineModel:
        """The system in this engine."""
        ...
