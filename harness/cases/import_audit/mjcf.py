"""Fields of an MJCF: MuJoCo runs the file as it stands, and again with one kind of field switched off."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from harness.cases.case import Array
from harness.cases.import_audit.ignored import (
    ACTS,
    ALONE,
    DURATION,
    IGNORED,
    KEPT,
    SAMPLES,
    Ignored,
    random_states,
    readers,
    start,
)
from harness.engines.readers.mujoco import read_by_mujoco
from harness.system import System
from harness.system.mjcf_left_out import disabled, uniform_compensation

_STEP = 5e-4  # of MuJoCo's runs [s], by its RK4
_HOW = "MuJoCo's runs of the file with the field and without it"


@dataclass(frozen=True)
class Kind:
    """A kind of field: whether a model has it, how it is switched off, and what the readers make of it."""

    name: str
    value: str
    off: Callable[[Any], None]
    denoc: str = IGNORED
    pinocchio: str = IGNORED


def mjcf_fields(path: Path, system: System, allow: Sequence[Path] = (), following: int = 0) -> Iterator[Ignored]:
    """One row for each kind of field that the file has and some reader passes over; following: equalities that act here."""
    whole = read_by_mujoco(path, system, allow=allow)
    full = _compiled_again(path, system, allow)
    base = _behaviour(full, whole.joints, system)
    for kind in _kinds(full, system, following):
        model = _compiled_again(path, system, allow)
        kind.off(model)
        force, motion = _apart(base, _behaviour(model, whole.joints, system))
        yield Ignored(kind.name, path.name, kind.value, readers(kind.denoc, kind.pinocchio, ACTS), force, motion, _HOW)


def _compiled_again(path: Path, system: System, allow: Sequence[Path]) -> Any:
    import mujoco

    from harness.system.read_mjcf import compiled

    model = compiled(path, allow=allow)
    model.opt.integrator = int(mujoco.mjtIntegrator.mjINT_RK4)
    model.opt.timestep = _STEP
    return model


def _kinds(model: Any, system: System, following: int) -> Iterator[Kind]:
    """What the compiled file has of fields that not everybody reads."""
    import mujoco

    def zero(*names: str) -> Callable[[Any], None]:
        def off(changed: Any) -> None:
            for name in names:
                getattr(changed, name)[:] = 0

        return off

    def flag(name: str) -> Callable[[Any], None]:
        def off(changed: Any) -> None:
            changed.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{name}"))

        return off

    def largest(values: Any) -> float:
        return float(np.abs(values).max(initial=0.0))

    constrained = not disabled(model, "CONSTRAINT")
    if largest(model.dof_damping):
        yield Kind("joint damping", f"up to {largest(model.dof_damping):g}", zero("dof_damping"), ACTS, KEPT)
    if largest(model.dof_frictionloss) and constrained and not disabled(model, "FRICTIONLOSS"):
        value = f"up to {largest(model.dof_frictionloss):g}"
        yield Kind("joint frictionloss", value, zero("dof_frictionloss"), ACTS, KEPT)
    if largest(model.jnt_stiffness):
        yield Kind("joint stiffness", f"up to {largest(model.jnt_stiffness):g}", zero("jnt_stiffness"), ACTS, IGNORED)
    if largest(model.dof_dampingpoly[:, 0]):
        yield Kind(
            "damping, v|v|", f"up to {largest(model.dof_dampingpoly[:, 0]):g}", _column("dof_dampingpoly", 0), ACTS
        )
    if largest(model.dof_dampingpoly[:, 1]):
        yield Kind(
            "damping, v³", f"up to {largest(model.dof_dampingpoly[:, 1]):g}", _column("dof_dampingpoly", 1), ACTS
        )
    if largest(model.jnt_stiffnesspoly[:, 0]):
        value = f"up to {largest(model.jnt_stiffnesspoly[:, 0]):g}"
        yield Kind("stiffness, x²", value, _column("jnt_stiffnesspoly", 0), ACTS)
    if largest(model.jnt_stiffnesspoly[:, 1]):
        value = f"up to {largest(model.jnt_stiffnesspoly[:, 1]):g}"
        yield Kind("stiffness, x³", value, _column("jnt_stiffnesspoly", 1), ACTS)
    if np.any(model.jnt_limited) and constrained and not disabled(model, "LIMIT"):
        yield Kind("joint limits", f"of {int(np.sum(model.jnt_limited))} joint(s)", flag("LIMIT"), ALONE, KEPT)
    if np.any(model.body_gravcomp) and not disabled(model, "GRAVITY"):
        acts = "acts, as scaled gravity" if uniform_compensation(model) else "acts, but in a diagnosis"
        yield Kind("gravcomp", f"up to {largest(model.body_gravcomp):g}", _without_compensation, acts)
    if model.neq and constrained and not disabled(model, "EQUALITY"):
        acts = IGNORED
        if following:
            acts = "acts, joints follow" if following == model.neq else f"{following} of them act: joints follow"
        yield Kind("equality", f"{model.neq}", flag("EQUALITY"), acts)
    if model.ntendon:
        fields = ("tendon_stiffness", "tendon_damping", "tendon_frictionloss", "tendon_armature", "tendon_limited")
        yield Kind("tendon", f"{model.ntendon}", zero(*fields))
    if model.nactuator and not disabled(model, "ACTUATION"):
        acts = ALONE if system.actuators else IGNORED
        yield Kind("actuator, no command", f"{model.nactuator}", flag("ACTUATION"), acts)
        if largest(model.actuator_armature):
            yield Kind(
                "actuator armature", f"up to {largest(model.actuator_armature):g}", zero("actuator_armature"), ACTS
            )
        if largest(model.actuator_damping) or largest(model.actuator_dampingpoly):
            yield Kind("actuator damping", "", zero("actuator_damping", "actuator_dampingpoly"), ACTS)
    touching = int(np.sum((model.geom_contype != 0) | (model.geom_conaffinity != 0)))
    if (touching > 1 or model.npair) and constrained and not disabled(model, "CONTACT"):
        pairs = f", {model.npair} named pair(s)" if model.npair else ""
        yield Kind("contact", f"{touching} geoms{pairs}", flag("CONTACT"))
    if model.opt.density or model.opt.viscosity:

        def still(changed: Any) -> None:
            changed.opt.density = changed.opt.viscosity = 0.0

        yield Kind("fluid", f"density {model.opt.density:g}, viscosity {model.opt.viscosity:g}", still)


def _column(name: str, column: int) -> Callable[[Any], None]:
    def off(model: Any) -> None:
        getattr(model, name)[:, column] = 0.0

    return off


def _without_compensation(model: Any) -> None:
    model.body_gravcomp[:] = 0.0


def _behaviour(model: Any, joints: Sequence[int], system: System) -> tuple[Array, Array]:
    """Joint forces that would give no acceleration, at random states, (B, n), and positions of a run from rest, (T, n)."""
    import mujoco

    data = mujoco.MjData(model)
    places = [int(model.jnt_qposadr[k]) for k in joints]
    dofs = [int(model.jnt_dofadr[k]) for k in joints]
    forces = []
    for q, qd, qdd in zip(*random_states(system), strict=True):
        mujoco.mj_resetData(model, data)
        data.qpos[places], data.qvel[dofs] = q, qd
        # Commands of drives are not constraints: what they push at rest of command is taken off inverse dynamics.
        mujoco.mj_forward(model, data)
        pushed = np.array(data.qfrc_actuator)
        data.qacc[dofs] = qdd
        mujoco.mj_inverse(model, data)
        forces.append((data.qfrc_inverse - pushed)[dofs])
    mujoco.mj_resetData(model, data)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    else:
        data.qpos[places] = start(system)
    steps = round(DURATION / _STEP / (SAMPLES - 1))
    run = [np.array(data.qpos[places])]
    for _ in range(SAMPLES - 1):
        mujoco.mj_step(model, data, nstep=steps)
        run.append(np.array(data.qpos[places]))
    return np.array(forces), np.array(run)


def _apart(a: tuple[Array, Array], b: tuple[Array, Array]) -> tuple[float | None, float | None]:
    force, motion = (float(np.abs(x - y).max()) for x, y in zip(a, b, strict=True))
    return (force if np.isfinite(force) else None), (motion if np.isfinite(motion) else None)
