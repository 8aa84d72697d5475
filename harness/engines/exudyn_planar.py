"""What Exudyn's two kinds of planar finite-element beams share: what they are asked for, and how their motion is told.

The finite elements have other elastic coordinates than ours, so both speak through ``simulate`` (joint positions,
``<link>.tip_deflection``) and ``frequencies``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from harness.engines.checked import held_forces, positive_step, sample_times, vectors
from harness.engines.exudyn_joint import held_torques
from harness.engines.exudyn_run import exudyn_package, grid, quiet, settings, solve_dynamic
from harness.engines.planar import PlanarChain, PlanarLink, planar_chain, why_not_planar
from harness.engines.protocol import Array
from harness.errors import UnsupportedError
from harness.system import System, Trajectory


@dataclass(frozen=True, eq=False)
class LinkMotion:
    """Turn from the zero pose [rad] and its rate [rad/s] of a link at its joint and at its end, each (T,).

    deflection: of a beam's tip from the tangent at its root, positive along ``bending`` [m], (T,); None of a rigid link.
    """

    turn: Array
    rate: Array
    end_turn: Array
    end_rate: Array
    deflection: Array | None = None


@dataclass(frozen=True, eq=False)
class PlanarBeamModel(ABC):
    """A planar chain of finite-element beams and rigid bodies in Exudyn; elements: on each beam; see ``EngineModel``."""

    names: tuple[str, ...]
    system: System
    chain: PlanarChain
    elements: int

    engine: ClassVar[str]
    default_step: ClassVar[float]

    def _silent(self, quantity: str) -> UnsupportedError:
        return UnsupportedError(f"{self.engine} gives no {quantity}: its elastic coordinates are other than ours")

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        raise self._silent("accelerations")

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        raise self._silent("generalized forces")

    def mass_matrix(self, q: Array) -> Array:
        raise self._silent("mass matrix")

    def bias(self, q: Array, qd: Array) -> Array:
        raise self._silent("bias forces")

    def gravity(self, q: Array) -> Array:
        raise self._silent("gravity forces")

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        raise self._silent("energy")

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """Generalized-α with steps of at most ``step`` [s]; elastic coordinates are not given and stand as NaN.

        q0, qd0 count in our coordinates (n,); time (T,) [s].
        tau: torques (T, n) at the joints, held between samples; zero on the elastic coordinates.
        Raises UnsupportedError for forces on elastic coordinates and for a start that the elements cannot express,
        EngineError where the solver gives up.
        """
        n = len(self.names)
        q0, qd0 = vectors(n, q0=q0, qd0=qd0)
        time = sample_times(time)
        forces = held_forces(tau, time.size, n)
        if forces is not None and np.any(forces[:, self._elastic]):
            raise UnsupportedError(f"{self.engine} takes torques at joints, not forces on elastic coordinates")
        self._check_start(q0, qd0)
        if time.size == 1:
            raise UnsupportedError(f"{self.engine} needs at least two samples of time")
        exudyn = exudyn_package()
        since = time - time[0]
        steps, every = grid(time, positive_step(step) or self.default_step)
        with quiet(exudyn):
            built = self._build(exudyn, q0, qd0, held_torques(self.chain, since, forces))
            relative, absolute = self._tolerances()
            made = settings(exudyn, float(since[-1]), steps, every, relative=relative, absolute=absolute)
            solve_dynamic(exudyn, built.mbs, made)
            return self._trajectory(built, time, since, q0)

    @property
    def _elastic(self) -> Array:
        return np.concatenate([link.elastic for link in self.chain.links])

    @abstractmethod
    def _check_start(self, q0: Array, qd0: Array) -> None:
        """Raise UnsupportedError for an initial state that the elements cannot express."""

    @abstractmethod
    def _tolerances(self) -> tuple[float, float]:
        """Relative and absolute tolerance of Newton's residual [N]."""

    @abstractmethod
    def _build(self, exudyn: Any, q: Array, qd: Array, torques: dict[int, Callable[[float], float]]) -> Any:
        """The Exudyn system ``mbs`` in a state, with torques over time on the joints of links by their index."""

    @abstractmethod
    def _motion(self, built: Any, k: int, since: Array) -> LinkMotion:
        """What the sensors of a link stored, at times from the start [s], (T,)."""

    def _trajectory(self, built: Any, time: Array, since: Array, q0: Array) -> Trajectory:
        position, velocity = (np.full((len(time), len(self.names)), np.nan) for _ in range(2))
        motions = [self._motion(built, k, since) for k in range(len(self.chain.links))]
        channels: dict[str, Array] = {}
        for link, motion in zip(self.chain.links, motions, strict=True):
            if motion.deflection is not None:
                channels[f"{link.link.name}.tip_deflection"] = motion.deflection
        for link, motion in zip(self.chain.links, motions, strict=True):
            if link.coordinate < 0:
                continue
            before = motions[link.parent] if link.parent >= 0 else None
            angle = link.sign * (motion.turn - (before.end_turn if before else 0.0))
            # Whole turns are not to be seen in a direction; the run starts where it was told to.
            angle += 2.0 * np.pi * np.round((q0[link.coordinate] - angle[0]) / (2.0 * np.pi))
            position[:, link.coordinate] = angle
            velocity[:, link.coordinate] = link.sign * (motion.rate - (before.end_rate if before else 0.0))
            channels[f"{link.joint.name}.position"] = angle
        return Trajectory(time=time, names=self.names, position=position, velocity=velocity, channels=channels)


def bending_side(link: PlanarLink) -> float:
    """Which way a positive deflection lies: 1 where ``bending`` is the normal to the left of ``direction``, else -1."""
    return float(np.sign(link.direction[0] * link.bending[1] - link.direction[1] * link.bending[0]))


def refuses_planar_beams(engine: str, system: System, refuses_beam: Callable[[PlanarLink], str | None]) -> str | None:
    """Why an engine of planar finite-element beams cannot express a system, or None; refuses_beam: why not a beam."""
    if not system.flexible:
        return "the system has no elastic link"
    if system.loops:
        return f"{engine} has no loops"
    if not system.simple:
        return f"{engine} has joints of one independent degree of freedom each alone"
    if system.attachments:
        return f"{engine} cannot express the effect {system.attachments[0].effect}"
    reason = why_not_planar(system)
    if reason:
        return reason
    for link in planar_chain(system).links:
        reason = _refuses_joint(engine, system, link) or (refuses_beam(link) if link.data is not None else None)
        if reason:
            return reason
    return None


def _refuses_joint(engine: str, system: System, link: PlanarLink) -> str | None:
    joint = link.joint
    if joint.friction or joint.stiffness:
        return f"{engine} models neither dry friction nor a spring at joint {joint.name!r}"
    parent = system.links[link.parent] if link.parent >= 0 else None
    if parent is not None and parent.beam is not None:
        off = joint.xyz - parent.beam.length * parent.beam.direction
        if float(np.linalg.norm(off)) > 1e-9 * parent.beam.length:
            return f"joint {joint.name!r} does not sit at the tip of {parent.name!r}"
    return None
