"""A stop as a soft constraint, as MuJoCo has it: no effect by itself, but another form of a stop that the joint runs into.

It pushes with K δ + C δ̇ + J δ̈, δ how far the joint is beyond it, as long as that pushes; stiffness K and damping C are the
stop's own. In MuJoCo's terms J = d / (1 − d) / invweight, C = 2 J / (dmax timeconst) and K = J d / (dmax timeconst dampratio)²,
with timeconst and dampratio of ``solreflimit``, d and dmax the first two numbers of ``solimplimit``, and invweight the joint's
``dof_invweight0``. By default d goes from 0.9 to 0.95 over the first thousandth of a radian: J is nine to nineteen times the
joint's inertia, and what acts on the joint beside the stop counts for little while it pushes.
"""

from collections.abc import Mapping

from harness.effects.effect import Effect, Family, JointLaw, Parameter, Plausible, SiteKind
from harness.effects.scale import References, Scale


def _as_strong(own: Mapping[str, float], stop: Mapping[str, float], references: References) -> dict[str, float]:
    """The stop that slows the joint as much as it did without an inertia."""
    share = 1.0 + own["inertia"] / references.inertia
    return {**stop, "stiffness": share * stop["stiffness"], "damping": share * stop["damping"]}


EFFECT = Effect(
    name="stop_inertia",
    title="inertia of a stop",
    family=Family.STIFFNESS,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "inertia",
            "kg*m**2",
            "J that the stop adds to the joint's inertia while it pushes",
            lower=0.0,
            scale=Scale(1.0, inertia=1),
            starts=(19.0, 1.0),
            linear_unit="kg",
            plausible=Plausible(
                Scale(1.0, inertia=1),
                "rotors seen through gears are as heavy as the arm they drive (Armstrong et al., ICRA 1986)",
            ),
        ),
    ),
    signature="As an end stop, but while it pushes, gravity and drive hardly count, and the blow takes longer.",
    shows_in="motion that runs into the stop and leans on it, recorded at a rate that resolves the blow",
    source="Todorov, Convex and analytically-invertible dynamics with contacts and constraints, Proc. IEEE Int. Conf. Robotics "
    "and Automation (2014) 6054–6061; MuJoCo's documentation, Computation: constraint model, solver parameters.",
    expressed_by={"denoc": "joint law", "mujoco": "joint limit with solreflimit and solimplimit"},
    needs=("motion",),
    confusable_with=("end_stop",),
    modifies=("end_stop",),
    alongside=_as_strong,
    law=JointLaw(("stop_inertia",)),
)
