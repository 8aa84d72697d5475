"""Dry friction as a soft constraint, as MuJoCo has it: no effect by itself, but another form of what rubs at the joint.

With F the friction (an effect of the catalogue, or what the model states) its torque is −F (q̇ + τ q̈)/v_c, never more than F: held,
the joint has inertia F τ/v_c added and is damped. In MuJoCo's terms τ = timeconst · dmax / 2 and F τ/v_c = d/(1 − d)/invweight,
with timeconst the first number of ``solreffriction``, d and dmax the first two of ``solimpfriction``, and invweight the joint's
``dof_invweight0``.
"""

from harness.effects.effect import Effect, Family, JointLaw, Parameter, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="friction_softness",
    title="softness of dry friction",
    family=Family.DISSIPATION,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "velocity",
            "rad/s",
            "speed v_c at which the joint creeps where the whole friction holds it",
            lower=1e-9,
            scale=Scale(0.01, frequency=1),
            starts=(0.003, 0.1, 3.0),
            search="size",
            linear_unit="m/s",
        ),
        Parameter(
            "time",
            "s",
            "τ by which friction turns round before the joint does",
            lower=1e-6,
            scale=Scale(0.01),
            starts=(1.0, 0.1),
        ),
    ),
    signature="As dry friction, but it changes sides some milliseconds before the joint turns round; where it would hold the "
    "joint, that creeps on.",
    shows_in="a free decay with many reversals, recorded for a while after the last swing",
    source="Todorov, Convex and analytically-invertible dynamics with contacts and constraints, Proc. IEEE Int. Conf. Robotics "
    "and Automation (2014) 6054–6061; MuJoCo's documentation, Computation: constraint model, friction loss.",
    expressed_by={"denoc": "joint law", "mujoco": "frictionloss with solreffriction and solimpfriction"},
    needs=("motion",),
    simpler=("friction_creep",),
    confusable_with=("viscous_damping", "stribeck_friction", "dahl_friction"),
    modifies=("coulomb_friction", "stribeck_friction", "load_dependent_friction"),
    law=JointLaw(("creep_velocity", "softness_time")),
)
