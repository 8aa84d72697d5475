"""Which effects recordings may fail to part: as far as a list of what a finding "cannot be told from" is believed.

Without a limit, one finding that lists the whole catalogue would be right everywhere. Listed effects count where the catalogue
says that the two are mistaken for each other, or where they belong to one of the families below, and each costs: a finding among
N is worth 1/N (``score.CaseScore.worth``). One rule for every entrant and for the diagnosis itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from harness.effects.catalogue import catalogue

# Effects that leave one and the same trace on an angle, or cannot both be planted at one place.
FAMILIES = (
    {"coulomb_friction", "stribeck_friction", "load_dependent_friction", "dahl_friction"},
    {"sensor_offset", "base_tilt", "constant_torque", "sensor_drift", "sensor_zero", "com_side_offset"},
    {"payload_mass", "added_inertia", "com_offset", "clock_skew", "joint_stiffness", "sensor_gain"},
    {"sensor_delay", "sensor_lowpass", "sensor_highpass", "late_release"},
    # What lies beside the line is the link's own mass, in one piece.
    {"com_side_offset", "payload_mass"},
    {"link_inertia", "payload_mass", "added_inertia", "com_offset"},
    {"com_side_offset", "link_flexibility"},
    {"base_tilt", "base_excitation"},
    {"sensor_nonlinearity", "cubic_stiffness", "sensor_gain", "encoder_interpolation"},
    # A spring whose rest is free takes a constant torque up exactly.
    {"joint_stiffness", "constant_torque"},
    {"joint_flexibility", "backlash", "link_flexibility", "base_compliance", "base_excitation"},
)


@cache
def mistaken_for(effect: str) -> frozenset[str]:
    """Effects that may be taken for this one: both ways of the catalogue's "mistaken for" and "contains", and its families."""
    known = catalogue()
    found = {name for family in FAMILIES if effect in family for name in family}
    for name, other in known.items():
        if effect in (*other.confusable_with, *other.simpler):
            found.add(name)
    if effect in known:
        found.update((*known[effect].confusable_with, *known[effect].simpler))
    return frozenset(found - {effect})


def as_well(finding: Mapping[str, Any]) -> Iterator[tuple[str, str | None]]:
    """What a finding is said to be as well, each once: effect and site.

    A bare name is of the finding's own site; None, wherever it acts, where it sits at another kind of thing (joint, link, …).
    """
    known = catalogue()
    own = known[finding["effect"]].site if finding["effect"] in known else None
    seen = set()
    for text in finding.get("indistinguishable_from", ()):
        effect, _, at = text.partition("@")
        kind = known[effect].site if effect in known else own
        item = (effect, at or (finding["site"] if kind == own else None))
        if item not in seen and item != (finding["effect"], finding["site"]):
            seen.add(item)
            yield item


def believed(finding: Mapping[str, Any], effect: str, site: str) -> bool:
    """Whether a finding says that it may be this effect at this site, and that is a thing which may be mistaken for it."""
    alike = mistaken_for(finding["effect"]) | {finding["effect"]}
    return effect in alike and any(name == effect and at in (None, site) for name, at in as_well(finding))
