"""A stop that the joint runs into on one side."""

import numpy as np

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="end_stop",
    title="end stop",
    family=Family.STIFFNESS,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "angle",
            "rad",
            "where contact begins; a positive angle stops the positive direction, a negative one the negative",
            lower=-2.0 * np.pi,
            upper=2.0 * np.pi,
            neutral=np.inf,
            scale=Scale(1.0),
            starts=(0.5, -0.5, 1.0, -1.0),
            search="range",
            linear_unit="m",
        ),
        Parameter(
            "stiffness",
            "N*m/rad",
            "of the contact",
            lower=0.0,
            scale=Scale(20.0, torque=1),
            starts=(0.00004, 0.5, 5.0, 100.0),
            linear_unit="N/m",
            plausible=Plausible(
                Scale(0.05, torque=-1),
                "a stop gives some hundredths of a radian under the weight that leans on it",
                inverse=True,
            ),
        ),
        Parameter(
            "damping",
            "N*m*s/rad",
            "of the contact; the stop pushes, never pulls",
            lower=0.0,
            scale=Scale(0.2, torque=1, frequency=-1),
            starts=(0.0001, 10.0, 1000.0),
            linear_unit="N*s/m",
        ),
    ),
    signature="One side of the swing is cut off at the same angle, with a sudden reversal; motion that does not "
    "reach that "
    "angle is as modelled.",
    shows_in="motion that reaches the stop",
    source="Hunt and Crossley, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl. Mech. 42 "
    "(1975) "
    "440–445, with linear stiffness and damping.",
    expressed_by={
        "denoc": "joint law",
        "mujoco": "joint limit with solreflimit in direct stiffness and damping form",
        "exudyn": "user function of the connector",
    },
    needs=("motion",),
    confusable_with=("cubic_stiffness", "sensor_saturation"),
    law=JointLaw(("stop_angle", "stop_stiffness", "stop_damping")),
)
