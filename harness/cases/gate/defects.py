"""Defects that the gate plants in the native engine to see whether it notices: one a way to be wrong."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.cases.case import Array
from harness.engines.protocol import Engine, EngineModel
from harness.system import System, Trajectory
from harness.system.description import constant


@dataclass(frozen=True)
class Defect:
    """A defect and what it should be called.

    term: the term of the dynamics that must be blamed first; empty if the accelerations stay right or are none.
    words, at: must occur in what the gate says about it; the latter is the link or joint that it is at.
    spoil: the system the native engine gets instead of the true one.
    wrap: what becomes of the native model.
    """

    name: str
    term: str
    words: str
    spoil: Callable[[System], System] = lambda system: system
    wrap: Callable[[EngineModel], Any] = lambda model: model
    at: str = ""


class Spoiled:
    """A model whose chosen answers are wrong; all others are passed on."""

    def __init__(self, model: EngineModel, **wrong: Callable[..., Any]) -> None:
        self._model = model
        self._wrong = wrong

    def __getattr__(self, name: str) -> Any:
        return self._wrong.get(name) or getattr(self._model, name)


@dataclass(frozen=True)
class SpoiledEngine:
    """The native engine with a defect."""

    true: Engine
    defect: Defect
    name: str = "denoc"

    def version(self) -> str:
        return self.true.version()

    def refuses(self, system: System) -> str | None:
        return self.true.refuses(system)

    def build(self, system: System) -> Any:
        return self.defect.wrap(self.true.build(self.defect.spoil(system)))


def _middle(system: System) -> str:
    return system.links[len(system.links) // 2].name


def _heavier(system: System) -> System:
    link = system.link(_middle(system))
    return system.replace_link(replace(link, mass=link.mass * (1.0 + 1e-6)))


def _rounder(system: System) -> System:
    link = system.link(_middle(system))
    return system.replace_link(replace(link, inertia=constant(np.asarray(link.inertia) * (1.0 + 1e-6))))


def _shifted(system: System) -> System:
    link = system.link(_middle(system))
    return system.replace_link(replace(link, com=constant(np.asarray(link.com) + np.array([1e-6, 0.0, 0.0]))))


def _without(name: str) -> Callable[[System], System]:
    def spoil(system: System) -> System:
        changes: dict[str, Any] = {name: 0.0}
        return replace(system, joints=tuple(replace(joint, **changes) for joint in system.joints))

    return spoil


def _gravity(factor: float) -> Callable[[System], System]:
    return lambda system: replace(system, gravity=constant(np.asarray(system.gravity) * factor))


def _tilted(system: System) -> System:
    joint = system.movable_joints[len(system.movable_joints) // 2]
    axis = np.asarray(joint.axis) + 1e-6 * np.roll(np.asarray(joint.axis), 1) + np.array([0.0, 0.0, 1e-6])
    return system.replace_joint(replace(joint, axis=constant(axis / np.linalg.norm(axis))))


def _no_coriolis(model: EngineModel) -> Spoiled:
    """Everything without the forces that are quadratic in velocities."""

    def coriolis(q: Array, qd: Array) -> Array:
        return np.asarray(model.bias(q, qd)) - np.asarray(model.gravity(q))

    def forward(q: Array, qd: Array, tau: Array) -> Array:
        return np.asarray(model.forward_dynamics(q, qd, np.asarray(tau) + coriolis(q, qd)))

    return Spoiled(
        model,
        bias=lambda q, qd: np.asarray(model.gravity(q)),
        forward_dynamics=forward,
        inverse_dynamics=lambda q, qd, qdd: np.asarray(model.inverse_dynamics(q, qd, qdd)) - coriolis(q, qd),
    )


def _sloppy_solution(model: EngineModel) -> Spoiled:
    """Accelerations a billionth off, every term being right."""
    return Spoiled(
        model, forward_dynamics=lambda q, qd, tau: np.asarray(model.forward_dynamics(q, qd, tau)) * (1.0 + 1e-8)
    )


def _not_a_number(model: EngineModel) -> Spoiled:
    return Spoiled(
        model, forward_dynamics=lambda q, qd, tau: np.full_like(np.asarray(model.forward_dynamics(q, qd, tau)), np.nan)
    )


def _coarse_output(model: EngineModel) -> Spoiled:
    """Right equations and steps, and straight lines drawn between samples a twentieth of a second apart."""

    def simulate(q0: Array, qd0: Array, time: Array, **options: Any) -> Trajectory:
        coarse = np.union1d(np.arange(time[0], time[-1], 0.05), time[-1:])
        run = model.simulate(q0, qd0, coarse, **options)
        columns = range(len(run.names))
        position = np.column_stack([np.interp(time, coarse, run.position[:, k]) for k in columns])
        velocity = np.column_stack([np.interp(time, coarse, run.velocity[:, k]) for k in columns])
        return Trajectory(time, run.names, position, velocity)

    return Spoiled(model, simulate=simulate)


DEFECTS = (
    Defect("mass of one link a millionth too large", "mass_matrix", "mass of link", spoil=_heavier, at="link3"),
    Defect("inertia of one link a millionth too large", "mass_matrix", "inertia of link", spoil=_rounder, at="link3"),
    Defect("centre of mass of one link a micrometre off", "mass_matrix", "com of link", spoil=_shifted, at="link3"),
    Defect("axis of one joint a microradian off", "mass_matrix", "axis of joint", spoil=_tilted, at="joint3"),
    Defect("armature forgotten", "armature", "armature", spoil=_without("armature")),
    Defect("damping forgotten", "damping", "damping", spoil=_without("damping")),
    Defect("gravity with the other sign", "gravity", "other sign", spoil=_gravity(-1.0)),
    Defect("gravity a tenth of a millionth too large", "gravity", "times", spoil=_gravity(1.0 + 1e-7)),
    Defect("Coriolis and centrifugal forces missing", "coriolis", "missing", wrap=_no_coriolis),
    Defect("equations solved a hundred-millionth off", "solution", "does not solve", wrap=_sloppy_solution),
    Defect("accelerations that are no numbers", "", "not a finite number", wrap=_not_a_number),
    Defect("motion interpolated too coarsely", "", "integration", wrap=_coarse_output),
)
