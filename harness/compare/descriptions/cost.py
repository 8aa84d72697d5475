"""What a difference between two descriptions costs in motion: the first one run with that one field as the second states it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.compare.descriptions.bodies import Body, assembled
from harness.compare.descriptions.compare import Comparison
from harness.compare.descriptions.fields import Difference
from harness.engines.expressed import realised
from harness.engines.protocol import EngineError, EngineModel
from harness.engines.registry import engine
from harness.errors import InputError
from harness.recording.units import written
from harness.system import System, Trajectory
from harness.system.description import Array

DURATION = 1.0  # s
_SAMPLES = 101
# Where the run starts: joints that turn and joints that slide.
_TURNED, _TURNING = 0.5, 1.0  # rad, rad/s
_SHIFTED, _SLIDING = 0.1, 0.2  # m, m/s
# Of what a joint travels, and of the forces of the motion: less than this is rounding, and costs nothing.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Cost:
    """What differences cost in a second of free motion from a raised pose.

    joint, apart, unit: where the two motions come apart most, and how far [rad or m]; travelled: how far that joint moves.
    forced, force, force_unit: the joint at which the same motion takes the most other force, and how much [N·m or N]; dry
    friction is not counted in it. reason: why nothing could be said, else empty.
    """

    joint: str = ""
    apart: float = 0.0
    unit: str = "rad"
    travelled: float = 0.0
    forced: str = ""
    force: float = 0.0
    force_unit: str = "N·m"
    reason: str = ""
    motions: tuple[Trajectory, Trajectory] | None = None

    def __str__(self) -> str:
        if self.reason:
            return f"its cost in motion is not known: {self.reason}"
        told = []
        if self.apart > 0.0:
            told.append(
                f"moves {self.joint} by up to {self.apart:.2g} {self.unit} within {DURATION:g} s of free motion "
                f"over {self.travelled:.2g} {self.unit}"
            )
        if self.force > 0.0:
            told.append(f"takes up to {self.force:.2g} {self.force_unit} more or less at {self.forced}")
        return " and ".join(told) or "costs nothing in free motion"


def costs(comparison: Comparison, differences: Sequence[Difference]) -> tuple[list[Cost | None], Cost]:
    """The cost of each difference alone, None where it acts on no motion, and of all of them together."""
    try:
        plain = _Run(assembled(comparison.first, comparison.system))
    except (InputError, EngineError) as error:
        unknown = Cost(reason=_reason(error))
        return [unknown for _ in differences], unknown
    alone = [_cost(plain, comparison, [d]) if _acts(d) else None for d in differences]
    return alone, _cost(plain, comparison, [d for d in differences if _acts(d)])


def _acts(difference: Difference) -> bool:
    return difference.change is not None or difference.field == "gravity"


def _cost(plain: _Run, comparison: Comparison, differences: Sequence[Difference]) -> Cost:
    changed: list[Body] = list(comparison.first)
    like = comparison.system
    for difference in differences:
        if difference.field == "gravity":
            like = replace(like, gravity=comparison.gravity)
        if difference.change is not None:
            changed = difference.change(list(changed))
    try:
        return plain.against(_Run(assembled(changed, like)))
    except (InputError, EngineError) as error:
        return Cost(reason=_reason(error))


def _reason(error: Exception) -> str:
    return error.what if isinstance(error, InputError) else " ".join(str(error).split())


class _Run:
    """A second of free motion, and what makes it."""

    def __init__(self, system: System) -> None:
        self.system = system
        whole = realised(system)
        native = engine("denoc")
        reason = native.refuses(whole)
        if reason is not None:
            raise InputError(reason)
        self.model: EngineModel = native.build(whole)
        q, qd = _start(whole, self.model.names)
        self.motion = self.model.simulate(q, qd, np.linspace(0.0, DURATION, _SAMPLES))

    def against(self, other: _Run) -> Cost:
        """How far the other run comes away from this one, and the forces that would hold it to this one."""
        joints = [name for name in self.system.joint_names if name in other.motion.names]
        if not joints:
            return Cost(reason="no joint moves")
        mine, theirs = (
            run.motion.position[:, [run.motion.names.index(name) for name in joints]] for run in (self, other)
        )
        apart = np.abs(mine - theirs).max(axis=0)
        travelled = np.ptp(mine, axis=0)
        apart[apart <= _ROUNDING * travelled] = 0.0
        # Radians and metres are held against what each joint travels, so that neither drowns the other.
        worst = int(np.argmax(apart / np.maximum(travelled, 1e-3)))
        force = self._forces(other, joints)
        forced = int(np.argmax(force))
        joint, driven = self.system.joint(joints[worst]), self.system.joint(joints[forced])
        return Cost(
            joint.name, float(apart[worst]), joint.position_unit, float(travelled[worst]),
            driven.name, float(force[forced]), written(driven.force_unit),
            motions=(self.motion, other.motion),
        )  # fmt: skip

    def _forces(self, other: _Run, joints: Sequence[str]) -> Array:
        if self.model.names != other.model.names or self.motion.names != self.model.names:
            return np.zeros(len(joints))
        columns = [self.model.names.index(name) for name in joints]
        largest, own = np.zeros(len(joints)), 0.0
        for q, qd in zip(self.motion.position[::5], self.motion.velocity[::5], strict=True):
            qdd = self.model.forward_dynamics(q, qd, np.zeros(len(q)))
            needed = other.model.inverse_dynamics(q, qd, qdd) - self.model.inverse_dynamics(q, qd, qdd)
            largest = np.maximum(largest, np.abs(np.asarray(needed)[columns]))
            own = max(own, float(np.abs(self.model.bias(q, qd)).max()))
        largest[largest <= _ROUNDING * own] = 0.0
        return largest


def _start(system: System, names: Sequence[str]) -> tuple[Array, Array]:
    q, qd = np.zeros(len(names)), np.zeros(len(names))
    for joint in system.movable_joints:
        if joint.name in names:
            raised = _SHIFTED if joint.prismatic else _TURNED
            column = list(names).index(joint.name)
            q[column] = float(np.clip(raised, joint.lower, joint.upper))
            qd[column] = _SLIDING if joint.prismatic else _TURNING
    return q, qd
