"""One more bending mode of a flexible link than the model keeps."""

from __future__ import annotations

from harness.effects.bending import add_mode, next_mode
from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale

EFFECT = Effect(
    name="higher_mode",
    title="a further bending mode",
    family=Family.ELASTICITY,
    site=SiteKind.LINK,
    parameters=(
        Parameter(
            "frequency",
            "Hz",
            "of the added mode, as mounted",
            lower=1e-3,
            upper=1e5,
            scale=Scale(20.0, frequency=1),
            starts=(1.0, 3.0),
            search="spectrum",
        ),
        Parameter(
            "damping_ratio",
            "1",
            "of the added mode",
            lower=0.0,
            upper=0.99,
            scale=Scale(0.01),
            starts=(0.01, 0.3, 3.0),
            plausible=Plausible(
                Scale(0.02), "metals and clamps: 0.0019 for the paper's strip, ten times that for bolted ones"
            ),
        ),
    ),
    signature="A second, higher frequency in strain, deflection or tip acceleration after a release or an impact.",
    shows_in="a sample rate above twice the frequency and a sensor on the link",
    source="Meirovitch, Fundamentals of Vibrations (2001), ch. 8: bending vibration of beams.",
    expressed_by={"denoc": "one more mode of the beam", "exudyn": "ANCF cable elements, which have it already"},
    needs=("flexible", "deflection", "exact shapes"),
    confusable_with=("base_compliance", "joint_flexibility", "sensor_hum"),
    reshape=Reshape(add_mode, topology=True, expected=next_mode),
)
