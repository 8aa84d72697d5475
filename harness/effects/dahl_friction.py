"""Dry friction with presliding: the contact gives like a spring before it slides."""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="dahl_friction",
    title="Dahl friction",
    family=Family.DISSIPATION,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "torque",
            "N*m",
            "torque against steady sliding",
            lower=0.0,
            scale=Scale(0.02, torque=1),
            starts=(0.1, 1.0),
            linear_unit="N",
            plausible=Plausible(
                Scale(0.1, torque=1),
                "bearings take a hundredth of what gravity does, gears tens of hundredths (Armstrong-Hélouvry, 1991)",
            ),
        ),
        Parameter(
            "stiffness",
            "N*m/rad",
            "of the contact before it slides: dz/dt = q̇ − (stiffness/torque) z |q̇|, torque on the joint −stiffness · z",
            lower=0.0,
            scale=Scale(1.0, torque=1),
            starts=(0.002, 0.02, 0.2, 2.0, 20.0),
            linear_unit="N/m",
        ),
    ),
    signature="As dry friction at large amplitude; at small amplitude the joint swings on like on a spring with "
    "hysteresis, "
    "at a raised frequency, instead of sticking.",
    shows_in="the last, smallest swings before rest",
    source="Dahl, A solid friction model, Aerospace Corporation TOR-0158(3107-18)-1 (1968).",
    expressed_by={"denoc": "joint law with an internal state"},
    needs=("motion",),
    simpler=("coulomb_friction",),
    confusable_with=("coulomb_friction", "stribeck_friction", "joint_stiffness"),
    law=JointLaw(("dahl_torque", "dahl_stiffness")),
)
