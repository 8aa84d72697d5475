"""A centre of mass elsewhere in a body that turns in space."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale
from harness.system import System
from harness.system.description import constant

AXES = ("x", "y", "z")


def _displace(system: System, site: str, parameters: Mapping[str, float]) -> System:
    link = system.link(site)
    moved = np.asarray(link.com) + [parameters[axis] for axis in AXES]
    return system.replace_link(replace(link, com=constant(moved)))


def _along(axis: str) -> Parameter:
    return Parameter(
        axis,
        "m",
        f"shift along the body's {axis} axis, mass and inertia about the centre of mass unchanged",
        scale=Scale(0.03, length=1),
        starts=(0.5, -0.5),
        plausible=Plausible(
            Scale(0.1, length=1), "a tenth of the body: from drawings without cables, and markers off its centre"
        ),
    )


EFFECT = Effect(
    name="com_displacement",
    title="centre of mass elsewhere in the body",
    family=Family.INERTIA,
    site=SiteKind.LINK,
    parameters=tuple(map(_along, AXES)),
    signature="In flight the body's origin circles about its path as the body turns; on a ball joint the swing about "
    "two axes changes, and the equilibrium.",
    shows_in="poses of a body that flies and turns, or of one that swings about a ball joint in more than one plane",
    source="Atkeson, An and Hollerbach, Estimation of inertial parameters of manipulator loads and links, Int. J. "
    "Robot. Res. "
    "5 (1986) 101–119.",
    expressed_by={"denoc": "link inertia"},
    needs=("motion", "rigid", "space"),
    confusable_with=("payload_mass",),
    reshape=Reshape(_displace),
)
