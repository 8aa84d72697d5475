"""A joint with the spring and the damper of a drive beside its own."""

from __future__ import annotations

from dataclasses import replace

from harness.system.description import Actuator, Joint


def sprung(joint: Joint, drive: Actuator, before: Actuator | None = None) -> Joint:
    """The joint with the drive's spring and damper beside its own; before: one that it has already, in whose place that comes."""
    stiffness, offset, damping = drive.stiffness, drive.offset, drive.damping
    if before is not None:
        stiffness, offset, damping = stiffness - before.stiffness, offset - before.offset, damping - before.damping
    total = joint.stiffness + stiffness
    rest = (joint.stiffness * joint.rest_position + offset) / total if total else joint.rest_position
    return replace(joint, stiffness=total, rest_position=rest, damping=joint.damping + damping)
