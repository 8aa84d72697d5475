"""An encoder whose disc is eccentric or whose interpolation is uneven."""

import numpy as np

from harness.effects.effect import CHANNEL_UNIT, Effect, Family, Parameter, Plausible, Sensor, SiteKind
from harness.effects.measurement import periodic_error
from harness.effects.scale import Scale

EFFECT = Effect(
    name="encoder_interpolation",
    title="periodic encoder error",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "amplitude",
            CHANNEL_UNIT,
            "largest error: amplitude · sin(periods · signal + phase)",
            lower=0.0,
            upper=0.2,  # a disc more eccentric than that reads backwards somewhere
            scale=Scale(0.002, signal=1),
            starts=(1.0,),
            plausible=Plausible(Scale(0.001), "a disc of 10 mm radius that sits 10 µm off its centre"),
        ),
        Parameter(
            "periods",
            "1/rev",
            "periods in one turn; 1 is an eccentric disc",
            lower=0.5,
            upper=5000.0,
            scale=Scale(1.0),
            starts=(1.0, 2.0, 4.0),
            search="range",
        ),
        Parameter(
            "phase",
            "rad",
            "of the sine at zero signal",
            lower=-2.0 * np.pi,
            upper=2.0 * np.pi,
            scale=Scale(1.0),
            starts=(0.0, 0.5 * np.pi, np.pi, -0.5 * np.pi),
            search="range",
        ),
    ),
    signature="The residual is a wave over the angle, the same going and coming and at every speed.",
    shows_in="motion over at least one period of the angle, with noise below the error",
    source="Doebelin, Measurement Systems (2004), ch. 4: encoders.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel", "angle"),
    simpler=(),
    confusable_with=("sensor_nonlinearity", "cogging_torque", "imbalance", "sensor_offset", "sensor_gain", "base_tilt"),
    rarity=1.5,
    sensor=Sensor(periodic_error, stage=55, linear=True),
)
