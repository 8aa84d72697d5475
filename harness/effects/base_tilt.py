"""A base that does not stand upright."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.effects.directions import turning_axis
from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale
from harness.system import System
from harness.system.description import constant
from harness.system.rotation import about_axis


def _tilt(system: System, site: str, parameters: Mapping[str, float]) -> System:
    # The base turns by +angle, so in its own coordinates gravity turns back.
    turn = about_axis(turning_axis(system), -parameters["angle"])
    return replace(system, gravity=constant(turn @ system.gravity))


EFFECT = Effect(
    name="base_tilt",
    title="tilted base",
    family=Family.BASE,
    site=SiteKind.BASE,
    parameters=(
        Parameter(
            "angle",
            "rad",
            "turn of the base about the axis of the first joint that turns",
            lower=-np.pi,
            upper=np.pi,
            scale=Scale(0.02),
            starts=(1.0, -1.0),
            plausible=Plausible(Scale(0.035), "two degrees: a bench is set level by eye or by a spirit level"),
        ),
    ),
    signature="The equilibrium is shifted by the angle, and the whole swing with it, at every amplitude alike.",
    shows_in="any motion about an equilibrium",
    source="Siciliano et al., Robotics: Modelling, Planning and Control (2009), ch. 7: gravity in the base frame.",
    expressed_by={
        "denoc": "direction of gravity",
        "mujoco": "direction of gravity",
        "pinocchio": "direction of gravity",
        "exudyn": "direction of the mass-proportional load",
        "analytic": "shifted equilibrium",
    },
    needs=("motion",),
    confusable_with=("sensor_offset", "com_side_offset", "constant_torque", "coulomb_friction"),
    reshape=Reshape(_tilt),
)
