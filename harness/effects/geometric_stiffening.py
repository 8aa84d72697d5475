"""Foreshortening of a bent link, which stiffens it when it turns fast or hangs under load."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from harness.effects.effect import Effect, Family, Reshape, SiteKind
from harness.errors import InputError
from harness.system import System


def _stiffen(system: System, site: str, parameters: Mapping[str, float]) -> System:
    link = system.link(site)
    if link.beam is None:
        raise InputError(f"link {site!r} is rigid", mend="geometric stiffening needs a link that bends")
    return system.replace_link(replace(link, beam=replace(link.beam, geometric_stiffening=True)))


EFFECT = Effect(
    name="geometric_stiffening",
    title="geometric stiffening",
    family=Family.ELASTICITY,
    site=SiteKind.LINK,
    parameters=(),
    signature="The vibration is faster than modelled while the link turns fast, and the deflection in fast turns "
    "smaller.",
    shows_in="fast turning of a flexible link that the model keeps without stiffening",
    source="Kane, Ryan and Banerjee, Dynamics of a cantilever beam attached to a moving base, J. Guid. Control Dyn. "
    "10 (1987) "
    "139–151.",
    expressed_by={
        "denoc": "second-order axial displacement of the beam",
        "exudyn": "ANCF cable elements, which have it already",
    },
    needs=("flexible", "unstiffened"),
    confusable_with=("flexural_rigidity",),
    reshape=Reshape(_stiffen, topology=True),
)
