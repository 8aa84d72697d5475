"""A centre of mass that lies farther out (or in) along the link than modelled."""

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
    link = system.link(site)
    distance = float(np.linalg.norm(link.com))
    if distance == 0.0:
        raise InputError(f"link {site!r} has its centre of mass on its joint", mend="no direction to shift it along")
    return system.replace_link(replace(link, com=constant(link.com * (1.0 + parameters["offset"] / distance))))


EFFECT = Effect(
    name="com_offset",
    title="centre of mass shifted along the link",
    family=Family.INERTIA,
    site=SiteKind.LINK,
    parameters=(
        Parameter(
            "offset",
            "m",
            "shift away from the joint, mass and inertia about the centre of mass unchanged",
            scale=Scale(0.03, length=1),
            starts=(0.5, -0.5, 2.0),
            plausible=Plausible(Scale(0.1, length=1), "a tenth of the link: from drawings without cables and screws"),
        ),
    ),
    signature="The swing's frequency is off by the same factor at every amplitude; the equilibrium stays.",
    shows_in="a free swing shows only its ratio to the inertia; a known torque or a second link shows it itself",
    source="Atkeson, An and Hollerbach, Estimation of inertial parameters of manipulator loads and links, Int. J. "
    "Robot. Res. "
    "5 (1986) 101–119.",
    expressed_by={
        "denoc": "link inertia",
        "mujoco": "body inertia",
        "pinocchio": "link inertia",
        "exudyn": "body inertia",
        "analytic": "closed form of the compound pendulum",
    },
    needs=("motion", "rigid", "axis"),
    confusable_with=("payload_mass", "added_inertia", "clock_skew", "joint_stiffness", "servo_gain", "servo_torque"),
    reshape=Reshape(_shift),
)
