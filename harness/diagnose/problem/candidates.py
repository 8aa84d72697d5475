"""Which effects could be missing from a system, as far as the recordings at hand could show them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.diagnose.problem.hypothesis import Candidate
from harness.effects.catalogue import catalogue, sites
from harness.effects.catalogue import effect as named
from harness.effects.effect import BY_MODEL, Effect, SiteKind
from harness.effects.lanes import lane_model
from harness.effects.lines import lines_of
from harness.effects.measured import Measured
from harness.effects.room import with_room
from harness.effects.scale import References, references
from harness.errors import InputError
from harness.system import System

# Of laws that hang on a joint's reaction: constraint forces pass through it, too.
UNKNOWN_BESIDE_LOOPS = frozenset({"mu_radius", "soft_time", "soft_inertia"})


def candidates(
    system: System, recordings: Sequence[Measured], *, only: Sequence[str] = (), further: Sequence[Effect] = ()
) -> tuple[Candidate, ...]:
    """Every effect of the catalogue at every site where one of the recordings could show it.

    only: names to restrict the search to; InputError, with the nearest name, if there is no such effect. further: effects of the
    user's own.
    """
    for name in sorted(set(only) - {own.name for own in further}):
        named(name)
    effects = [e for e in catalogue().values() if not only or e.name in only] + list(further)
    found: dict[str, Candidate] = {}
    for effect in effects:
        if "several" in effect.needs and len(recordings) < 2:
            continue
        for recording in recordings:
            for site in sites(effect, system, recording):
                key = f"{effect.name}@{site}"
                if key in found:
                    continue
                law = _on_its_own(_within_sampling(with_room(effect, system, site), recordings), system, site)
                sizes = references(system, site, recording)
                candidate = Candidate(_at_lines(law, system, site, sizes, recording), site, sizes)
                if _possible(candidate, system):
                    found[key] = candidate
    return tuple(found.values())


def _within_sampling(effect: Effect, recordings: Sequence[Measured]) -> Effect:
    """The effect with no vibration of its own above the finest sampling rate, where none is seen and every run is dear.

    What vibrates faster than half of it is seen no more, but still gives under slow forces.
    """
    reshape = effect.reshape
    if reshape is None or not effect.adds_coordinates or reshape.expected is not None:
        return effect
    rate = 1.0 / min(float(np.median(np.diff(recording.time))) for recording in recordings)
    limited = (replace(p, upper=min(p.upper, rate)) if p.name == "frequency" else p for p in effect.parameters)
    return replace(effect, parameters=tuple(limited))


def _at_lines(effect: Effect, system: System, site: str, sizes: References, recording: Measured) -> Effect:
    """The effect begun at every steady line of its channel, if lines are what it needs."""
    if "line" not in effect.needs:
        return effect
    (channel,) = (c for c in recording.channels if c.name == site)
    lines = lines_of(system, channel, recording.time)
    begun = (
        replace(p, starts=tuple(line / p.scale(sizes) for line in lines)) if p.search == "line" else p
        for p in effect.parameters
    )
    return replace(effect, parameters=tuple(begun))


def _on_its_own(effect: Effect, system: System, site: str) -> Effect:
    """The effect in no need of another one to modify where the model itself states one: dry friction, a stop."""
    stated = {a.effect for a in system.attachments if a.site == site}
    if effect.site is SiteKind.JOINT and system.joint(site).friction > 0.0:
        stated.add("coulomb_friction")
    return replace(effect, modifies=(*effect.modifies, BY_MODEL)) if stated.intersection(effect.modifies) else effect


def _beside_loops(effect: Effect) -> bool:
    """Whether a closed mechanism can have the effect: none that adds coordinates, or feels what a joint carries."""
    return not effect.adds_coordinates and not (effect.law and UNKNOWN_BESIDE_LOOPS.intersection(effect.law.slots))


def _possible(candidate: Candidate, system: System) -> bool:
    """Whether the native dynamics can express the effect in this system."""
    if candidate.effect.name == "end_stop" and candidate.site in [stop.joint for stop in system.stops]:
        return False  # a joint has one place for stops
    reshape = candidate.effect.reshape
    if system.loops and not _beside_loops(candidate.effect):
        return False
    if system.gimbals and (candidate.effect.adds_coordinates or candidate.effect.site is SiteKind.BASE):
        return False  # what a base does goes along one axis, which a body that turns in space does not tell
    if reshape is None:
        return True
    values = [p.start_values(candidate.references)[0] for p in candidate.effect.parameters]
    try:
        changed = reshape.change(system, candidate.site, candidate.effect.named(values))
        if candidate.effect.adds_coordinates:
            lane_model(changed)
    except (InputError, NotImplementedError):
        return False
    return True
