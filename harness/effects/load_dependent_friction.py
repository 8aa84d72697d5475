"""Dry friction of a bearing that grows with the force it carries."""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="load_dependent_friction",
    title="load-dependent friction",
    family=Family.DISSIPATION,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "mu_radius",
            "m",
            "coefficient of friction times bearing radius: torque against sliding = mu_radius · reaction force",
            lower=0.0,
            scale=Scale(0.005, length=1),
            starts=(0.2, 2.0),
            linear_unit="1",
            plausible=Plausible(
                Scale(0.005, length=1),
                "a dry bush (0.1) on a shaft of a twentieth of the length; ball bearings far less",
            ),
        ),
    ),
    signature="As dry friction, but more at the bottom of a fast swing, where the bearing also carries the "
    "centrifugal force, "
    "and less at the turning points of a wide one: large swings lose more than dry friction alone would take.",
    shows_in="swings of large and of small amplitude in one recording or several",
    source="Harnoy, Bearing Design in Machinery (2003): journal bearing friction torque = μ R W.",
    expressed_by={"denoc": "joint law with the reaction force of the recursion, set-valued at rest"},
    needs=("motion",),
    confusable_with=("coulomb_friction", "stribeck_friction", "quadratic_drag"),
    law=JointLaw(("mu_radius",)),
    # Where the load does not change it is dry friction by another name, and the plain name is meant.
    rarity=1.5,
)
