"""A sensor whose zero is another one in every recording: an encoder that counts from where it was switched on."""

from harness.effects.effect import Effect, Family, Sensor, SiteKind
from harness.effects.measurement import unchanged

EFFECT = Effect(
    name="sensor_zero",
    title="zero of its own in every recording",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(),
    signature="The residual is constant within a recording and differs from one to the next.",
    shows_in="two recordings or more; the finding lists the zeros",
    source="Doebelin, Measurement Systems (2004), ch. 4: incremental encoders have no zero of their own.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel", "several"),
    confusable_with=("sensor_offset", "base_tilt", "sensor_drift"),
    rarity=1.5,  # two recordings that share a zero part it from an offset
    sensor=Sensor(unchanged, stage=72, linear=True, own_zero=True),
)
"""Its zeros are taken as every recording shows them, the one held out too, where nobody could know it."""
