"""Systems to MJCF."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from lxml import etree

from harness.errors import UnsupportedError
from harness.system.description import Array, Joint, JointType, Link, System
from harness.system.gimbals import without_gimbals
from harness.system.lowering import chained
from harness.system.mjcf_names import body_names
from harness.system.rotation import quaternion
from harness.system.soft_constraints import friction_solver, limit_solver, limits, soft_friction, soft_stops

# MuJoCo takes no principal moment below 1e-15 kg·m²; a slender line has one of zero.
_SMALLEST_MOMENT = 1e-14
# The rest of ``solimp``, without meaning where the impedance is the same at any depth: MuJoCo's defaults.
SHAPE = (1e-3, 0.5, 2.0)


def to_mjcf(system: System) -> tuple[str, tuple[str, ...]]:
    """MJCF text of a system, and what MJCF cannot say (bending, most effects), one line each.

    Soft dry friction and stops that have an inertia are said as MuJoCo's constraints. Massless links between joints become several
    joints of one body, which is MuJoCo's way to say it.
    Mimics are linear equalities, which MuJoCo holds softly. A free joint's positions are in the world: it hangs on the base.
    Raises UnsupportedError where a massless link branches, or a link floats from another, which MuJoCo cannot hold.
    """
    system, left_out = without_gimbals(system, "MJCF", balls=True)
    system = chained(system, keep=(JointType.FREE, JointType.BALL))
    if system.tolerance != 0.01:
        left_out.append(f"tolerance {system.tolerance:g}")
    left_out += [f"tolerance {value:g} of {key}" for key, value in system.tolerances.items()]
    root = etree.Element("mujoco", model=system.name)
    etree.SubElement(root, "compiler", angle="radian", autolimits="true", inertiafromgeom="false")
    option = etree.SubElement(root, "option", gravity=_words(system.gravity), integrator="RK4", timestep="0.001")
    etree.SubElement(option, "flag", contact="disable", limit="disable")
    world = etree.SubElement(root, "worldbody")

    children: dict[str, list[int]] = {}
    for k, joint in enumerate(system.joints):
        children.setdefault(joint.parent, []).append(k)
    bodies = body_names(system)
    pending = [(k, world) for k in reversed(children.get(system.base, []))]
    while pending:
        k, parent = pending.pop()
        run = _run(system, k, children)
        link = system.links[run[-1]]
        body = _body(parent, [system.joints[i] for i in run], link, system, bodies[link.name])
        if bodies[link.name] != link.name:
            left_out.append(f"link {link.name!r} is body {bodies[link.name]!r}: the world of MJCF has that name")
        left_out += _inertial(body, link)
        if link.gravcomp:
            body.set("gravcomp", repr(float(link.gravcomp)))
        if link.beam is not None:
            left_out.append(f"link {link.name!r}: bending; it is written rigid, in its undeformed shape")
        left_out += [
            f"joint {system.joints[i].name!r}: velocity limit {system.joints[i].velocity:g}"
            for i in run
            if math.isfinite(system.joints[i].velocity)
        ]
        left_out += [
            f"joint {system.joints[i].name!r}: its limit to one side only"
            for i in run
            if math.isfinite(system.joints[i].lower) != math.isfinite(system.joints[i].upper)
        ]
        pending += [(child, body) for child in reversed(children.get(link.name, []))]
    _follow(root, system)
    if system.loops:
        from harness.system.write_mjcf_loops import close_loops  # slow to import, and most systems are trees

        close_loops(root, world, system)
    said = _constrain(root, option, system)
    left_out += [f"effect {a.effect!r} at {a.site!r}" for a in system.attachments if (a.effect, a.site) not in said]
    return etree.tostring(root, pretty_print=True, encoding="unicode"), tuple(left_out)


def _follow(root: etree._Element, system: System) -> None:
    """Say what follows another joint as equalities."""
    following = [joint for joint in system.joints if joint.mimic is not None]
    if not following:
        return
    equality = etree.SubElement(root, "equality")
    for joint in following:
        assert joint.mimic is not None
        terms = _words((joint.mimic.offset, joint.mimic.multiplier, 0.0, 0.0, 0.0))
        etree.SubElement(equality, "joint", joint1=joint.name, joint2=joint.mimic.joint, polycoef=terms)


def _constrain(root: etree._Element, option: etree._Element, system: System) -> set[tuple[str, str]]:
    """Say soft dry friction and stops with an inertia as solver parameters; returns the effects and sites that are said so."""
    friction, stops = soft_friction(system), soft_stops(system)
    if not (friction or stops):
        return set()
    import mujoco

    try:
        model = mujoco.MjModel.from_xml_string(etree.tostring(root, encoding="unicode"))
    except ValueError:  # what MuJoCo does not take it does not bound either
        return set()
    said = set()
    for element in root.iter("joint"):
        name = element.get("name")
        invweight = float(model.dof_invweight0[int(model.joint(name).dofadr[0])])
        if name in friction:
            reference, impedance = friction_solver(friction[name], invweight)
            element.set("solreffriction", _words(reference))
            element.set("solimpfriction", _words((impedance, impedance, *SHAPE)))
            said.add(("friction_softness", name))
        if name in stops:
            reference, impedance = limit_solver(stops[name], invweight)
            element.set("range", _words(limits(stops[name])))
            element.set("solreflimit", _words(reference))
            element.set("solimplimit", _words((impedance, impedance, *SHAPE)))
            said |= {("end_stop", name), ("stop_inertia", name)}
        elif stops and element.get("range"):
            # Ranges of the other joints stay what they were, a statement that nothing enforces.
            element.set("limited", "false")
    if stops:
        option.find("flag").attrib.pop("limit")
    return said


def _words(values: Iterable[float]) -> str:
    return " ".join(repr(float(x)) for x in values)


def _massless(link: Link) -> bool:
    return link.mass == 0.0 and not np.any(link.inertia)


def _run(system: System, k: int, children: dict[str, list[int]]) -> list[int]:
    """Joints from k on that share one body: those whose link between is massless and carries just one movable joint."""
    run = [k]
    while True:
        joint, link = system.joints[run[-1]], system.links[run[-1]]
        following = children.get(link.name, [])
        if not joint.movable or not _massless(link) or joint.turns_in_space:
            return run
        if not following:
            raise UnsupportedError(
                f"link {link.name!r} is massless and carries nothing, which MJCF cannot hold",
                mend="give it a mass and inertia, or write TOML",
                source=system.source,
            )
        movable = [c for c in following if system.joints[c].movable]
        if len(following) == 1 and movable:
            run.append(following[0])
        elif movable and not any(not system.joints[c].movable for c in following):
            raise UnsupportedError(
                f"link {link.name!r} is massless and branches, which MJCF cannot hold",
                mend="give it a mass and inertia, or write TOML",
                source=system.source,
            )
        else:
            return run


def _in_space(body: etree._Element, joint: Joint, system: System) -> None:
    """A free or ball joint, at the origin of its body."""
    attributes = {"name": joint.name, "type": str(joint.type)}
    attributes |= {key: repr(float(getattr(joint, key))) for key in ("armature", "damping") if getattr(joint, key)}
    if joint.type is JointType.FREE:
        moved = np.any(np.asarray(joint.xyz)) or np.any(np.asarray(joint.rotation) != np.eye(3))
        if joint.parent != system.base or moved:
            raise UnsupportedError(
                f"joint {joint.name!r} is free of {joint.parent!r}, or not at its origin, which MJCF cannot hold",
                mend="let it be free of the base, at the base's origin, or write TOML",
                source=system.source,
            )
    etree.SubElement(body, "joint", attributes)


def _body(parent: etree._Element, joints: list[Joint], link: Link, system: System, name: str) -> etree._Element:
    """A body with a run of joints: its frame at zero position is the last joint's."""
    # Placement of each joint frame in the parent's frame, at zero position.
    places: list[tuple[Array, Array]] = []
    position, rotation = np.zeros(3), np.eye(3)
    for joint in joints:
        position = position + rotation @ np.asarray(joint.xyz)
        rotation = rotation @ np.asarray(joint.rotation)
        places.append((position, rotation))
    body = etree.SubElement(parent, "body", name=name, pos=_words(position), quat=_words(quaternion(rotation)))
    for joint, (place, turn) in zip(joints, places, strict=True):
        if not joint.movable:
            continue
        last = joint is joints[-1]
        if joint.turns_in_space:
            _in_space(body, joint, system)
            continue
        attributes = {
            "name": joint.name,
            "type": "slide" if joint.prismatic else "hinge",
            "pos": "0 0 0" if last else _words(rotation.T @ (place - position)),
            "axis": _words(joint.axis if last else rotation.T @ turn @ np.asarray(joint.axis)),
        }
        for key, value in (
            ("armature", joint.armature),
            ("damping", joint.damping),
            ("frictionloss", joint.friction),
            ("stiffness", joint.stiffness),
            ("springref", joint.rest_position),
        ):
            if value:
                attributes[key] = repr(float(value))
        if math.isfinite(joint.lower) and math.isfinite(joint.upper) and joint.lower < joint.upper:
            attributes["range"] = _words((joint.lower, joint.upper))
        if math.isfinite(joint.effort) and joint.effort > 0.0:
            attributes["actuatorfrcrange"] = _words((-joint.effort, joint.effort))
        etree.SubElement(body, "joint", attributes)
    return body


def _inertial(body: etree._Element, link: Link) -> list[str]:
    """Inertia of a body; tells where a moment had to be raised for MuJoCo to take it."""
    if _massless(link):
        return []
    tensor = np.asarray(link.inertia)
    moments, axes = np.linalg.eigh(tensor)
    raised = moments[0] < _SMALLEST_MOMENT
    if raised:
        floor = np.maximum(moments, _SMALLEST_MOMENT)
        tensor = axes @ np.diag(floor) @ axes.T
    entries = (tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2])
    etree.SubElement(body, "inertial", pos=_words(link.com), mass=repr(float(link.mass)), fullinertia=_words(entries))
    if not raised:
        return []
    return [f"link {link.name!r}: principal moment {moments[0]:.3g} kg·m² raised to {_SMALLEST_MOMENT:g} for MuJoCo"]
