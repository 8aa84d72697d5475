"""Screws and joints that follow others as joints of one degree of freedom each and couplings between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from harness.system.description import Joint, JointType, Link, System
from harness.system.loop import Coupling
from harness.system.lowering import followed


def screws_apart(system: System) -> System:
    """The system with every helical joint as a turn of its name and a slide ``<name>.slide`` that follows it by the pitch [m/rad].

    What acts at the screw acts at its turn.
    """
    if not any(joint.type is JointType.HELICAL for joint in system.joints):
        return system
    joints: list[Joint] = []
    links: list[Link] = []
    couplings: list[Coupling] = []
    for joint, link in zip(system.joints, system.links, strict=True):
        if joint.type is not JointType.HELICAL:
            joints.append(joint)
            links.append(link)
            continue
        name = f"{joint.name}.slide"
        sleeve = f"{joint.child}__{name}"
        joints += [
            replace(joint, type=JointType.REVOLUTE, child=sleeve, pitch=0.0),
            Joint(name, JointType.PRISMATIC, sleeve, joint.child, axis=joint.axis),
        ]
        links += [Link(sleeve), link]
        couplings.append(Coupling(name, name, joint.name, (0.0, joint.pitch, 0.0, 0.0, 0.0)))
    return _coupled(replace(system, joints=tuple(joints), links=tuple(links)), couplings)


def mimics_apart(system: System) -> System:
    """The system with every joint that mimics another as one with a coordinate of its own and a coupling of its name."""
    couplings = []
    for joint in system.joints:
        if joint.mimic is not None:
            leader, multiplier, offset = followed(system, joint)
            couplings.append(Coupling(joint.name, joint.name, leader, (offset, multiplier, 0.0, 0.0, 0.0)))
    joints = tuple(replace(joint, mimic=None) for joint in system.joints)
    return _coupled(replace(system, joints=joints), couplings) if couplings else system


def _coupled(system: System, couplings: Sequence[Coupling]) -> System:
    """The system with further couplings; what follows none of all leads, if nothing else is to."""
    loops = (*system.loops, *couplings)
    follow = {loop.joint for loop in loops if isinstance(loop, Coupling)}
    leading = system.leading or tuple(name for name in system.coordinate_names if name not in follow)
    return replace(system, loops=loops, leading=leading)
