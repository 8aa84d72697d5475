"""Trees told Pinocchio joint by joint, apart from the adapter."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from harness.system import System


def pinocchio_tree(system: System) -> tuple[pin.Model, np.ndarray]:
    """The system in Pinocchio, and the index of each of our coordinates there; Pinocchio applies no damping."""
    model = pin.Model()
    model.gravity.linear = np.array(system.gravity)
    placed = {system.base: (0, pin.SE3.Identity())}
    armature = []
    for joint, link in zip(system.joints, system.links, strict=True):
        parent, at = placed[joint.parent]
        at = at * pin.SE3(np.array(joint.rotation), np.array(joint.xyz))
        body = pin.Inertia(link.mass, np.array(link.com), np.array(link.inertia))
        if not joint.movable:
            model.appendBodyToJoint(parent, body, at)
            placed[link.name] = (parent, at)
            continue
        axis = np.array(joint.axis)
        kind = pin.JointModelPrismaticUnaligned(axis) if joint.prismatic else pin.JointModelRevoluteUnaligned(axis)
        index = model.addJoint(parent, kind, at, joint.name)
        model.appendBodyToJoint(index, body, pin.SE3.Identity())
        placed[link.name] = (index, pin.SE3.Identity())
        armature.append(joint.armature)
    model.armature = np.array(armature)
    return model, np.array([model.joints[model.getJointId(name)].idx_v for name in system.joint_names])
