"""A sensor whose scale is off."""

from harness.effects.effect import Effect, Family, Parameter, Plausible, Sensor, SiteKind
from harness.effects.measurement import gain
from harness.effects.scale import Scale

EFFECT = Effect(
    name="sensor_gain",
    title="sensor gain",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "gain",
            "1",
            "signal over truth; 1 is right, negative is a wrong sign",
            neutral=1.0,
            scale=Scale(0.03),
            starts=(1.0, -1.0),
            plausible=Plausible(
                Scale(0.02), "accuracy classes of industrial transducers, 0.1 to 2 % (Doebelin, 2004, ch. 3)"
            ),
        ),
    ),
    signature="The signal is too large or too small by the same factor at every time; a pendulum's frequency then "
    "does not belong to its amplitude.",
    shows_in="amplitudes large enough for the frequency to depend on them, or several channels that must agree",
    source="Doebelin, Measurement Systems (2004), ch. 3: static sensitivity.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel",),
    simpler=(),
    confusable_with=("flexural_rigidity", "sensor_nonlinearity", "viscous_damping"),
    sensor=Sensor(gain, stage=60, linear=True),
)
