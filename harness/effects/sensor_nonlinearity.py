"""A sensor whose calibration is curved: a potentiometer at its ends, an arc taken for its chord."""

from harness.effects.effect import (
    PER_CHANNEL_UNIT,
    PER_CHANNEL_UNIT_SQUARED,
    Effect,
    Family,
    Parameter,
    Plausible,
    Sensor,
    SiteKind,
)
from harness.effects.measurement import nonlinearity
from harness.effects.scale import Scale

EFFECT = Effect(
    name="sensor_nonlinearity",
    title="sensor nonlinearity",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "quadratic",
            PER_CHANNEL_UNIT,
            "signal + quadratic · signal²",
            scale=Scale(0.03, signal=-1),
            starts=(0.0, 1.0, -1.0),
            plausible=Plausible(
                Scale(0.01, signal=-1), "linearity of transducers, 0.1 to 1 % of the range (Doebelin, 2004, ch. 3)"
            ),
        ),
        Parameter(
            "cubic",
            PER_CHANNEL_UNIT_SQUARED,
            "… + cubic · signal³",
            scale=Scale(0.03, signal=-2),
            starts=(0.0, 1.0, -1.0),
            plausible=Plausible(
                Scale(0.01, signal=-2), "linearity of transducers, 0.1 to 1 % of the range (Doebelin, 2004, ch. 3)"
            ),
        ),
    ),
    signature="The residual is a curve over the signal itself, the same going and coming, and small near zero.",
    shows_in="large amplitudes",
    source="Doebelin, Measurement Systems (2004), ch. 3: nonlinearity of the static calibration.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel",),
    simpler=(),
    confusable_with=("cubic_stiffness", "sensor_gain", "sensor_saturation", "encoder_interpolation"),
    sensor=Sensor(nonlinearity, stage=50, linear=True),
)
