"""A drive side that is coupled to its link by a spring: gear, belt, shaft."""

from harness.effects.drive_side import with_drive_side
from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="joint_flexibility",
    title="flexible joint",
    family=Family.STIFFNESS,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "stiffness",
            "N*m/rad",
            "of the coupling between the drive side, which is measured, driven and rubs, and the link",
            lower=1e-9,
            neutral=float("inf"),
            scale=Scale(30.0, torque=1),
            starts=(0.2, 1.0, 10.0),
            linear_unit="N/m",
            plausible=Plausible(
                Scale(0.01, torque=-1),
                "gears and belts twist by some thousandths of a radian under the arm's weight",
                inverse=True,
            ),
        ),
        Parameter(
            "damping",
            "N*m*s/rad",
            "of the coupling",
            lower=0.0,
            scale=Scale(0.1, torque=1, frequency=-1),
            starts=(0.1, 1.0),
            linear_unit="N*s/m",
        ),
    ),
    signature="A fast decaying vibration after every sudden change of torque, reversals of dry friction included, "
    "at one frequency.",
    shows_in="driven motion with sudden changes; a drive side with inertia or friction of its own",
    source="Spong, Modeling and control of elastic joint robots, J. Dyn. Syst. Meas. Control 109 (1987) 310–319.",
    expressed_by={
        "denoc": "a further joint with stiffness and damping between drive side and link",
        "mujoco": "a further joint with stiffness and damping",
        "exudyn": "a further body and a torsional spring-damper",
    },
    needs=("motion",),
    confusable_with=("backlash", "link_flexibility", "base_compliance"),
    reshape=Reshape(with_drive_side, topology=True),
)
