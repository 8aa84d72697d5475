"""A sensor, or its logger, that is late."""

from harness.effects.effect import Effect, Family, Parameter, Plausible, Sensor, SiteKind
from harness.effects.measurement import delay
from harness.effects.scale import Scale

EFFECT = Effect(
    name="sensor_delay",
    title="sensor delay",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "delay",
            "s",
            "time from the motion to its record; negative if the other channels are late",
            lower=-1.0,
            upper=10.0,
            scale=Scale(2.0, interval=1),
            starts=(1.0, 5.0),
            plausible=Plausible(
                Scale(0.02),
                "buses and filters, some milliseconds (Åström and Wittenmark, Computer-Controlled Systems, 1997)",
            ),
        ),
    ),
    signature="The signal is the modelled one shifted in time, against the known drive or the other channels.",
    shows_in="a known drive, several channels, or the beginning of a motion from rest",
    source="Ljung, System Identification (1999), ch. 14: pre-treatment of data.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel",),
    simpler=(),
    confusable_with=("sensor_lowpass", "actuator_delay", "late_release"),
    sensor=Sensor(delay, stage=20),
)
