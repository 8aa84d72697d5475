"""What a model file attaches, checked before anything acts: that it would act, and is not passed over for another."""

from __future__ import annotations

from collections import Counter

from harness.effects import effect
from harness.effects.attach import JOINT_FIELDS, check_site
from harness.effects.effect import SiteKind
from harness.effects.room import with_room
from harness.errors import InputError
from harness.recording.recording import JOINT_QUANTITIES, LINK_QUANTITIES, SPATIAL_UNITS
from harness.system import System
from harness.system.suggest import did_you_mean


def check_attached(system: System) -> None:
    """Refuse an effect at what is none, with parameters that it has not or cannot have, and two laws of one name at one site.

    Damping, dry friction and springs add up, and so does what changes the mechanism; of other laws the later would stand for both.
    Raises InputError for these, and for an effect that does not exist.
    """
    channels = channels_of(system)
    for attachment in system.attachments:
        try:
            kind = effect(attachment.effect)
            check_site(kind, system, attachment.site)
            with_room(kind, system, attachment.site).values(attachment.parameters)
        except InputError as fault:
            raise type(fault)(fault.what, mend=fault.mend, source=system.source) from None
        known: tuple[str, ...] | None = None
        if kind.site is SiteKind.CHANNEL and not (kind.sensor is not None and kind.sensor.every_channel):
            known = channels
        elif kind.input is not None:
            known = system.joint_names
        if known is not None and attachment.site not in known:
            raise InputError(
                f"effect {kind.name!r} sits at a {kind.site}, and there is no {kind.site} {attachment.site!r}",
                mend=did_you_mean(attachment.site, known),
                source=system.source,
            )
    laws = Counter((a.effect, a.site) for a in system.attachments if _stands_alone(a.effect))
    for (name, site), count in laws.items():
        if count > 1:
            raise InputError(
                f"effect {name!r} is attached to {site!r} {count} times, and one can act there",
                mend="leave one, or say both by one law",
                source=system.source,
            )


def channels_of(system: System) -> tuple[str, ...]:
    """Names of all that could be recorded of a system."""
    in_space = [joint for joint in system.joints if joint.turns_in_space]
    return (
        *(f"{joint}.{quantity}" for joint in system.joint_names for quantity in JOINT_QUANTITIES),
        *(f"{link.name}.{quantity}" for link in system.links for quantity in LINK_QUANTITIES),
        *(f"{name}.{q}" for joint in in_space for name in (joint.name, joint.child) for q in SPATIAL_UNITS),
    )


def _stands_alone(name: str) -> bool:
    kind = effect(name)
    return (kind.law is not None or kind.user is not None) and name not in JOINT_FIELDS
