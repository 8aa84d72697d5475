"""A spring at a joint: a cable, a seal, a return spring."""

import numpy as np

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="joint_stiffness",
    title="joint spring",
    family=Family.STIFFNESS,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "stiffness",
            "N*m/rad",
            "torque per angle, beside what the model states",
            lower=0.0,
            scale=Scale(0.1, torque=1),
            starts=(0.3, 2.0),
            linear_unit="N/m",
            plausible=Plausible(Scale(0.1, torque=1), "cables and hoses, a tenth of what gravity does"),
        ),
        Parameter(
            "rest_angle",
            "rad",
            "where the spring is slack",
            lower=-2.0 * np.pi,
            upper=2.0 * np.pi,
            scale=Scale(0.5),
            starts=(0.0, 1.0, -1.0),
            linear_unit="m",
            plausible=Plausible(Scale(1.5), "a cable rests within a quarter of a turn of where the joint is used"),
        ),
    ),
    signature="The swing is faster than modelled, most at large amplitude where gravity softens and the spring does "
    "not; "
    "a rest angle away from zero shifts the equilibrium.",
    shows_in="swings of different amplitude",
    source="Meirovitch, Fundamentals of Vibrations (2001), ch. 1: equivalent springs.",
    expressed_by={
        "denoc": "joint stiffness",
        "mujoco": "joint stiffness and springref",
        "exudyn": "torsional spring-damper connector",
        "pinocchio": "force −k·(q − q₀) handed to the forward dynamics",
    },
    needs=("motion",),
    confusable_with=("cubic_stiffness", "payload_mass", "com_offset", "constant_torque", "base_tilt", "clock_skew"),
    law=JointLaw(("stiffness", "rest_angle")),
)
