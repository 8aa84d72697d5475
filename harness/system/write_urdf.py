"""Systems to URDF."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from lxml import etree

from harness.errors import UnsupportedError
from harness.system.description import STANDARD_GRAVITY, Joint, JointType, Link, System
from harness.system.gimbals import without_gimbals
from harness.system.lowering import chained
from harness.system.read_urdf import NO_LIMIT
from harness.system.rotation import to_rpy


def to_urdf(system: System) -> tuple[str, tuple[str, ...]]:
    """URDF text of a system, and what URDF cannot say (armature, springs, bending, gravity, effects), one line each."""
    if system.loops:
        raise UnsupportedError(
            f"{system.loops[0].name!r} closes a loop, which URDF cannot say",
            mend="write TOML or MJCF",
            source=system.source,
        )
    system, left_out = without_gimbals(system, "URDF")
    if not np.allclose(system.gravity, STANDARD_GRAVITY, rtol=0.0, atol=1e-12):
        left_out.append(f"gravity {np.asarray(system.gravity).tolist()} m/s²: URDF leaves it to the simulator")
    if system.tolerance != 0.01:
        left_out.append(f"tolerance {system.tolerance:g}")
    left_out += [f"tolerance {value:g} of {key}" for key, value in system.tolerances.items()]
    left_out += [f"effect {a.effect!r} at {a.site!r}" for a in system.attachments]
    # A universal or helical joint, which URDF has not, as the joints that it is made of.
    system = chained(system, keep=(JointType.FREE, JointType.BALL, JointType.PLANAR))
    root = etree.Element("robot", name=system.name)
    etree.SubElement(root, "link", name=system.base)
    for joint, link in zip(system.joints, system.links, strict=True):
        left_out += _joint(root, joint)
        if link.beam is not None:
            left_out.append(f"link {link.name!r}: bending; it is written rigid, in its undeformed shape")
        if link.gravcomp:
            left_out.append(f"link {link.name!r}: gravity compensation {link.gravcomp:g}")
        _link(root, link)
    text = etree.tostring(root, pretty_print=True, xml_declaration=True, encoding="UTF-8").decode("utf-8")
    return text, tuple(left_out)


def _words(values: Iterable[float]) -> str:
    # repr of a float is the shortest text that reads back as the same number.
    return " ".join(repr(float(x)) for x in values)


def _link(root: etree._Element, link: Link) -> None:
    element = etree.SubElement(root, "link", name=link.name)
    if link.mass == 0.0 and not np.any(link.inertia):
        return
    inertial = etree.SubElement(element, "inertial")
    etree.SubElement(inertial, "origin", xyz=_words(link.com), rpy="0 0 0")
    etree.SubElement(inertial, "mass", value=repr(float(link.mass)))
    tensor = np.asarray(link.inertia)
    entries = {
        f"i{a}{b}": repr(float(tensor["xyz".index(a), "xyz".index(b)])) for a, b in ("xx", "xy", "xz", "yy", "yz", "zz")
    }
    etree.SubElement(inertial, "inertia", entries)


# Our words to URDF's, where they differ; None for what URDF has no joint for.
_TYPES = {JointType.FREE: "floating", JointType.BALL: None}


def _joint(root: etree._Element, joint: Joint) -> list[str]:
    kind = _TYPES.get(joint.type, str(joint.type))
    if kind is None:
        raise UnsupportedError(
            f"joint {joint.name!r} is of type {joint.type}, which URDF has not", mend="write TOML or MJCF"
        )
    element = etree.SubElement(root, "joint", name=joint.name, type=kind)
    etree.SubElement(element, "parent", link=joint.parent)
    etree.SubElement(element, "child", link=joint.child)
    etree.SubElement(element, "origin", xyz=_words(joint.xyz), rpy=_words(to_rpy(joint.rotation)))
    if joint.type is JointType.FIXED:
        return []
    if joint.type is not JointType.FREE:
        etree.SubElement(element, "axis", xyz=_words(joint.axis))
    if joint.damping or joint.friction:
        etree.SubElement(element, "dynamics", damping=repr(float(joint.damping)), friction=repr(float(joint.friction)))
    limits = {"effort": joint.effort, "velocity": joint.velocity}
    if joint.mimic is not None:
        numbers = {"multiplier": repr(float(joint.mimic.multiplier)), "offset": repr(float(joint.mimic.offset))}
        etree.SubElement(element, "mimic", {"joint": joint.mimic.joint} | numbers)
    if joint.type in (JointType.REVOLUTE, JointType.PRISMATIC):
        # Readers insist on limits for these two types; numbers beyond any machine stand for none.
        limits |= {"lower": joint.lower, "upper": joint.upper}
    elif math.isinf(joint.effort) and math.isinf(joint.velocity):
        limits = {}
    if limits:
        clipped = {key: repr(float(np.clip(value, -NO_LIMIT, NO_LIMIT))) for key, value in limits.items()}
        etree.SubElement(element, "limit", clipped)
    left_out = []
    if joint.armature:
        left_out.append(f"joint {joint.name!r}: armature {joint.armature:g}")
    if joint.stiffness:
        left_out.append(f"joint {joint.name!r}: spring of stiffness {joint.stiffness:g}")
    return left_out
