"""A base that shakes: the floor, a machine beside it, a table that is knocked in step."""

import numpy as np

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="base_excitation",
    title="shaking base",
    family=Family.BASE,
    site=SiteKind.BASE,
    parameters=(
        Parameter(
            "amplitude",
            "m/s**2",
            "of the base's acceleration, amplitude · sin(2π frequency · t + phase), horizontal in the plane of motion "
            "(axis of the first movable joint × down), t from the first sample",
            lower=0.0,
            scale=Scale(0.02, gravity=1),
            starts=(0.5,),
            plausible=Plausible(
                Scale(0.005, gravity=1),
                "floors of offices are built for half a hundredth of gravity (Murray, Allen and Ungar, AISC Design Guide 11, 1997)",
            ),
        ),
        Parameter(
            "frequency",
            "Hz",
            "of the shaking",
            lower=1e-3,
            upper=1e3,
            scale=Scale(0.5, frequency=1),
            starts=(0.3, 1.0, 3.0),
            search="spectrum",
        ),
        Parameter(
            "phase",
            "rad",
            "at the first sample",
            lower=-2.0 * np.pi,
            upper=2.0 * np.pi,
            scale=Scale(1.0),
            starts=(0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi),
            search="spectrum",
        ),
    ),
    signature="A steady wave in the residual at one frequency that does not decay with the swing.",
    shows_in="any recording longer than a few periods of the shaking; clearest when the swing has died down",
    source="Thomsen, Vibrations and Stability (2003), ch. 1: support excitation.",
    expressed_by={
        "denoc": "acceleration of the base",
        "mujoco": "gravity set at every step",
        "exudyn": "load user function on every mass",
    },
    needs=("motion",),
    confusable_with=("base_compliance", "cogging_torque"),
    law=JointLaw(("excitation_amplitude", "excitation_frequency", "excitation_phase"), sideways=True),
)
