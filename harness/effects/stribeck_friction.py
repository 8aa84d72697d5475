"""Dry friction that is larger at rest and falls with speed to the Coulomb level."""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="stribeck_friction",
    title="Stribeck friction",
    family=Family.DISSIPATION,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "coulomb_torque",
            "N*m",
            "torque against fast sliding",
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
            "static_torque",
            "N*m",
            "the most that holds the joint at rest; not below the Coulomb torque",
            lower=0.0,
            scale=Scale(0.03, torque=1),
            starts=(0.2, 1.5),
            linear_unit="N",
            plausible=Plausible(
                Scale(0.1, torque=1), "breaking loose takes up to twice what sliding does (Armstrong-Hélouvry, 1991)"
            ),
        ),
        Parameter(
            "stribeck_velocity",
            "rad/s",
            "speed over which the excess over the Coulomb torque falls to 1/e, as exp(−(q̇/v)²)",
            lower=1e-6,
            scale=Scale(0.1, frequency=1),
            starts=(0.3, 2.0),
            linear_unit="m/s",
        ),
    ),
    signature="As dry friction, but slow motion loses more than fast motion: the last swings shrink faster than a "
    "straight "
    "envelope, and driven slow motion goes by jerks.",
    shows_in="slow sliding and many reversals: a free decay recorded until rest, or a slow driven motion",
    source="Armstrong-Hélouvry, Dupont and Canudas de Wit, A survey of models, analysis tools and compensation "
    "methods for the "
    "control of machines with friction, Automatica 30 (1994) 1083–1138, with exponent 2.",
    expressed_by={
        "denoc": "joint law, set-valued at rest",
        "exudyn": "friction torque in a user function of the connector, smoothed near rest",
    },
    needs=("motion",),
    simpler=("coulomb_friction",),
    confusable_with=("coulomb_friction", "dahl_friction", "load_dependent_friction"),
    law=JointLaw(("coulomb_torque", "static_torque", "stribeck_velocity")),
)
