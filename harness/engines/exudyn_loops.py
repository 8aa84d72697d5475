"""Closed loops in Exudyn: generic joints between rigid markers on its kinematic tree, held by Lagrange multipliers.

Its motion is that of the generalized-α method with all constraints at the level of positions (index 3); its order is two. Redundant
conditions are left out, for its Jacobian would be singular with them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.engines.exudyn_rigid_model import ExudynModel, aligned
from harness.engines.exudyn_run import exudyn_package, quiet, settings
from harness.engines.protocol import Array, EngineError
from harness.errors import UnsupportedError
from harness.system import Frame, Loop, System
from harness.system.closure import closed_position, independent_conditions

# Steps [s] of motion: the error is of second order.
DEFAULT_STEP = 1e-4


def add_joints(mbs: Any, tree: Any, system: System) -> None:
    """A generic joint for every loop, its first frame the one whose axes motions are closed along."""
    from exudyn.itemInterface import MarkerBodyRigid, MarkerKinematicTreeRigid, ObjectGround, ObjectJointGeneric

    ground = None
    kept = independent_conditions(system, closed_position(system))
    for loop in system.loops:
        assert isinstance(loop, Loop)
        markers = []
        for frame in (loop.first, loop.second):
            body, rotation, xyz = _on_body(system, frame)
            place = exudyn_package().HT(rotation=rotation, translation=xyz)
            if body < 0:
                ground = mbs.AddObject(ObjectGround()) if ground is None else ground
                marker = MarkerBodyRigid(bodyNumber=ground, localHT=place)
            else:
                marker = MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=body, localHT=place)
            markers.append(mbs.AddMarker(marker))
        axes = [int((loop.name, motion) in kept) for motion in ("x", "y", "z", "rx", "ry", "rz")]
        mbs.AddObject(ObjectJointGeneric(markerNumbers=markers, constrainedAxes=axes))


def _on_body(system: System, frame: Frame) -> tuple[int, Array, Array]:
    """The body of Exudyn's tree that carries a frame (-1: the base), and the frame in that body's turned axes."""
    rotation, xyz = np.asarray(frame.rotation), np.asarray(frame.xyz)
    movable = [joint.name for joint in system.movable_joints]
    link = frame.link
    while link != system.base:
        joint = system.carrier(link)
        if joint.movable:
            turn = aligned(np.asarray(joint.axis))
            return movable.index(joint.name), turn.T @ rotation, turn.T @ xyz
        rotation, xyz = joint.rotation @ rotation, joint.xyz + joint.rotation @ xyz
        link = joint.parent
    return -1, rotation, xyz


@dataclass(frozen=True, eq=False)
class ClosedExudynModel(ExudynModel):
    """A closed system in Exudyn; see ``EngineModel``."""

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        raise UnsupportedError("Exudyn is asked for the motion of closed mechanisms, not for single accelerations")

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        raise UnsupportedError("Exudyn is asked for the motion of closed mechanisms, not for single forces")

    def mass_matrix(self, q: Array) -> Array:
        raise UnsupportedError("Exudyn's mass matrix is compared on trees")

    def bias(self, q: Array, qd: Array) -> Array:
        raise UnsupportedError("Exudyn's forces are compared on trees")

    def frequencies(self, q: Array) -> Array:
        raise UnsupportedError("natural frequencies of closed mechanisms are not asked of Exudyn")

    @property
    def default_step(self) -> float:
        return DEFAULT_STEP

    def _solve(self, span: float, steps: int, every: float) -> bool:
        exudyn = exudyn_package()
        made = settings(exudyn, span, steps, every, relative=1e-10, absolute=1e-12)
        made.timeIntegration.generalizedAlpha.spectralRadius = 1.0
        made.timeIntegration.generalizedAlpha.useIndex2Constraints = True
        made.timeIntegration.generalizedAlpha.useNewmark = True
        made.timeIntegration.newton.useModifiedNewton = False
        try:
            with quiet(exudyn):
                done = self.mbs.SolveDynamic(made, updateInitialValues=False)
        except Exception as error:
            raise EngineError(f"exudyn gave up: {error}; use a smaller step") from None
        return done is not False
