"""A beam stiffer or softer in bending than its table says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from harness.effects.effect import Effect, Family, Parameter, Plausible, Reshape, SiteKind
from harness.effects.scale import Scale
from harness.errors import InputError
from harness.system import System


def _scale(system: System, site: str, parameters: Mapping[str, float]) -> System:
    link = system.link(site)
    if link.beam is None:
        raise InputError(f"link {site!r} is rigid", mend="flexural rigidity needs a link that bends")
    factor = parameters["factor"]
    beam = replace(
        link.beam,
        bending_stiffness=link.beam.bending_stiffness * factor,
        bending_stiffness2=link.beam.bending_stiffness2 * factor,
        youngs_modulus=link.beam.youngs_modulus * factor,
    )
    return system.replace_link(replace(link, beam=beam))


EFFECT = Effect(
    name="flexural_rigidity",
    title="flexural rigidity off",
    family=Family.ELASTICITY,
    site=SiteKind.LINK,
    parameters=(
        Parameter(
            "factor",
            "1",
            "real EI over the model's",
            lower=0.01,
            upper=100.0,
            neutral=1.0,
            scale=Scale(0.1),
            starts=(1.0, -1.0, 5.0, -5.0),
            search="spectrum",
            plausible=Plausible(Scale(0.2), "moduli and thicknesses of stock, 5 % each, the latter to the third power"),
        ),
    ),
    signature="The vibration's frequency is off (as the square root of the factor), and static deflection inversely.",
    shows_in="vibration or slow deflection seen by strain, deflection or acceleration",
    source="Meirovitch, Fundamentals of Vibrations (2001), ch. 8: ω = (βl)² √(EI/ρ)/l².",
    expressed_by={
        "denoc": "bending stiffness of the beam",
        "exudyn": "bending stiffness of the cable elements",
        "analytic": "closed form of the mounted beam",
    },
    needs=("flexible",),
    confusable_with=("payload_mass", "sensor_gain", "geometric_stiffening"),
    reshape=Reshape(_scale),
)
