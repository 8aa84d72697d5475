"""All residual checks, in the order in which they are asked and told; one file of this package each."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from harness.diagnose.criticism.check import Check
from harness.registered import registered

NAMES = (
    "smooth_force",
    "force_at_places",
    "force_of_few_terms",
    "force_at_one_place",
    "force_once",
    "relaxing_force",
    "force_setting_in",
    "louder_stretch",
    "swing_spectrum",
    "reading_jump",
    "wandering_reading",
    "crosstalk",
    "nominal_tolerance",
    "held_out_misfit",
    "creep",
    "vertical_shaking",
)


@cache
def checks() -> Mapping[str, Check]:
    """Every residual check by its file's name."""
    return registered(__package__, NAMES, Check)
