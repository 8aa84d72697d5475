"""The drive side of a joint made a body of its own, coupled to the link by a spring or by teeth with play."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from harness.effects.scale import references
from harness.errors import InputError
from harness.system import Attachment, Joint, Link, System
from harness.system.description import constant

MASSLESS_SHARE = 0.01  # of the carried inertia, for a drive side whose own inertia the model does not state
TEETH_RATE = 2.0 * np.pi * 60.0  # rad/s: carried inertia on teeth in contact; stiff beside any swing
TEETH_DAMPING_RATIO = 0.3


def with_drive_side(system: System, site: str, parameters: Mapping[str, float]) -> System:
    """The joint ``site`` carries a drive side ``<site>_drive``, and joint ``<site>_coupling`` the link on it.

    Armature, damping, friction and effort stay with the drive side, which is also what is measured as ``<site>``. If
    the model states no armature, the drive side is given one per cent of the carried inertia.
    parameters: ``stiffness`` and ``damping`` of a coupling, or ``gap`` of a play. Where the joint has a drive side already,
    both act one after the other: the spring takes over where the play ends.
    Raises InputError if the joint cannot move.
    """
    joint = system.joint(site)
    if not joint.movable:
        raise InputError(f"joint {site!r} is fixed", mend="a coupling needs a joint that moves")
    inertia = references(system, site).inertia
    drive, coupling_name = f"{site}_drive", f"{site}_coupling"
    if any(other.name == coupling_name for other in system.joints):
        return _one_after_the_other(system, coupling_name, parameters)
    armature = joint.armature if joint.armature > 0.0 else MASSLESS_SHARE * inertia
    play = "gap" in parameters
    stiffness = inertia * TEETH_RATE**2 if play else parameters["stiffness"]
    damping = 2.0 * TEETH_DAMPING_RATIO * inertia * TEETH_RATE if play else parameters["damping"]
    hub = replace(joint, child=drive, armature=armature)
    coupling = Joint(
        coupling_name,
        joint.type,
        drive,
        joint.child,
        axis=constant(joint.axis),
        # Teeth push only when in contact, so with play both belong to the law of the play, not to the joint.
        stiffness=0.0 if play else stiffness,
        damping=0.0 if play else damping,
    )
    index = [j.name for j in system.joints].index(site)
    joints = (*system.joints[:index], hub, coupling, *system.joints[index + 1 :])
    links = (*system.links[:index], Link(drive), *system.links[index:])
    attachments = system.attachments
    if play:
        teeth = {"gap": parameters["gap"], "stiffness": stiffness, "damping": damping}
        attachments = (*attachments, Attachment("backlash", coupling_name, teeth))
    return replace(system, joints=joints, links=links, attachments=attachments)


def _one_after_the_other(system: System, coupling: str, parameters: Mapping[str, float]) -> System:
    """The system with play before the spring of a coupling, or a spring behind the play of one: teeth as soft as the spring."""
    joint = system.joint(coupling)
    if "gap" in parameters:
        teeth = {"gap": parameters["gap"], "stiffness": joint.stiffness, "damping": joint.damping}
        return replace(
            system.replace_joint(replace(joint, stiffness=0.0, damping=0.0)),
            attachments=(*system.attachments, Attachment("backlash", coupling, teeth)),
        )
    soft = {name: parameters[name] for name in ("stiffness", "damping")}
    attachments = tuple(
        replace(own, parameters={**own.parameters, **soft}) if (own.effect, own.site) == ("backlash", coupling) else own
        for own in system.attachments
    )
    return replace(system, attachments=attachments)
