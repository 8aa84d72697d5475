"""Soft constraints written into a compiled MuJoCo model: dry friction and limits, by joint."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from harness.system import Stops
from harness.system.soft_constraints import friction_solver, limit_solver, limits


def soften(model: Any, softness: Mapping[str, Mapping[str, float]]) -> None:
    """Make dry friction as soft as ``friction_softness`` says: its parameters by joint."""
    for name, values in softness.items():
        k = int(model.joint(name).dofadr[0])
        model.dof_solref[k], model.dof_solimp[k, :2] = friction_solver(values, float(model.dof_invweight0[k]))


def bound(model: Any, stops: Iterable[Stops]) -> None:
    """Bound joints at both ends, as softly as their stops say."""
    for stop in stops:
        joint = model.joint(stop.joint)
        invweight = float(model.dof_invweight0[int(joint.dofadr[0])])
        values = {"stiffness": stop.stiffness, "damping": stop.damping, "inertia": stop.inertia}
        model.jnt_limited[joint.id] = 1
        model.jnt_range[joint.id] = stop.lower, stop.upper
        model.jnt_solref[joint.id], model.jnt_solimp[joint.id, :2] = limit_solver(values, invweight)


def limit(model: Any, stops: Mapping[str, Mapping[str, float]]) -> None:
    """Bound joints by stops that have an inertia: parameters of ``end_stop`` and ``stop_inertia`` by joint."""
    for name, values in stops.items():
        joint = model.joint(name)
        invweight = float(model.dof_invweight0[int(joint.dofadr[0])])
        model.jnt_limited[joint.id] = 1
        model.jnt_range[joint.id] = limits(values)
        model.jnt_solref[joint.id], model.jnt_solimp[joint.id, :2] = limit_solver(values, invweight)
