"""Damping of a link's bending modes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale
from harness.errors import InputError
from harness.system import System


def _damp(system: System, site: str, parameters: Mapping[str, float]) -> System:
    link = system.link(site)
    if link.beam is None:
        raise InputError(f"link {site!r} is rigid", mend="modal damping needs a link that bends")
    ratios = (parameters["damping_ratio"],) * link.beam.modes
    return system.replace_link(replace(link, beam=replace(link.beam, modal_damping=ratios)))


EFFECT = Effect(
    name="modal_damping",
    title="damping of the bending modes",
    family=Family.ELASTICITY,
    site=SiteKind.LINK,
    parameters=(
        Parameter(
            "damping_ratio",
            "1",
            "of every mode of the link as mounted; the model's own modal damping replaced, that of the material kept",
            lower=0.0,
            upper=0.99,
            scale=Scale(0.01),
            starts=(0.3, 3.0),
            plausible=Plausible(
                Scale(0.02), "metals and clamps: 0.0019 for the paper's strip, ten times that for bolted ones"
            ),
        ),
    ),
    signature="The link's vibration dies away sooner than modelled; the swing does not.",
    shows_in="vibration after a release or an impact, seen by strain, deflection or acceleration",
    source="Meirovitch, Fundamentals of Vibrations (2001), ch. 7: modal damping.",
    expressed_by={
        "denoc": "modal damping ratios of the beam",
        "exudyn": "stiffness-proportional damping set at the first mode",
    },
    needs=("flexible",),
    confusable_with=("viscous_damping", "sensor_lowpass"),
    reshape=Reshape(_damp),
)
