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
from numpy.typing import NDArray

from harness.engines.pinocchio_model import _pinocchio
from harness.engines.protocol import Array
from harness.engines.readers.reading import Placed
from harness.errors import UnsupportedError
from harness.system import JointType, System
from harness.system.read_urdf import ROOT_JOINT
from harness.system.rotation import from_quaternion

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
    """See ``Reading``. joints: Pinocchio's index of each of ``names``.

    Its quaternions have w last, and the linear velocity of its free flyer is in the child's axes, ours in the parent's.
    """

    names: tuple[str, ...]
    model: Any
    data: Any
    joints: tuple[int, ...]

    @cached_property
    def _sizes(self) -> tuple[tuple[int, int], ...]:
        """Of every joint, how many positions and velocities are ours."""
        made = [self.model.joints[k] for k in self.joints]
        return tuple((own.nv + (own.nv in (3, 6)), own.nv) for own in made)

    def _q(self, q: Array) -> Array:
        full = np.array(_pinocchio().neutral(self.model))
        first = 0
        for (positions, _), k in zip(self._sizes, self.joints, strict=True):
            own, at = q[first : first + positions], self.model.joints[k].idx_q
            if positions > 1:
                full[at : at + positions] = [*own[:-4], *own[-3:], own[-4]]
            elif self.model.joints[k].nq == 2:  # a continuous joint: cosine and sine
                full[at : at + 2] = np.cos(own[0]), np.sin(own[0])
            else:
                full[at] = own[0]
            first += positions
        return full

    @cached_property
    def _order(self) -> NDArray[np.intp]:
        return np.concatenate(
            [
                self.model.joints[k].idx_v + np.arange(count)
                for (_, count), k in zip(self._sizes, self.joints, strict=True)
            ]
        )

    def _in(self, value: Array) -> Array:
        full = np.zeros(self.model.nv)
        full[self._order] = value
        return full

    def _turns(self, q: Array) -> Array:
        """Velocities as Pinocchio has them of ours, shape (nv, nv): the linear part of a free joint in the child's axes."""
        whole = np.eye(sum(count for _, count in self._sizes))
        position = velocity = 0
        for positions, count in self._sizes:
            if count == 6:
                turn = from_quaternion(q[position + 3 : position + 7])
                whole[velocity : velocity + 3, velocity : velocity + 3] = turn.T
            position, velocity = position + positions, velocity + count
        return whole

    def _mass(self, q: Array) -> Array:
        upper = np.triu(_pinocchio().crba(self.model, self.data, self._q(q)))
        whole = upper + np.triu(upper, 1).T
        return np.asarray(whole[np.ix_(self._order, self._order)])

    def mass_matrix(self, q: Array) -> Array:
        turns = self._turns(q)
        return np.asarray(turns.T @ self._mass(q) @ turns)

    def bias(self, q: Array, qd: Array) -> Array:
        turns = self._turns(q)
        own = turns @ qd
        values = _pinocchio().nonLinearEffects(self.model, self.data, self._q(q), self._in(own))[self._order]
        if any(count == 6 for _, count in self._sizes):
            # In axes that turn, d(Rᵀ v) = Rᵀ v̇ - w × Rᵀ v: what is left of Pinocchio's accelerations where ours are zero.
            left, velocity = np.zeros_like(own), 0
            for _, count in self._sizes:
                if count == 6:
                    spin = qd[velocity + 3 : velocity + 6]
                    left[velocity : velocity + 3] = -np.cross(spin, own[velocity : velocity + 3])
                velocity += count
            values = values + self._mass(q) @ left
        return np.asarray(turns.T @ values)

    def gravity(self, q: Array) -> Array:
        values = _pinocchio().computeGeneralizedGravity(self.model, self.data, self._q(q))
        return np.asarray(self._turns(q).T @ values[self._order])

    def _zero(self) -> Array:
        """Our positions with every coordinate zero and every rotation the identity."""
        return np.concatenate([[*[0.0] * (n - 4), 1.0, 0.0, 0.0, 0.0] if n > 1 else [0.0] for n, _ in self._sizes])

    def placed(self) -> tuple[Placed, ...]:
        pin = _pinocchio()
        q = self._q(self._zero())
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
    return PinocchioReading(system.joint_names, model, pin.Data(model), joints)
