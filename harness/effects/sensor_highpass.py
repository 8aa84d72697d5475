"""A sensor that forgets: a charge amplifier, alternating-current coupling."""

from harness.effects.effect import Effect, Family, Parameter, Plausible, Sensor, SiteKind
from harness.effects.measurement import highpass, highpass_memory
from harness.effects.scale import Scale

EFFECT = Effect(
    name="sensor_highpass",
    title="sensor high-pass",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "cutoff",
            "Hz",
            "of the first order (−3 dB)",
            lower=0.0,
            upper=1e4,
            scale=Scale(0.05, frequency=1),
            starts=(0.2, 1.0, 5.0),
            plausible=Plausible(Scale(0.5), "charge amplifiers, 0.1 to 2 Hz; 2 Hz in the paper"),
        ),
        Parameter(
            "settled",
            "1",
            "what the filter had settled on when the recording began, over the first sample: 1 after a long hold, "
            "0 if it was at rest at zero until just before; in the middle of a motion any value",
            lower=-10.0,
            upper=10.0,
            scale=Scale(1.0),
            starts=(1.0, 0.0),
        ),
    ),
    signature="Slow and constant parts of the signal die away: a resting angle creeps to zero, the swing is early "
    "and too small.",
    shows_in="rest away from zero, or slow motion",
    source="Doebelin, Measurement Systems (2004), ch. 4: charge amplifiers with piezoelectric sensors.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel",),
    simpler=(),
    confusable_with=("sensor_drift", "sensor_offset", "sensor_gain"),
    sensor=Sensor(highpass, stage=40, memory=highpass_memory, remembers=True),
)
