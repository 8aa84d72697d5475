"""Torque that alternates with the angle: poles of a motor, teeth, an uneven bearing."""

import numpy as np

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="cogging_torque",
    title="cogging torque",
    family=Family.STIFFNESS,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "amplitude",
            "N*m",
            "largest torque: amplitude · sin(periods · q + phase)",
            lower=0.0,
            scale=Scale(0.02, torque=1),
            starts=(0.5,),
            linear_unit="N",
            plausible=Plausible(
                Scale(0.03, torque=1),
                "some hundredths of a motor's torque (Jahns and Soong, IEEE Trans. Ind. Electron. 43 (1996) 321)",
            ),
        ),
        Parameter(
            "periods",
            "1/rev",
            "periods in one turn; one would be an imbalance (``imbalance``, ``com_offset``, ``com_side_offset``)",
            lower=2.0,
            upper=200.0,
            scale=Scale(1.0),
            starts=(4.0, 7.0, 12.0, 24.0),
            search="range",
            linear_unit="1/m",
        ),
        Parameter(
            "phase",
            "rad",
            "of the sine at zero position",
            lower=-2.0 * np.pi,
            upper=2.0 * np.pi,
            scale=Scale(1.0),
            starts=(0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi),
            search="range",
        ),
    ),
    signature="The residual torque is a wave over the angle, the same going and coming; slow motion is drawn to "
    "fixed angles.",
    shows_in="motion over at least one period of the angle, slow enough for the torque to matter",
    source="Hanselman, Brushless Permanent Magnet Motor Design (2003): cogging torque as a Fourier series of the "
    "angle.",
    expressed_by={"denoc": "joint law", "exudyn": "user function of the connector"},
    needs=("motion",),
    confusable_with=(
        "joint_stiffness",
        "cubic_stiffness",
        "encoder_interpolation",
        "com_offset",
        "imbalance",
        "payload_mass",
        "added_inertia",
        "clock_skew",
    ),
    law=JointLaw(("cogging_amplitude", "cogging_periods", "cogging_phase")),
)
