"""A field that a reader passes over, and how what it costs is measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from harness.cases.case import Array
from harness.denoc import Denoc
from harness.engines.denoc_native import Native
from harness.errors import UnsupportedError
from harness.system import System
from harness.system.check import check_dynamics

ACTS, KEPT, IGNORED = "acts", "kept, never acts", "ignored"
ALONE = "in single runs and a diagnosis alone"
# A run of this length [s] from rest in one pose, sampled so; forces at as many random states.
DURATION, SAMPLES, STATES = 2.0, 201, 8


@dataclass(frozen=True)
class Ignored:
    """One field at one place, and what denoc, Pinocchio and MuJoCo make of it.

    force: largest change of a joint force that the field makes, at random states [N·m, or N of a sliding joint]; motion: largest
    change of a joint position in two seconds from rest [rad or m]; None where that cannot be asked. how: what was compared.
    units: of force and motion, by what joints the model has.
    """

    field: str
    site: str
    value: str
    readers: Mapping[str, str]
    force: float | None
    motion: float | None
    how: str
    units: tuple[str, str] = ("N·m or N", "rad or m")


def as_dict(row: Ignored) -> dict[str, Any]:
    """The row as plain values."""
    return {**asdict(row), "readers": dict(row.readers), "units": list(row.units)}


def units_of(system: System) -> tuple[str, str]:
    """Units of force and motion of a system's joints."""
    sliding = {joint.prismatic for joint in system.movable_joints}
    if len(sliding) > 1:
        return "N·m or N", "rad or m"
    return ("N", "m") if True in sliding else ("N·m", "rad")


def readers(denoc: str, pinocchio: str, mujoco: str) -> dict[str, str]:
    return {"denoc": denoc, "pinocchio": pinocchio, "mujoco": mujoco}


def start(system: System) -> Array:
    """A pose inside the limits, the same at every call, a third of the way from the middle to one side or the other."""
    rng = np.random.default_rng(48)
    low, high = limits(system)
    return np.asarray(0.5 * (low + high) + (high - low) / 6.0 * rng.choice([-1.0, 1.0], len(low)))


def limits(system: System) -> tuple[Array, Array]:
    """Where each joint may be [rad or m]: its limits, or a quarter turn (30 cm) either way."""
    ends = []
    for joint in system.movable_joints:
        wide = 0.3 if joint.prismatic else 0.5 * np.pi
        bounded = np.isfinite(joint.lower) and np.isfinite(joint.upper) and joint.lower < joint.upper
        ends.append((joint.lower, joint.upper) if bounded else (-wide, wide))
    low, high = np.array(ends).T
    return low, high


def random_states(system: System) -> tuple[Array, Array, Array]:
    """Positions inside the limits, velocities and accelerations of size one, each shape (STATES, n)."""
    rng = np.random.default_rng(49)
    low, high = limits(system)
    q = low + (high - low) * rng.uniform(0.05, 0.95, (STATES, len(low)))
    return q, rng.standard_normal(q.shape), rng.standard_normal(q.shape)


def cost_natively(without: System, with_it: System) -> tuple[float | None, float | None]:
    """Force and motion that part two descriptions of one mechanism, by the native dynamics."""
    if Native().refuses(without) or Native().refuses(with_it):
        return None, None
    a, b = Native().build(without), Native().build(with_it)
    q, qd, qdd = random_states(without)
    force = max(
        float(np.abs(a.inverse_dynamics(x, v, w) - b.inverse_dynamics(x, v, w)).max())
        for x, v, w in zip(q, qd, qdd, strict=True)
    )
    # Inverse dynamics leaves dry friction out, which acts in runs alone.
    force = max(
        force,
        *(abs(i.friction - j.friction) for i, j in zip(without.movable_joints, with_it.movable_joints, strict=True)),
    )
    first, second = (free_run(system) for system in (without, with_it))
    if first is None or second is None:
        return force, None
    return force, float(np.abs(first - second).max())


def free_run(system: System) -> Array | None:
    """Positions over two seconds from rest in the starting pose, shape (SAMPLES, n); None where no run is possible."""
    try:
        check_dynamics(system)
        time = np.linspace(0.0, DURATION, SAMPLES)
        q0 = start(system)
        return np.asarray(Denoc(system).simulate(q0, np.zeros_like(q0), time).position)
    except (UnsupportedError, FloatingPointError, ArithmeticError):
        return None
