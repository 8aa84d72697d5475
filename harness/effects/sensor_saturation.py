"""A sensor that shows no more than so much."""

import numpy as np

from harness.effects.effect import CHANNEL_UNIT, Effect, Family, Parameter, Sensor, SiteKind
from harness.effects.measurement import saturation
from harness.effects.scale import Scale

EFFECT = Effect(
    name="sensor_saturation",
    title="sensor saturation",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "limit",
            CHANNEL_UNIT,
            "largest magnitude that the sensor shows",
            lower=0.0,
            neutral=np.inf,
            scale=Scale(0.9, signal=1),
            starts=(1.0, 0.7),
            search="range",
        ),
    ),
    signature="The signal is cut off flat at the same magnitude; between, it is as modelled.",
    shows_in="motion beyond the limit",
    source="Doebelin, Measurement Systems (2004), ch. 3: span and overload.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel",),
    simpler=(),
    confusable_with=("end_stop", "sensor_nonlinearity"),
    sensor=Sensor(saturation, stage=90),
)
