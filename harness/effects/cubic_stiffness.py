"""A spring that stiffens (or softens) with the cube of the angle."""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="cubic_stiffness",
    title="cubic spring",
    family=Family.STIFFNESS,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "stiffness",
            "N*m/rad**3",
            "torque = −stiffness · q³; negative softens",
            scale=Scale(0.05, torque=1),
            starts=(0.5, -0.5, 2.0),
            linear_unit="N/m**3",
            plausible=Plausible(Scale(0.1, torque=1), "cables and hoses, a tenth of what gravity does"),
        ),
    ),
    signature="Frequency changes with amplitude otherwise than gravity makes it, and is right for small swings.",
    shows_in="swings of large amplitude beside small ones",
    source="Duffing, Erzwungene Schwingungen bei veränderlicher Eigenfrequenz (1918).",
    expressed_by={
        "denoc": "joint law",
        "mujoco": "third coefficient of joint stiffness",
        "exudyn": "user function of the connector",
    },
    needs=("motion",),
    confusable_with=("joint_stiffness", "sensor_nonlinearity", "sensor_gain"),
    law=JointLaw(("cubic_stiffness",)),
)
