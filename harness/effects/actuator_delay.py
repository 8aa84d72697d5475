"""A drive that acts late."""

from harness.effects.effect import Effect, Family, Input, Parameter, Plausible, SiteKind
from harness.effects.measurement import held_delay
from harness.effects.scale import Scale

EFFECT = Effect(
    name="actuator_delay",
    title="actuator delay",
    family=Family.INPUT,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "delay",
            "s",
            "from the recorded effort to the one that acts",
            lower=0.0,
            upper=10.0,
            scale=Scale(2.0, interval=1),
            starts=(1.0, 5.0),
            plausible=Plausible(
                Scale(0.02),
                "buses and drives of laboratory rigs, some milliseconds (Åström and Wittenmark, Computer-Controlled Systems, 1997)",
            ),
        ),
    ),
    signature="The response to every change of the drive is late by the same time.",
    shows_in="driven motion that changes fast",
    source="Ljung, System Identification (1999), ch. 14: pre-treatment of data.",
    expressed_by={"any engine": "acts on the effort that is handed to any engine"},
    needs=("effort",),
    simpler=(),
    confusable_with=("sensor_delay", "sensor_lowpass"),
    input=Input(held_delay, stage=20),
)
