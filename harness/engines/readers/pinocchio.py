"""Pinocchio's own reading: URDF by urdfdom, MJCF by its own reader, which knows the greater part of the format."""

from __future__ import annotations

import os
import tempfile
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from harness.engines.pinocchio_axes import Axes, axes_of
from harness.engines.pinocchio_model import _pinocchio
from harness.engines.protocol import Array
from harness.engines.readers.reading import Placed
from harness.errors import UnsupportedError
from harness.system import JointType, System
from harness.system.lowering import neutral_position
from harness.system.read_urdf import ROOT_JOINT

_output = threading.Lock()


@contextmanager
def _captured() -> Iterator[list[str]]:
    """What C++ code writes to standard output and error, as lines, instead of on the user's terminal."""
    said: list[str] = []
    with _output, tempfile.TemporaryFile() as file:
        kept = [os.dup(1), os.dup(2)]
        try:
            os.dup2(file.fileno(), 1)
            os.dup2(file.fileno(), 2)
            yield said
        finally:
            for place, copy in enumerate(kept, start=1):
                os.dup2(copy, place)
                os.close(copy)
            file.seek(0)
            said += [line.strip() for line in file.read().decode("utf-8", "replace").splitlines() if line.strip()]


@dataclass(frozen=True, eq=False)
class PinocchioReading:
    """See ``Reading``. joints: Pinocchio's index of each of ``names``. zero: our positions where nothing is turned or shifted."""

    names: tuple[str, ...]
    model: Any
    data: Any
    joints: tuple[int, ...]
    axes: Axes
    zero: Array

    @cached_property
    def _bare(self) -> Any:
        """The model without armature, which resists no rate of what turns."""
        bare = _pinocchio().Model(self.model)
        bare.armature = np.zeros(self.model.nv)
        return bare

    def mass_matrix(self, q: Array) -> Array:
        return self.axes.mass_out(q, _pinocchio().crba(self.model, self.data, self.axes.position(q)))

    def bias(self, q: Array, qd: Array) -> Array:
        idle = self.axes.acceleration_into(q, qd, np.zeros_like(qd))
        rates = self.axes.into(q, qd)
        values = _pinocchio().rnea(self._bare, self.data, self.axes.position(q), rates, idle)
        return self.axes.out(q, values.copy())

    def gravity(self, q: Array) -> Array:
        values = _pinocchio().computeGeneralizedGravity(self.model, self.data, self.axes.position(q))
        return self.axes.out(q, values.copy())

    def placed(self) -> tuple[Placed, ...]:
        pin = _pinocchio()
        q = self.axes.position(self.zero)
        pin.forwardKinematics(self.model, self.data, q, np.zeros(self.model.nv))
        # One column comes as a vector.
        jacobian = np.reshape(pin.computeJointJacobians(self.model, self.data, q), (6, self.model.nv))
        found = []
        for name, k in zip(self.names, self.joints, strict=True):
            frame, inertia = self.data.oMi[k], self.model.inertias[k]
            column = np.array(jacobian[:, self.model.joints[k].idx_v])
            # World columns are (linear, angular) of the point at the world's origin.
            prismatic = float(np.linalg.norm(column[3:])) < 0.5
            several = {3: "ball", 6: "free"}.get(self.model.joints[k].nv)
            parent = self.model.parents[k]
            found.append(
                Placed(
                    name,
                    name,
                    several or ("prismatic" if prismatic else "revolute"),
                    self.joints.index(parent) if parent in self.joints else -1,
                    np.zeros(3) if several else column[:3] if prismatic else column[3:],
                    np.array(frame.translation),
                    float(inertia.mass),
                    np.array(frame.act(inertia.lever)),
                    np.array(frame.rotation @ inertia.inertia @ frame.rotation.T),
                )
            )
        return tuple(found)

    def fields(self) -> Mapping[str, Mapping[str, float]]:
        found = {}
        for name, k in zip(self.names, self.joints, strict=True):
            at, bounded = self.model.joints[k].idx_v, self.model.joints[k].nq == 1
            values = {
                "damping": float(self.model.damping[at]),
                "friction": float(self.model.friction[at]),
                "armature": float(self.model.armature[at]),
            }
            if bounded:
                q = self.model.joints[k].idx_q
                values["lower"] = float(self.model.lowerPositionLimit[q])
                values["upper"] = float(self.model.upperPositionLimit[q])
            found[name] = values
        return found


def _floats(system: System) -> bool:
    """Whether the root link floats because it was asked to, which no URDF says."""
    first = system.joints[0]
    return first.type is JointType.FREE and first.name == ROOT_JOINT


def read_by_pinocchio(path: Path, system: System, *, mjcf: bool) -> PinocchioReading:
    """The file as Pinocchio reads it; UnsupportedError with its reason where it does not, or reads other joints."""
    pin = _pinocchio()
    said: list[str] = []
    try:
        with _captured() as said:
            if mjcf:
                model = pin.buildModelFromMJCF(str(path))
            elif _floats(system):
                model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
            else:
                model = pin.buildModelFromUrdf(str(path))
    except Exception as error:
        reason = next((line.removeprefix("Error:").strip() for line in said if line.startswith("Error:")), str(error))
        raise UnsupportedError(f"Pinocchio's reader refuses the file: {' '.join(reason.split())}") from None
    index = {name: k for k, name in enumerate(model.names) if k}
    ours = {joint.name: joint for joint in system.movable_joints}
    composite = [
        model.names[k]
        for k in range(1, model.njoints)
        if model.joints[k].nv != 1
        and not (model.names[k] in ours and len(ours[model.names[k]].velocity_names) == model.joints[k].nv)
    ]
    if composite:
        raise UnsupportedError(f"Pinocchio's reader makes one joint of several: {composite[0]!r}")
    missing = [name for name in system.joint_names if name not in index]
    further = [name for name in index if name not in system.joint_names]
    if missing or further:
        parts = [
            f"passes over joint {missing[0]!r}" if missing else "",
            f"has a joint {further[0]!r}" if further else "",
        ]
        more = len(missing) + len(further) - bool(missing) - bool(further)
        raise UnsupportedError(
            f"Pinocchio's reader {' and '.join(filter(None, parts))}" + (f", and {more} more differ" if more else "")
        )
    joints = tuple(index[name] for name in system.joint_names)
    axes, zero = axes_of(model, system), neutral_position(system)
    return PinocchioReading(system.joint_names, model, pin.Data(model), joints, axes, zero)
