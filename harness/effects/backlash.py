"""Play between the drive side of a joint and its link."""

from harness.effects.drive_side import with_drive_side
from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="backlash",
    title="backlash",
    family=Family.STIFFNESS,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "gap",
            "rad",
            "whole play: the link is free against the drive side within ±gap/2, beyond it meets stiff teeth",
            lower=0.0,
            scale=Scale(0.01),
            starts=(0.3, 3.0),
            linear_unit="m",
            plausible=Plausible(Scale(0.01), "gearheads, 1 to 60 arc minutes by their catalogues"),
        ),
    ),
    signature="At reversals of the driving torque the measured side runs on alone for the width of the gap, then is "
    "hit; "
    "small motions are lost or chatter.",
    shows_in="motion in which the torque in the joint changes sign, with the drive side measured and with inertia "
    "or friction "
    "of its own",
    source="Nordin and Gutman, Controlling mechanical systems with backlash: a survey, Automatica 38 (2002) 1633–1649.",
    expressed_by={
        "denoc": "a joint with play between drive side and link",
        "mujoco": "a further joint and passive forces with a dead zone",
        "exudyn": "a further body and a dead zone in a user function",
    },
    needs=("motion",),
    confusable_with=("joint_flexibility", "dahl_friction", "sensor_nonlinearity"),
    reshape=Reshape(with_drive_side, topology=True),
)
