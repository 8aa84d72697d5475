"""Drag of the air, and whatever else grows with the square of the speed."""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="quadratic_drag",
    title="quadratic drag",
    family=Family.DISSIPATION,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "coefficient",
            "N*m*s**2/rad**2",
            "torque against the motion = coefficient · q̇ |q̇|",
            lower=0.0,
            scale=Scale(0.01, torque=1, frequency=-2),
            starts=(0.2, 2.0),
            linear_unit="N*s**2/m**2",
            plausible=Plausible(
                Scale(0.06, inertia=1, length=1),
                "air of 1.2 kg/m³ against 10 kg for each square metre of front, C_d = 1 (Hoerner, Fluid-Dynamic Drag (1965))",
            ),
        ),
    ),
    signature="Wide swings shrink fast, small ones hardly (envelope falls as 1/t); energy lost in a half-swing "
    "grows with "
    "the cube of the amplitude.",
    shows_in="large and small amplitudes in one recording",
    source="Nelson and Olsson, The pendulum: rich physics from a simple system, Am. J. Phys. 54 (1986) 112–121: "
    "quadratic air drag.",
    expressed_by={
        "denoc": "joint law",
        "mujoco": "second coefficient of joint damping",
        "exudyn": "user function of the connector",
    },
    needs=("motion",),
    confusable_with=("viscous_damping", "load_dependent_friction"),
    law=JointLaw(("quadratic_drag",)),
)
