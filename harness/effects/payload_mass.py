"""A mass at the end of a link that the model does not know."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale, tip_of
from harness.system import System
from harness.system.description import constant
from harness.system.inertia import combine


def _carry(system: System, site: str, parameters: Mapping[str, float]) -> System:
    link = system.link(site)
    mass, com, inertia = combine(
        (link.mass, link.com, link.inertia), (parameters["mass"], tip_of(link, system), np.zeros((3, 3)))
    )
    beam = link.beam if link.beam is None else replace(link.beam, payload=link.beam.payload + parameters["mass"])
    return system.replace_link(replace(link, mass=mass, com=constant(com), inertia=constant(inertia), beam=beam))


EFFECT = Effect(
    name="payload_mass",
    title="payload",
    family=Family.INERTIA,
    site=SiteKind.LINK,
    parameters=(
        Parameter(
            "mass",
            "kg",
            "added as a point at the link's end: the beam's tip, the next joint, or the end of the rod with a bob that "
            "has the link's mass, centre and inertia",
            lower=0.0,
            scale=Scale(0.05, mass=1),
            starts=(0.4, 4.0),
            plausible=Plausible(Scale(0.3, mass=1), "a tool or weight of a fraction of what the joint carries"),
        ),
    ),
    signature="The swing is slower than modelled (for a link that is not a point at its end already), and a driven "
    "joint "
    "answers less; a flexible link vibrates slower.",
    shows_in="a free swing shows only its ratio to the inertia; a known torque or a second link shows it itself",
    source="Goldstein, Classical Mechanics, ch. 5: composition of inertias.",
    expressed_by={
        "denoc": "link inertia",
        "mujoco": "body inertia",
        "pinocchio": "link inertia",
        "exudyn": "body inertia, or a point mass on the beam's last node",
        "analytic": "closed form of the compound pendulum",
    },
    needs=("motion",),
    confusable_with=("added_inertia", "com_offset", "clock_skew", "joint_stiffness", "servo_gain", "servo_torque"),
    reshape=Reshape(_carry),
)
