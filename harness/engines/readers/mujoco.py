"""MuJoCo's own reading, of MJCF and of URDF; shapes that no mass comes of are left closed as in our reading."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.engines.mujoco_model import _mujoco
from harness.engines.protocol import Array
from harness.engines.readers.reading import Placed
from harness.errors import InputError, UnsupportedError
from harness.system import System
from harness.system.inertia import combine
from harness.system.lowering import neutral_position
from harness.system.mjcf_left_out import disabled, rubs
from harness.system.mjcf_limits import ends
from harness.system.read_mjcf import compiled, names_of_joints

KINDS = ("free", "ball", "prismatic", "revolute")  # in the order of mjtJoint


@dataclass(frozen=True, eq=False)
class MujocoReading:
    """See ``Reading``. joints: MuJoCo's index of each of ``names``. Its free and ball joints have our positions and velocities.

    zero: our positions where nothing is turned or shifted.
    """

    names: tuple[str, ...]
    model: Any
    data: Any
    joints: tuple[int, ...]
    zero: Array

    @cached_property
    def _dofs(self) -> NDArray[np.intp]:
        return self._of_joints(self.model.jnt_dofadr, (6, 3))

    @cached_property
    def _places(self) -> NDArray[np.intp]:
        return self._of_joints(self.model.jnt_qposadr, (7, 4))

    def _of_joints(self, first: Array, several: tuple[int, int]) -> NDArray[np.intp]:
        """MuJoCo's indices joint by joint; several: how many a free joint has, and a ball."""
        sizes = [(*several, 1, 1)[int(self.model.jnt_type[k])] for k in self.joints]
        return np.concatenate([first[k] + np.arange(size) for k, size in zip(self.joints, sizes, strict=True)])

    def _set(self, q: Array, qd: Array | None = None) -> Any:
        mujoco = _mujoco()
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self._places] = q
        if qd is not None:
            self.data.qvel[self._dofs] = qd
        mujoco.mj_fwdPosition(self.model, self.data)
        mujoco.mj_fwdVelocity(self.model, self.data)
        return mujoco

    def mass_matrix(self, q: Array) -> Array:
        mujoco = self._set(q)
        whole = np.zeros((self.model.nv, self.model.nv))
        try:
            mujoco.mj_fullM(self.model, self.data, whole)
        except TypeError:  # before 4.0 the sparse matrix itself was passed
            mujoco.mj_fullM(self.model, whole, self.data.qM)
        return whole[np.ix_(self._dofs, self._dofs)]

    def bias(self, q: Array, qd: Array) -> Array:
        self._set(q, qd)
        # What carries weight counts as gravity here.
        return (self.data.qfrc_bias - self.data.qfrc_gravcomp)[self._dofs]

    def gravity(self, q: Array) -> Array:
        return self.bias(q, np.zeros(len(self._dofs)))

    def placed(self) -> tuple[Placed, ...]:
        self._set(self.zero)
        model, data = self.model, self.data
        # The last joint of the nearest body above that has one carries a body; -1: it does not move.
        carrier = [-1] * model.nbody
        pieces: dict[int, list[tuple[float, Array, Array]]] = {k: [] for k in range(model.njnt)}
        above: dict[int, int] = {}
        for b in range(1, model.nbody):
            carrier[b] = carrier[int(model.body_parentid[b])]
            for k in range(int(model.body_jntadr[b]), int(model.body_jntadr[b]) + int(model.body_jntnum[b])):
                above[k], carrier[b] = carrier[b], k
            if carrier[b] >= 0:
                turn = np.array(data.ximat[b]).reshape(3, 3)
                tensor = turn @ np.diag(model.body_inertia[b]) @ turn.T
                pieces[carrier[b]].append((float(model.body_mass[b]), np.array(data.xipos[b]), tensor))
        found = []
        for name, k in zip(self.names, self.joints, strict=True):
            mass, com, inertia = combine(*pieces[k]) if pieces[k] else (0.0, np.zeros(3), np.zeros((3, 3)))
            found.append(
                Placed(
                    name,
                    model.body(int(model.jnt_bodyid[k])).name,
                    KINDS[int(model.jnt_type[k])],
                    self.joints.index(above[k]) if above[k] in self.joints else -1,
                    np.array(data.xaxis[k]) * (int(model.jnt_type[k]) > 1),
                    np.array(data.xanchor[k]),
                    mass,
                    com,
                    inertia,
                )
            )
        return tuple(found)

    def fields(self) -> Mapping[str, Mapping[str, float]]:
        found = {}
        model = self.model
        springs, dampers = not disabled(model, "SPRING"), not disabled(model, "DAMPER")
        dry = rubs(model)
        for name, k in zip(self.names, self.joints, strict=True):
            at = int(model.jnt_dofadr[k])
            values = {"stiffness": float(model.jnt_stiffness[k]) if springs else 0.0}
            # Drives add armature and damping of their own, which belong to the joint here.
            if not model.nactuator:
                values["armature"] = float(model.dof_armature[at])
                values["damping"] = float(model.dof_damping[at]) if dampers else 0.0
            values["friction"] = float(model.dof_frictionloss[at]) if dry else 0.0
            if model.jnt_type[k] > 1:  # a ball's limit is a cone, and its spring has a rest in space
                values["lower"], values["upper"] = ends(model, k)
                if values["stiffness"]:
                    values["rest_position"] = float(model.qpos_spring[model.jnt_qposadr[k]])
            found[name] = values
        return found


def read_by_mujoco(path: Path, system: System, *, allow: Sequence[Path] = ()) -> MujocoReading:
    """The file as MuJoCo reads it; UnsupportedError with its reason where it does not, or reads other joints."""
    mujoco = _mujoco()
    try:
        model = compiled(path, allow=allow)
    except InputError as error:
        raise UnsupportedError(error.what) from None
    # Told as left out, and no misreading: inertia that tendons add to the mass matrix.
    model.tendon_armature[:] = 0.0
    index = {name: k for k, name in enumerate(names_of_joints(model))}
    missing = [name for name in system.joint_names if name not in index]
    further = [name for name in index if name not in system.joint_names]
    if missing or further:
        what = f"passes over joint {missing[0]!r}" if missing else f"has a joint {further[0]!r}"
        raise UnsupportedError(f"MuJoCo's reader {what}")
    joints = tuple(index[name] for name in system.joint_names)
    return MujocoReading(system.joint_names, model, mujoco.MjData(model), joints, neutral_position(system))
