"""Claims of peers in the words of ``denoc.claims/1``, made of recordings as peers are given them
(``compare.peers.runs``)."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.compare.peers.runs import NotForIt, Run, as_run

__all__ = ["NotForIt", "Run", "as_run", "finding"]


# On the angle of one joint that swings freely these leave the same trace; peers that do not say so are given it.
ALIKE = {
    "sensor_offset": ("base_tilt", "com_side_offset", "sensor_zero"),
    "base_tilt": ("sensor_offset", "com_side_offset"),
}
PARAMETER = {
    "viscous_damping": "coefficient", "quadratic_drag": "coefficient", "coulomb_friction": "torque", "sensor_offset": "offset",
    "constant_torque": "torque", "joint_stiffness": "stiffness", "cubic_stiffness": "stiffness", "added_inertia": "inertia",
}  # fmt: skip


def finding(effect: str, joint: str, value: float | None = None, half95: float | None = None) -> dict[str, Any]:
    """A claim at a joint or its angle's channel, as ``denoc.claims/1`` has it; half95: half of its 95 % interval."""
    site = f"{joint}.position" if effect.startswith("sensor") else joint
    found: dict[str, Any] = {"effect": effect, "site": site, "indistinguishable_from": list(ALIKE.get(effect, ()))}
    if value is not None and half95 is not None and np.isfinite(half95):
        found["parameters"] = {PARAMETER[effect]: {"value": value, "ci95": [value - half95, value + half95]}}
    return found
