"""A centre of mass that lies beside the link's line, in the plane of motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale
from harness.errors import InputError
from harness.system import System
from harness.system.description import constant


def _shift(system: System, site: str, parameters: Mapping[str, float]) -> System:
    link, joint = system.link(site), system.carrier(site)
    side = np.cross(joint.axis, link.com)
    size = float(np.linalg.norm(side))
    if size == 0.0:
        raise InputError(f"link {site!r} has its centre of mass on its axis", mend="no side to shift it to")
    return system.replace_link(replace(link, com=constant(link.com + side * (parameters["offset"] / size))))


EFFECT = Effect(
    name="com_side_offset",
    title="centre of mass beside the link's line",
    family=Family.INERTIA,
    site=SiteKind.LINK,
    parameters=(
        Parameter(
            "offset",
            "m",
            "shift along axis × centre of mass, mass and inertia about the centre of mass unchanged",
            scale=Scale(0.02, length=1),
            starts=(1.0, -1.0),
            plausible=Plausible(
                Scale(0.05, length=1), "a twentieth of the link: from drawings without cables and screws"
            ),
        ),
    ),
    signature="The equilibrium is shifted, the swing about it as modelled; for one link alone the same as a tilted "
    "base.",
    shows_in="any motion about an equilibrium; with several links, that of the others too",
    source="Atkeson, An and Hollerbach, Estimation of inertial parameters of manipulator loads and links, Int. J. "
    "Robot. Res. "
    "5 (1986) 101–119.",
    expressed_by={
        "denoc": "link inertia",
        "mujoco": "body inertia",
        "pinocchio": "link inertia",
        "exudyn": "body inertia",
    },
    needs=("motion", "rigid", "axis"),
    confusable_with=("base_tilt", "sensor_offset", "constant_torque"),
    rarity=1.5,
    reshape=Reshape(_shift),
)
