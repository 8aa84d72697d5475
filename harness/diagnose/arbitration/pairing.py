"""Models of one rig brought to the same joints, whatever their files call the links and wherever they put what is
fixed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from harness.effects import apply
from harness.errors import InputError
from harness.system import System, load
from harness.system.lowering import freed, one_degree


def prepared(model: str | Path | System) -> System:
    """A model as a free run needs it: joints of one degree of freedom, and the effects that its file attaches put into
    it.

    Raises InputError for a file that cannot be read or an effect that does not fit.
    """
    system = model if isinstance(model, System) else load(model, physical=False)
    system = one_degree(freed(system), "a comparison of models")
    if not system.joint_names:
        raise InputError("has no joint that moves", source=system.source, mend="give a model with a movable joint")
    if system.actuators:
        told = "its actuators do not act here: efforts are what recordings state"
        system = replace(system, actuators=(), notes=(*system.notes, told))
    shaped = replace(system, attachments=())
    for attachment in system.attachments:
        shaped = apply(shaped, attachment)
    return shaped


def paired(first: System, second: System) -> System:
    """The second model, its moving links named as the first one's.

    Raises InputError where the joints that move are not the same in both.
    """
    wanted, found = first.joint_names, second.joint_names
    if set(wanted) != set(found):
        missing = sorted(set(wanted) - set(found)) or sorted(set(found) - set(wanted))
        which = second if set(wanted) - set(found) else first
        raise InputError(
            f"has no joint {missing[0]!r} that moves; the other model has",
            source=which.source or which.name,
            mend=f"name joints alike in both: {', '.join(wanted)} and {', '.join(found)}",
        )
    for name in wanted:
        one, other = first.joint(name), second.joint(name)
        if one.prismatic != other.prismatic:
            raise InputError(
                f"joint {name!r} is {other.type}, and {one.type} in the other model",
                source=second.source or second.name,
                mend="compare models whose joints move alike",
            )
        above = [_moving_above(model, name) for model in (first, second)]
        if above[0] != above[1]:
            raise InputError(
                f"joint {name!r} rides on {above[1] or 'the base'}, and on {above[0] or 'the base'} in the other model",
                source=second.source or second.name,
                mend="compare models of the same mechanism",
            )
    names = {second.joint(name).child: first.joint(name).child for name in wanted}
    taken = set(names.values())
    for link in second.links:
        if link.name not in names:
            own = link.name
            while own in taken:
                own += "_"
            names[link.name] = own
            taken.add(own)
    joints = tuple(
        replace(joint, child=names[joint.child], parent=names.get(joint.parent, joint.parent))
        for joint in second.joints
    )
    links = tuple(replace(link, name=names[link.name]) for link in second.links)
    attachments = tuple(replace(a, site=_renamed(a.site, names, second)) for a in second.attachments)
    return replace(second, joints=joints, links=links, attachments=attachments)


def _moving_above(system: System, joint: str) -> str:
    """The movable joint that a joint rides on; nothing for the base."""
    carriers = {j.child: j for j in system.joints}
    parent = system.joint(joint).parent
    while parent in carriers:
        if carriers[parent].movable:
            return carriers[parent].name
        parent = carriers[parent].parent
    return ""


def _renamed(site: str, names: dict[str, str], system: System) -> str:
    """A site where links have other names; joints keep theirs."""
    owner, dot, rest = site.partition(".")
    return site if owner in system.joint_names else f"{names.get(owner, owner)}{dot}{rest}"
