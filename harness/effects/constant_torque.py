"""A torque that is always there: a hanging cable, a preload, an offset of the drive."""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="constant_torque",
    title="constant torque",
    family=Family.STIFFNESS,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "torque",
            "N*m",
            "acts in the positive direction of the joint",
            scale=Scale(0.02, torque=1),
            starts=(1.0, -1.0),
            linear_unit="N",
            plausible=Plausible(Scale(0.3, torque=1), "a counterweight or a current's zero, below what gravity does"),
        ),
    ),
    signature="The equilibrium is shifted, and by a torque: at large amplitude the two sides differ otherwise than "
    "a shift "
    "of the angle's zero would make them.",
    shows_in="any motion about an equilibrium; large amplitudes part it from tilt and sensor offset",
    source="Siciliano et al., Robotics: Modelling, Planning and Control (2009), ch. 7: offset torque in parameter "
    "estimation.",
    expressed_by={
        "denoc": "joint law",
        "mujoco": "qfrc_applied",
        "exudyn": "constant load torque",
        "pinocchio": "added to the joint torque",
    },
    needs=("motion",),
    confusable_with=("base_tilt", "sensor_offset", "com_side_offset", "coulomb_friction", "joint_stiffness"),
    law=JointLaw(("constant_torque",)),
)
