"""Dry friction that gives way slowly instead of holding: no effect by itself, but another form of what rubs at the joint.

The friction may be an effect of the catalogue or what the model states.
"""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="friction_creep",
    title="creep of dry friction",
    family=Family.DISSIPATION,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "velocity",
            "rad/s",
            "speed v_c under which dry friction gives way: all of it at the joint acts times tanh(q̇/v_c), at rest too",
            lower=1e-9,
            scale=Scale(0.01, frequency=1),
            starts=(0.003, 0.1, 3.0, 40.0),
            search="size",
            linear_unit="m/s",
            plausible=Plausible(
                Scale(0.01, frequency=1), "slower than what is seen as rest: a hundredth of a radian in a swing's phase"
            ),
        ),
    ),
    signature="As dry friction while it slides; but where that would hold the joint, it creeps on towards the equilibrium, "
    "the faster the nearer the force is to the friction.",
    shows_in="a free decay recorded for a while after the last swing",
    source="Marques, Flores, Pimenta Claro and Lankarani, A survey and comparison of several friction force models for dynamic "
    "analysis of multibody mechanical systems, Nonlinear Dynamics 86 (2016) 1407–1443: Coulomb's law regularized by a hyperbolic "
    "tangent, as many simulators have it; greased bearings creep as well.",
    expressed_by={"denoc": "joint law"},
    needs=("motion",),
    confusable_with=("viscous_damping", "stribeck_friction", "dahl_friction", "friction_softness"),
    modifies=("coulomb_friction", "stribeck_friction", "load_dependent_friction"),
    law=JointLaw(("creep_velocity",)),
)
