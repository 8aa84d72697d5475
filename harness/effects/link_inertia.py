"""A link whose moments of inertia are not the drawn ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale
from harness.errors import InputError
from harness.system import System
from harness.system.description import constant


def _change(system: System, site: str, parameters: Mapping[str, float]) -> System:
    link, joint = system.link(site), system.carrier(site)
    if joint.parent == system.base:
        raise InputError(
            f"link {site!r} turns against the base alone",
            mend="its inertia shows as one about its joint (added_inertia)",
        )
    if not link.inertia.any():
        raise InputError(f"link {site!r} is a point", mend="it has no inertia to change")
    return system.replace_link(replace(link, inertia=constant(link.inertia * (1.0 + parameters["share"]))))


EFFECT = Effect(
    name="link_inertia",
    title="inertia of the link",
    family=Family.INERTIA,
    site=SiteKind.LINK,
    parameters=(
        Parameter(
            "share",
            "1",
            "by which all moments of inertia about the centre of mass are larger than stated, mass and centre unchanged",
            lower=-0.95,
            scale=Scale(0.1),
            starts=(1.0, -1.0, 5.0),
            plausible=Plausible(
                Scale(0.2),
                "a fifth: of drawings without motors, screws and cables (Armstrong, Khatib and Burdick, ICRA 1986)",
            ),
        ),
    ),
    signature="Whatever turns the link, its own joint or one before it, takes more effort to speed up; weight is as modelled.",
    shows_in="motion that turns the link fast, by more than one joint: by its own alone it is an inertia about that",
    source="Atkeson, An and Hollerbach, Estimation of inertial parameters of manipulator loads and links, Int. J. "
    "Robot. Res. 5 (1986) 101–119.",
    expressed_by={
        "denoc": "link inertia",
        "mujoco": "body inertia",
        "pinocchio": "link inertia",
        "exudyn": "body inertia",
    },
    needs=("motion", "rigid", "axis"),
    confusable_with=("added_inertia", "payload_mass", "com_offset"),
    rarity=1.0,
    reshape=Reshape(_change),
)
