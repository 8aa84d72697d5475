"""A sensor whose zero is off."""

from harness.effects.effect import CHANNEL_UNIT, Effect, Family, Parameter, Plausible, Sensor, SiteKind
from harness.effects.measurement import offset
from harness.effects.scale import Scale

EFFECT = Effect(
    name="sensor_offset",
    title="sensor offset",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "offset",
            CHANNEL_UNIT,
            "added to the signal",
            scale=Scale(0.02, signal=1),
            starts=(1.0, -1.0),
            plausible=Plausible(
                Scale(0.03, signal=1), "zero balance of transducers, 1 to 3 % of the range (Doebelin, 2004, ch. 3)"
            ),
        ),
    ),
    signature="The whole signal is shifted by the same amount at every time.",
    shows_in="any recording",
    source="Doebelin, Measurement Systems (2004), ch. 3: static characteristics, zero offset.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel",),
    simpler=(),
    confusable_with=("base_tilt", "com_side_offset", "constant_torque"),
    sensor=Sensor(offset, stage=70, linear=True),
)
