"""A drive that gives no more than so much."""

import numpy as np

from harness.effects.effect import Effect, Family, Input, Parameter, Plausible, SiteKind
from harness.effects.measurement import saturation
from harness.effects.scale import Scale

EFFECT = Effect(
    name="actuator_saturation",
    title="actuator saturation",
    family=Family.INPUT,
    site=SiteKind.JOINT,
    parameters=(
        Parameter(
            "limit",
            "N*m",
            "largest magnitude of effort that acts, however much is asked for",
            lower=0.0,
            neutral=np.inf,
            scale=Scale(0.9, effort=1),
            starts=(1.0, 0.85, 0.7, 0.5),
            search="size",
            linear_unit="N",
            plausible=Plausible(
                Scale(1.0, effort=-1), "drives are chosen to give about what will be asked of them", inverse=True
            ),
        ),
    ),
    signature="Efforts act as recorded up to the same magnitude either way, and no further.",
    shows_in="driven motion whose recorded effort is a command or a voltage, with some larger than the drive can give",
    source="Goodwin, Graebe and Salgado, Control System Design (2001), ch. 11: inputs that are limited.",
    expressed_by={"any engine": "acts on the effort that is handed to any engine"},
    needs=("effort",),
    simpler=(),
    confusable_with=("actuator_gain",),
    input=Input(saturation, stage=60, nonlinear=True),
)
