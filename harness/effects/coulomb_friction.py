"""Dry friction that truly sticks.

Friction that differs with direction, T₊ and T₋, is dry friction of (T₊ + T₋)/2 with a constant torque of (T₋ − T₊)/2,
sliding and sticking alike, so it needs no effect of its own.
"""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="coulomb_friction",
    title="Coulomb (dry) friction",
    family=Family.DISSIPATION,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "torque",
            "N*m",
            "torque against sliding, and the most that holds the joint at rest, beside what the model states",
            lower=0.0,
            scale=Scale(0.02, torque=1),
            starts=(0.1, 1.0),
            linear_unit="N",
            plausible=Plausible(
                Scale(0.1, torque=1),
                "bearings take a hundredth of what gravity does, gears tens of hundredths (Armstrong-Hélouvry, 1991)",
            ),
        ),
    ),
    signature="The amplitude falls by the same amount in every half-swing (straight envelope); the motion ends "
    "suddenly and "
    "away from the equilibrium; energy lost in a half-swing grows in proportion to the amplitude.",
    shows_in="reversals and small amplitudes; best a free decay recorded until rest",
    source="Coulomb, Théorie des machines simples (1785); Feeny and Liang, A decrement method for the simultaneous "
    "estimation "
    "of Coulomb and viscous friction, J. Sound Vib. 195 (1996) 149–154.",
    expressed_by={
        "denoc": "joint friction, set-valued at rest",
        "mujoco": "joint frictionloss: sliding turns over two steps early, rest creeps",
        "exudyn": "friction torque in a user function of the connector, smoothed near rest",
        "analytic": "half-swing by half-swing: a shifted equilibrium",
    },
    needs=("motion",),
    confusable_with=("viscous_damping", "stribeck_friction", "load_dependent_friction", "dahl_friction", "base_tilt"),
    law=JointLaw(("coulomb_torque",)),
)
