"""Closed loops in Pinocchio: ``constraintDynamics`` over its rigid constraints, proximal where they say things twice.

A connection is a constraint of three shifts (CONTACT_3D), a weld of all six motions. Pinocchio corrects nothing that has opened
(Baumgarte's gains are zero), so states are to be closed.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from harness.engines.loops import Closing, least
from harness.engines.pinocchio_model import PinocchioModel, _pinocchio
from harness.engines.protocol import Array
from harness.system import Frame, System

# Proximal parameter, relative to a mass matrix of about one, iterations, and where they end.
_PROXIMAL = (1e-15, 1e-9, 100)


@dataclass(frozen=True, eq=False)
class ClosedPinocchioModel(PinocchioModel):
    """A closed system in Pinocchio; see ``EngineModel``."""

    constraints: Any = field(repr=False, default=None)
    states: Any = field(repr=False, default=None)

    def _acceleration(self, q: Array, qd: Array, tau: Array) -> Array:
        pin = _pinocchio()
        total = tau + self._passive(q, qd)
        applied = (self.axes.turned(q, total) - self.armature * self.axes.turning(q, qd))[self.axes.order]
        found = pin.constraintDynamics(
            self.model,
            self.data,
            self._q(q),
            self.axes.into(q, qd),
            applied,
            self.constraints,
            self.states,
            pin.ProximalSettings(*_PROXIMAL),
        )
        return self.axes.acceleration_out(q, qd, np.array(found))

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        needed = super().inverse_dynamics(q, qd, qdd)
        pin = _pinocchio()
        # The constraints' placements are those of the last call of the dynamics.
        self._acceleration(q, qd, np.zeros_like(qd))
        pin.computeJointJacobians(self.model, self.data, self._q(q))
        theirs = np.array(pin.getConstraintsJacobian(self.model, self.data, self.constraints, self.states))
        jacobian = np.array([self.axes.out(q, row) for row in theirs])
        return least(needed, jacobian)


def closed(model: PinocchioModel, closing: Closing) -> ClosedPinocchioModel:
    """The model of a tree with its loops."""
    pin = _pinocchio()
    constraints, states = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for connection in closing.connections:
        kind = pin.ContactType.CONTACT_6D if connection.welded else pin.ContactType.CONTACT_3D
        sides = [_placed(model, frame) for frame in (connection.first, connection.second)]
        made = pin.RigidConstraintModel(kind, model.model, *sides[0], *sides[1], pin.ReferenceFrame.LOCAL)
        constraints.append(made)
        states.append(made.createData())
    pin.initConstraintDynamics(model.model, model.data, constraints, states)
    fields = {key: getattr(model, key) for key in model.__dataclass_fields__}
    return ClosedPinocchioModel(**fields, constraints=constraints, states=states)


def _placed(model: PinocchioModel, frame: Frame) -> tuple[int, Any]:
    """The joint that carries a frame, and where the frame is on it."""
    pin = _pinocchio()
    placement = pin.SE3(np.array(frame.rotation), np.array(frame.xyz))
    system: System = model.system
    link = frame.link
    while link != system.base:
        joint = system.carrier(link)
        if joint.movable:
            return int(model.model.getJointId(joint.name)), placement
        placement = pin.SE3(np.array(joint.rotation), np.array(joint.xyz)) * placement
        link = joint.parent
    return 0, placement
