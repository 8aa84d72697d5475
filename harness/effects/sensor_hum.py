"""Hum that a sensor's cable picks up: mains, a motor's switching supply."""

from harness.effects.effect import CHANNEL_UNIT, Effect, Family, Parameter, Plausible, Sensor, SiteKind
from harness.effects.measurement import hum, hum_courses
from harness.effects.scale import Scale

EFFECT = Effect(
    name="sensor_hum",
    title="hum on the sensor",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "amplitude",
            CHANNEL_UNIT,
            "of the wave that is added to the signal; its phase is every recording's own, as mains know nothing of when one begins",
            lower=0.0,
            scale=Scale(0.002, signal=1),
            starts=(1.0,),
            plausible=Plausible(
                Scale(0.002, signal=1), "what mains induce in leads that are shielded, thousandths of the range"
            ),
        ),
        Parameter(
            "frequency",
            "Hz",
            "of the wave; above half the sampling rate, of its alias",
            lower=1e-3,
            scale=Scale(50.0),
            starts=(1.0,),
            search="line",
        ),
    ),
    signature="A steady line in the spectrum far above the motion, as loud at rest as in motion, in step with nothing.",
    shows_in="any recording; clearest when the motion has died down",
    source="Morrison, Grounding and Shielding (2016), ch. 3: power-line interference.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel", "line"),
    confusable_with=("base_excitation", "higher_mode"),
    sensor=Sensor(hum, stage=80, linear=True, courses=hum_courses),
)
