"""A hand that lets go after the recording has begun; acts on every channel."""

from harness.effects.effect import Effect, Family, Parameter, Plausible, Sensor, SiteKind
from harness.effects.measurement import release
from harness.effects.scale import Scale

EFFECT = Effect(
    name="late_release",
    title="late release",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "delay",
            "s",
            "from the first sample to the letting go",
            lower=0.0,
            upper=60.0,
            scale=Scale(0.1, frequency=-1),
            starts=(0.3, 3.0),
            search="range",
            plausible=Plausible(Scale(0.2), "a hand lets go within some tenths of a second"),
        ),
    ),
    signature="The signal stands still at first, then the motion is the modelled one, late by the same time "
    "throughout.",
    shows_in="free motion from rest; all of it if the recording begins before the letting go",
    source="Recordings of released pendulums begin with a hand on them; the law is a shift of the motion's beginning.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel", "free"),
    simpler=(),
    confusable_with=("sensor_delay", "sensor_lowpass"),
    rarity=1.5,
    sensor=Sensor(release, stage=5, every_channel=True, at_first=True),
)
