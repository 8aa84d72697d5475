"""MuJoCo as an engine: what it is asked for, and what it is not; the model is in ``mujoco_model``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib import metadata
from typing import Any

import numpy as np

from harness.engines.checked import installed_version, raise_if_refused
from harness.engines.coupled import CoupledModel, couple, follows, without_mimics
from harness.engines.expressed import bends, express, refusal
from harness.engines.folded import bodies
from harness.engines.loops import closing, refuses_loops
from harness.engines.mujoco_constraints import bound as bound_both
from harness.engines.mujoco_constraints import limit, soften
from harness.engines.mujoco_model import MujocoModel, _mujoco, mujoco_model
from harness.errors import EngineUnavailableError
from harness.system import JointType, System
from harness.system.lowering import chained, position_of_rate
from harness.system.soft_constraints import soft_friction, soft_stops


@dataclass(frozen=True)
class Mujoco:
    """MuJoCo as an ``Engine``: rigid trees of any size."""

    name: str = "mujoco"

    def version(self) -> str:
        found = installed_version("mujoco-core", "MuJoCo")
        # Both distributions write into one package: an older whole one beside the core is neither.
        try:
            whole = metadata.version("mujoco")
        except metadata.PackageNotFoundError:
            return found
        if whole != found:
            raise EngineUnavailableError(
                f"mujoco {whole} and mujoco-core {found} are installed one over the other: pip install --upgrade mujoco"
            )
        return found

    def refuses(self, system: System) -> str | None:
        if bends(system):
            return "MuJoCo has no elastic links"
        if not system.joint_names:
            return "the system has no movable joint"
        if system.loops and follows(chained(system)):
            return "joints that follow others beside loops are not told MuJoCo here"
        reason = refuses_loops("MuJoCo", system, couplings=True)
        if reason:
            return reason
        reason = refusal("MuJoCo", system, shaking=True, constraints=True, compensation=True)
        if reason:
            return reason
        expressed = express(system)
        owners = [joint for joint in expressed.system.joints for _ in joint.velocity_names]
        laws = expressed.forces
        for k, joint in enumerate(owners):
            rests = {0.0} if laws.cubic[k] else set()
            rests |= {joint.rest_position} if joint.stiffness else set()
            rests |= {float(laws.slack[k])} if laws.square[k] or laws.cube[k] else set()
            if len(rests) > 1:
                return f"MuJoCo's springs of a joint have one rest position, joint {joint.name} has {len(rests)}"
        return None

    def build(self, system: System) -> MujocoModel | CoupledModel:
        """The system in MuJoCo; raises UnsupportedError with the reason if it is refused."""
        raise_if_refused(system, self.refuses(system))
        if not system.simple:
            # What MuJoCo is given: joints of one degree, free and ball joints, none following another but by our equations.
            system = chained(system, keep=(JointType.FREE, JointType.BALL))
            if follows(system) and not system.loops:
                independent = self.build(without_mimics(system))
                return couple(system, independent, independent.names, independent.position_names)
        mujoco = _mujoco()
        expressed = express(system)
        system = expressed.system
        close = None
        if system.loops:
            from harness.engines.mujoco_loops import ClosedMujocoModel, add_equalities
            from harness.system.mjcf_names import body_names

            cut = closing(system)

            def close(mujoco: Any, spec: Any) -> None:
                add_equalities(mujoco, spec, cut, body_names(system))

        model = mujoco_model(system, forces=expressed.forces, close=close)
        bound = replace(system, attachments=expressed.laws)
        stops = soft_stops(bound)
        soften(model, soft_friction(bound))
        limit(model, stops)
        bound_both(model, system.stops)
        names, positions = system.coordinate_names, system.position_names
        order = np.empty(model.nv, dtype=np.intp)
        places = np.empty(model.nq, dtype=np.intp)
        slides = {
            position: velocity
            for joint in system.joints
            if joint.type is JointType.FREE
            for position, velocity in zip(joint.position_names[:3], joint.velocity_names[:3], strict=True)
        }
        joints = {joint.name: joint for joint in system.movable_joints}
        for k in range(model.njnt):
            name = model.joint(k).name
            turning = name in joints and joints[name].turns_in_space
            at = positions.index(joints[name].position_names[-4] if turning else name)
            first = names.index(joints[name].velocity_names[-3] if turning else slides.get(name, name))
            for i in range(4 if turning else 1):
                places[model.jnt_qposadr[k] + i] = at + i
            for i in range(3 if turning else 1):
                order[model.jnt_dofadr[k] + i] = first + i
        made = MujocoModel(
            names=names,
            position_names=positions,
            places=places,
            local=position_of_rate(system),
            system=system,
            model=model,
            data=mujoco.MjData(model),
            order=order,
            fixed_potential=bodies(system)[1],
            forces=expressed.forces.without_stops(stops, names),
            shaking=expressed.shaking,
        )
        if close is None:
            return made
        return ClosedMujocoModel(**{key: getattr(made, key) for key in made.__dataclass_fields__}, closing=cut)
