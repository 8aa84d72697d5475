"""Clearance where a loop is closed."""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="loop_clearance",
    title="clearance in a loop",
    family=Family.STIFFNESS,
    site=SiteKind.LOOP,
    parameters=(
        Parameter(
            "gap",
            "m",
            "how far the frames that a loop joins may be apart, the radius of the hole less that of its pin: within it they "
            "go free of each other, beyond it they meet a stiff contact with some damping",
            lower=0.0,
            scale=Scale(0.002, length=1),
            starts=(0.5, 2.0, 8.0),
            search="size",
            plausible=Plausible(
                Scale(0.002, length=1), "running fits of plain bearings to worn ones, a part in some hundred of a link"
            ),
        ),
    ),
    signature="Where the force through the loop's closing turns round the recorded joint runs on for the width of the gap and "
    "is hit; between, the mechanism moves as if a link were longer or shorter by the gap.",
    shows_in="motion in which the force through the closing joint turns round",
    source="Flores, Ambrósio, Claro and Lankarani, Kinematics and Dynamics of Multibody Systems with Imperfect Joints "
    "(Springer 2008), ch. 3: the revolute joint with clearance as pin and hole in contact.",
    expressed_by={
        "denoc": "a contact in place of the loop's conditions",
    },
    needs=("motion",),
    confusable_with=("coulomb_friction", "viscous_damping", "sensor_nonlinearity"),
    law=JointLaw(("gap",)),
)
