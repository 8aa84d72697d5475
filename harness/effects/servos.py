"""The servos of a joint made stronger or weaker, in what they feed back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from harness.errors import InputError
from harness.system import Actuator, System
from harness.system.actuated import sprung


def stiffer(system: System, site: str, parameters: Mapping[str, float]) -> System:
    """The system with the loops that the joint's servos are commanded by ``gain`` times as strong: of position, else of velocity.

    The damping beside a position loop stays: most of it is the motor's own, which no gain of the loop changes.
    """
    return _changed(system, site, parameters["gain"], lambda servo: not servo.stiffness)


def stronger(system: System, site: str, parameters: Mapping[str, float]) -> System:
    """The system with all that the joint's servos feed back ``gain`` times as strong."""
    return _changed(system, site, parameters["gain"], lambda _: True)


def _changed(system: System, site: str, factor: float, damping: Callable[[Actuator], bool]) -> System:
    """The system with the feedback of the joint's servos so many times as strong; their ranges of force stay.

    damping: whether that of a servo is part of it.
    """
    acting = system.servos_of(site)
    if not acting:
        raise InputError(f"no servo acts at joint {site!r}", mend="a servo is an actuator with feedback of its own")
    changed = {
        servo.name: replace(
            servo,
            offset=factor * servo.offset,
            stiffness=factor * servo.stiffness,
            damping=factor * servo.damping if damping(servo) else servo.damping,
        )
        for servo in acting
    }
    joint = system.joint(site)
    for servo in system.servos:
        if servo.name in changed:
            joint = sprung(joint, changed[servo.name], before=servo)
    return replace(
        system.replace_joint(joint),
        drives=tuple(changed.get(d.name, d) for d in system.drives),
        servos=tuple(changed.get(s.name, s) for s in system.servos),
    )
