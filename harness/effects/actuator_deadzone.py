"""A drive that does not answer small efforts."""

from harness.effects.effect import Effect, Family, Input, Parameter, Plausible, SiteKind
from harness.effects.measurement import deadzone
from harness.effects.scale import Scale

EFFECT = Effect(
    name="actuator_deadzone",
    title="actuator dead zone",
    family=Family.INPUT,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "width",
            "N*m",
            "efforts up to this magnitude do nothing, larger ones act with what is over it",
            lower=0.0,
            scale=Scale(0.05, effort=1),
            starts=(0.3, 2.0),
            linear_unit="N",
            plausible=Plausible(
                Scale(0.05, effort=1),
                "servo drives, a few hundredths of their range (Tao and Kokotović, Wiley, 1996)",
            ),
        ),
    ),
    signature="Small efforts do nothing, large ones are short by the same amount, either sign alike.",
    shows_in="driven motion with small and large efforts",
    source="Tao and Kokotović, Adaptive control of plants with unknown dead-zones, IEEE Trans. Autom. Control 39 "
    "(1994) 59–68.",
    expressed_by={"any engine": "acts on the effort that is handed to any engine"},
    needs=("effort",),
    simpler=(),
    confusable_with=("coulomb_friction", "actuator_gain"),
    input=Input(deadzone, stage=50, nonlinear=True),
)
