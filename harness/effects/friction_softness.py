"""Dry friction as a soft constraint, as MuJoCo has it: no effect by itself, but another form of what rubs at the joint.

Its torque is −J (q̈ + q̇/τ), but never more than the friction, which is an effect of the catalogue or what the model states.
In MuJoCo's terms τ = timeconst · dmax / 2 and J = d / (1 − d) / invweight, with timeconst the first number of
``solreffriction``, d and dmax the first two of ``solimpfriction``, and invweight the joint's ``dof_invweight0``: by default
9.5 ms and nine times the joint's inertia.
"""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="friction_softness",
    title="softness of dry friction",
    family=Family.DISSIPATION,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "time",
            "s",
            "τ by which friction turns round before the joint does",
            lower=0.0,
            upper=1.0,
            scale=Scale(0.01),
            search="size",
            plausible=Plausible(Scale(0.02), "MuJoCo's own default of solref, 0.02 s"),
        ),
        Parameter(
            "inertia",
            "kg*m**2",
            "J that friction adds to the joint's inertia while it holds; J/τ is then its damping",
            lower=1e-12,
            scale=Scale(1.0, inertia=1),
            starts=(9.0, 0.9),
            linear_unit="kg",
        ),
    ),
    signature="As dry friction, but it changes sides some milliseconds before the joint turns round; where it would hold the "
    "joint, that creeps on.",
    shows_in="a free decay with many reversals, recorded for a while after the last swing",
    source="Todorov, Convex and analytically-invertible dynamics with contacts and constraints, Proc. IEEE Int. Conf. Robotics "
    "and Automation (2014) 6054–6061; MuJoCo's documentation, Computation: constraint model, friction loss.",
    expressed_by={"denoc": "joint law", "mujoco": "frictionloss with solreffriction and solimpfriction"},
    needs=("motion",),
    confusable_with=("viscous_damping", "stribeck_friction", "dahl_friction", "friction_creep"),
    modifies=("coulomb_friction", "stribeck_friction", "load_dependent_friction"),
    law=JointLaw(("soft_time", "soft_inertia")),
)
