"""Damping by a polynomial of the velocity, as a model file states it: MuJoCo's ``damping="a b c"`` beyond its first number."""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="polynomial_damping",
    title="polynomial damping",
    family=Family.DISSIPATION,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "quadratic",
            "N*m*s**2/rad**2",
            "b of the torque −(b · q̇ |q̇| + c · q̇³); negative feeds energy in",
            scale=Scale(0.01, torque=1, frequency=-2),
            starts=(0.2,),
            linear_unit="N*s**2/m**2",
            plausible=Plausible(Scale(0.1, torque=1, frequency=-2), "as viscous damping, at the speed of the swing"),
        ),
        Parameter(
            "cubic",
            "N*m*s**3/rad**3",
            "c of it",
            scale=Scale(0.01, torque=1, frequency=-3),
            starts=(0.2,),
            linear_unit="N*s**3/m**3",
            plausible=Plausible(Scale(0.1, torque=1, frequency=-3), "as viscous damping, at the speed of the swing"),
        ),
    ),
    signature="As quadratic drag, the more so the faster: wide swings shrink fast, small ones hardly.",
    shows_in="no recording alone: it acts where a model file states it, and is not looked for",
    source="MuJoCo 4's documentation, XML reference: joint, damping.",
    expressed_by={
        "denoc": "joint law",
        "mujoco": "second and third coefficient of joint damping",
        "pinocchio": "force handed to the forward dynamics",
        "exudyn": "user function of the connector",
    },
    needs=("stated",),
    confusable_with=("quadratic_drag", "viscous_damping"),
    law=JointLaw(("quadratic_drag", "cubic_damping")),
)
