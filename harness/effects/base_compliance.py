"""A base that gives: a stand, a cart on its lock, a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.effects.directions import sideways
from harness.effects.effect import Effect, Family, Parameter, PlausibleTogether, Reshape, SiteKind
from harness.effects.scale import References, Scale
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

CARRIAGE = "base_carriage"
SLIDE = "base_slide"


def _soften(system: System, site: str, parameters: Mapping[str, float]) -> System:
    slide = Joint(
        SLIDE,
        JointType.PRISMATIC,
        system.base,
        CARRIAGE,
        axis=constant(sideways(system)),
        stiffness=parameters["stiffness"],
        damping=parameters["damping"],
    )
    carriage = Link(CARRIAGE, mass=parameters["mass"], inertia=constant(np.zeros((3, 3))))
    joints = tuple(replace(j, parent=CARRIAGE) if j.parent == system.base else j for j in system.joints)
    return replace(system, joints=(slide, *joints), links=(carriage, *system.links))


def _slowness(parameters: Mapping[str, float], references: References) -> float:
    """The square of the swing's frequency over that of the base with all it carries."""
    moving = parameters["mass"] + references.mass
    return references.frequency**2 * moving / parameters["stiffness"]


EFFECT = Effect(
    name="base_compliance",
    title="compliant base",
    family=Family.BASE,
    site=SiteKind.BASE,
    parameters=(
        Parameter(
            "stiffness",
            "N/m",
            "of the base against horizontal motion in the plane of motion (axis of the first movable joint × down)",
            lower=1e-6,
            neutral=np.inf,
            scale=Scale(300.0, mass=1, frequency=2),
            starts=(0.2, 1.0, 10.0),
        ),
        Parameter("mass", "kg", "that moves with the base", lower=1e-6, scale=Scale(2.0, mass=1), starts=(0.5, 2.0)),
        Parameter(
            "damping",
            "N*s/m",
            "of the base",
            lower=0.0,
            scale=Scale(2.0, mass=1, frequency=1),
            starts=(0.2, 2.0),
        ),
    ),
    signature="The swing is a little slower than modelled, loses energy into the base, and carries a decaying "
    "vibration of "
    "the base after every sudden change.",
    shows_in="swings of large amplitude; sudden starts",
    source="Den Hartog, Mechanical Vibrations (1956), ch. 3: coupled oscillators; Bennett et al., Huygens's clocks, "
    "Proc. R. Soc. A "
    "458 (2002) 563–579.",
    expressed_by={
        "denoc": "a sliding joint under the mechanism with stiffness and damping",
        "mujoco": "a slide joint with stiffness and damping",
        "exudyn": "a further body on a spring-damper",
        "pinocchio": "a prismatic joint, its spring handed over as force",
    },
    needs=("motion",),
    confusable_with=("base_excitation", "viscous_damping", "joint_flexibility", "added_inertia"),
    plausible=PlausibleTogether(
        "the square of the swing's frequency over that of the base, which moves with what it carries",
        _slowness,
        0.04,
        "a stand vibrates several times as fast as what it carries swings",
    ),
    reshape=Reshape(_soften, topology=True),
)
