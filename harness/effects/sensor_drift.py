"""A sensor whose zero wanders steadily."""

from harness.effects.effect import CHANNEL_UNIT, Effect, Family, Parameter, Plausible, Sensor, SiteKind
from harness.effects.measurement import drift
from harness.effects.scale import Scale

EFFECT = Effect(
    name="sensor_drift",
    title="sensor drift",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "rate",
            CHANNEL_UNIT + "/s",
            "growth of the offset, zero at the first sample",
            scale=Scale(0.02, signal=1, duration=-1),
            starts=(1.0, -1.0),
            plausible=Plausible(
                Scale(0.01, signal=1, duration=-1), "a hundredth of the range in one recording (Doebelin, 2004, ch. 3)"
            ),
        ),
    ),
    signature="The middle of the swing wanders steadily while the swing about it is as modelled.",
    shows_in="long recordings",
    source="Doebelin, Measurement Systems (2004), ch. 3: zero drift.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel",),
    simpler=(),
    confusable_with=("sensor_offset", "sensor_highpass"),
    sensor=Sensor(drift, stage=75, linear=True),
)
