"""A sensor that follows slowly: a filter, a thermal or mechanical lag."""

import numpy as np

from harness.effects.effect import Effect, Family, Parameter, Plausible, Sensor, SiteKind
from harness.effects.measurement import lowpass, lowpass_memory
from harness.effects.scale import Scale

EFFECT = Effect(
    name="sensor_lowpass",
    title="sensor low-pass",
    family=Family.SENSOR,
    site=SiteKind.CHANNEL,
    parameters=(
        Parameter(
            "cutoff",
            "Hz",
            "of the first order (−3 dB); settled at the first sample if the motion starts from rest there",
            lower=1e-4,
            neutral=np.inf,
            scale=Scale(1.0, frequency=1),
            starts=(0.5, 2.0, 10.0, 100.0),
            plausible=Plausible(
                Scale(5.0, interval=1), "filters before sampling let a fifth of the rate through", inverse=True
            ),
        ),
    ),
    signature="Fast parts of the signal are too small and late, slow parts right: vibration is missing in the "
    "record, the swing is late.",
    shows_in="a signal with fast parts, or a known drive",
    source="Doebelin, Measurement Systems (2004), ch. 3: first-order instruments.",
    expressed_by={"any engine": "acts on the signal that any engine predicts"},
    needs=("channel",),
    simpler=(),
    confusable_with=("sensor_delay", "modal_damping", "sensor_gain"),
    sensor=Sensor(lowpass, stage=30, memory=lowpass_memory),
)
