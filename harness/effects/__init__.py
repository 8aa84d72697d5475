"""The catalogue: law, parameters with units and bounds, words, how each engine expresses it."""

from harness.effects.attach import apply, compatible, input_chain, sensor_chain
from harness.effects.catalogue import catalogue, effect, sites
from harness.effects.effect import (
    Effect,
    Family,
    Input,
    JointLaw,
    Parameter,
    Reshape,
    Sensor,
    SiteKind,
    UserLaw,
)
from harness.effects.lanes import lane_model, lane_row
from harness.effects.scale import References, Scale, references
from harness.effects.user import load_user_effects

__all__ = [
    "Effect",
    "Family",
    "Input",
    "JointLaw",
    "Parameter",
    "References",
    "Reshape",
    "Scale",
    "Sensor",
    "SiteKind",
    "UserLaw",
    "apply",
    "catalogue",
    "compatible",
    "effect",
    "input_chain",
    "lane_model",
    "lane_row",
    "load_user_effects",
    "references",
    "sensor_chain",
    "sites",
]
