"""MuJoCo's soft constraints of a joint, written from the effects that say what they are: dry friction and a limit.

A constraint of impedance d acts through ``invweight``, the joint's inverse inertia in the model's own position, with an inertia
J = d / (1 − d) / invweight: so the impedance that an inertia asks for is J invweight / (1 + J invweight).
Source: MuJoCo's documentation, Computation: constraint model, solver parameters.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

# Where a joint that is limited on one side has its other limit [rad or m].
FAR = 1e6


def _impedance(model: Any, coordinate: int, inertia: float) -> float:
    share = inertia * float(model.dof_invweight0[coordinate])
    return share / (1.0 + share)


def soften(model: Any, softness: Mapping[str, Mapping[str, float]]) -> None:
    """Make dry friction as soft as ``friction_softness`` says: its parameters by joint."""
    for name, values in softness.items():
        k = int(model.joint(name).dofadr[0])
        impedance = _impedance(model, k, values["inertia"])
        model.dof_solref[k] = (2.0 * values["time"] / impedance, 1.0)
        model.dof_solimp[k, :2] = impedance


def limit(model: Any, stops: Mapping[str, Mapping[str, float]]) -> None:
    """Bound joints by stops that have an inertia: parameters of ``end_stop`` and ``stop_inertia`` by joint."""
    for name, values in stops.items():
        joint = model.joint(name)
        impedance = _impedance(model, int(joint.dofadr[0]), values["inertia"])
        rate = impedance / values["inertia"]
        model.jnt_limited[joint.id] = 1
        model.jnt_range[joint.id] = np.sort([values["angle"], -np.copysign(FAR, values["angle"])])
        model.jnt_solref[joint.id] = (-values["stiffness"] * rate, -values["damping"] * rate)
        model.jnt_solimp[joint.id, :2] = impedance
