"""A spring by a polynomial of its stretch, as a model file states it: MuJoCo's ``stiffness="k1 k2 k3"`` beyond its first number."""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="polynomial_stiffness",
    title="polynomial spring",
    family=Family.STIFFNESS,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "quadratic",
            "N*m/rad**2",
            "k2 of the torque −(k2 · x² + k3 · x³), x = q − rest_angle: its term pulls to one side, whichever side x is on",
            scale=Scale(0.05, torque=1),
            starts=(0.5,),
            linear_unit="N/m**2",
            plausible=Plausible(Scale(0.1, torque=1), "cables and hoses, a tenth of what gravity does"),
        ),
        Parameter(
            "cubic",
            "N*m/rad**3",
            "k3 of it",
            scale=Scale(0.05, torque=1),
            starts=(0.5,),
            linear_unit="N/m**3",
            plausible=Plausible(Scale(0.1, torque=1), "as the quadratic coefficient"),
        ),
        Parameter("rest_angle", "rad", "where the spring is slack", scale=Scale(0.5), starts=(0.0,), linear_unit="m"),
    ),
    signature="Swings to both sides of the rest angle differ, and frequency changes with amplitude.",
    shows_in="no recording alone: it acts where a model file states it, and is not looked for",
    source="MuJoCo 4's documentation, XML reference: joint, stiffness.",
    expressed_by={
        "denoc": "joint law",
        "mujoco": "second and third coefficient of joint stiffness",
        "pinocchio": "force handed to the forward dynamics",
        "exudyn": "user function of the connector",
    },
    needs=("stated",),
    confusable_with=("cubic_stiffness", "joint_stiffness"),
    law=JointLaw(("polynomial_square", "polynomial_cube", "polynomial_rest")),
)
