"""Viscous damping: a torque against the motion, in proportion to its speed."""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="viscous_damping",
    title="viscous damping",
    family=Family.DISSIPATION,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "coefficient",
            "N*m*s/rad",
            "torque per speed, beside what the model states",
            lower=0.0,
            scale=Scale(0.01, torque=1, frequency=-1),
            starts=(0.3, 2.0),
            linear_unit="N*s/m",
            plausible=Plausible(
                Scale(0.1, torque=1, frequency=-1),
                "swings of rigs die out within a few to some hundred periods (a damping ratio of 0.05)",
            ),
        ),
    ),
    signature="The amplitude falls by the same factor in every swing (exponential envelope); energy lost in a "
    "half-swing "
    "grows with the square of the amplitude.",
    shows_in="any motion; best a free decay over many swings",
    source="Meirovitch, Fundamentals of Vibrations (2001), ch. 2: viscous damping and the logarithmic decrement.",
    expressed_by={
        "denoc": "joint damping",
        "mujoco": "joint damping",
        "exudyn": "damper of a torsional spring-damper connector",
        "pinocchio": "force −b·q̇ handed to the forward dynamics",
        "analytic": "closed form of the small swing",
    },
    needs=("motion",),
    confusable_with=("quadratic_drag", "coulomb_friction", "sensor_gain", "modal_damping", "servo_gain"),
    law=JointLaw(("damping",)),
)
