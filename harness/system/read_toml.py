"""Systems from the project's own TOML files."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError
from harness.system.check import check_bodies, check_dynamics, check_loops, check_mimics
from harness.system.description import (
    STANDARD_GRAVITY,
    Array,
    Attachment,
    Joint,
    JointType,
    Link,
    Mimic,
    System,
    constant,
)
from harness.system.flexible_link import read_flexible_link
from harness.system.loop import Coupling, Loop
from harness.system.names import check_names
from harness.system.rotation import from_rpy
from harness.system.suggest import did_you_mean
from harness.system.table import TableReader, locate
from harness.system.tolerances import OF_BEAMS, OF_JOINTS, OF_LINKS, read_tolerances
from harness.system.toml_loops import read_coupling, read_gimbal, read_loop
from harness.system.topology import arrange

DEFAULT_TOLERANCE = 0.01
# Words of other formats for ours.
_SYNONYMS = {"floating": "free", "spherical": "ball", "screw": "helical", "hinge": "revolute", "slide": "prismatic"}


def parse_toml(text: str, source: Path | None = None) -> dict[str, Any]:
    """The raw tables of a TOML text. Raises InputError with line and column."""
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = str(error)
        line = _number_after(message, "at line ")
        if "at end of document" in message:
            line = len(text.splitlines())
        column = _number_after(message, "column ")
        what = message.partition(" (at ")[0]
        raise InputError(
            f"not valid TOML: {what}", mend="mend the syntax", source=source, line=line, column=column
        ) from None
    except RecursionError:
        raise InputError("not valid TOML: nested too deeply", mend="mend the syntax", source=source) from None
    except ValueError as error:  # of Python: a whole number of thousands of digits
        raise InputError(f"not valid TOML: {error}", mend="mend the number", source=source) from None
    _refuse_long_numbers(tables, text, source)
    return tables


def _refuse_long_numbers(tables: dict[str, Any], text: str, source: Path | None) -> None:
    """TOML's whole numbers have 64 bits; Python reads longer ones, and stumbles over them later."""
    waiting: list[tuple[str, Any]] = list(tables.items())
    while waiting:
        key, value = waiting.pop()
        if isinstance(value, dict):
            waiting += value.items()
        elif isinstance(value, list):
            waiting += [(key, item) for item in value]
        elif isinstance(value, int) and not -(2**63) <= value < 2**63:
            line = text[: text.find(str(value))].count("\n") + 1 if str(value) in text else None
            raise InputError(
                f"not valid TOML: {key!r} is a whole number beyond 64 bits",
                mend="check the number, or write it as 1e20",
                source=source,
                line=line,
            )


def _number_after(message: str, word: str) -> int | None:
    digits = message.partition(word)[2]
    digits = digits[: len(digits) - len(digits.lstrip("0123456789"))]
    return int(digits) if digits else None


def read_toml(
    text: str, source: Path | None = None, *, tolerance: float | None = None, physical: bool = True
) -> System:
    """A system from TOML text.

    tolerance: overrides the file's. physical: refuse impossible inertia (else it becomes a note).
    Raises InputError naming file, line, what and the mend.
    """
    raw = parse_toml(text, source)
    places = locate(text)
    _, keys = places[""][0]
    top = TableReader(raw, "model", source, None, keys)
    name = top.text("name", source.stem if source is not None else "system")
    base = top.text("base", "base")
    gravity = top.vector("gravity", STANDARD_GRAVITY)
    stated = top.number("tolerance", DEFAULT_TOLERANCE, non_negative=True)
    if stated >= 1.0:
        top.refuse(f"tolerance {stated:g} is not a relative 1σ below 1", "0.01 is one per cent", "tolerance")
    tolerance = stated if tolerance is None else tolerance
    joint_tables = _tables(top, "joint", places)
    link_tables = _tables(top, "link", places)
    effect_tables = _tables(top, "effect", places)
    loop_tables, coupling_tables = _tables(top, "loop", places), _tables(top, "coupling", places)
    gimbal_tables = _tables(top, "gimbal", places)
    top.finish()
    if not joint_tables:
        top.refuse("there is no [[joint]]", "a system has at least one joint on its base")

    notes: list[str] = []
    lines: dict[tuple[str, str], int] = {}
    joints = []
    tolerances: dict[str, float] = {}
    for table in joint_tables:
        own = read_tolerances(table, OF_JOINTS)
        joint = _joint(table)
        joints.append(joint)
        tolerances |= {f"{kind}@{joint.name}": value for kind, value in own.items()}
        _note_line(lines, "joint", joint.name, table.line)
    links = []
    for table in link_tables:
        own = read_tolerances(table, OF_BEAMS if table.has("length") else OF_LINKS)
        link = _link(table, tolerance, notes)
        links.append(link)
        tolerances |= {f"{kind}@{link.name}": value for kind, value in own.items()}
        _note_line(lines, "link", link.name, table.line)
    loops: list[Loop | Coupling] = [
        *(read_loop(table) for table in loop_tables),
        *(read_coupling(table) for table in coupling_tables),
    ]
    for loop, table in zip(loops, (*loop_tables, *coupling_tables), strict=True):
        _note_line(lines, "loop", loop.name, table.line)
    described = {link.name for link in links}
    for joint in joints:
        if joint.child not in described and joint.child != base:
            raise InputError(
                f"joint {joint.name!r}: child {joint.child!r} is not described",
                mend=did_you_mean(joint.child, described - {j.child for j in joints}) or "add a [[link]] of that name",
                source=source,
                line=lines.get(("joint", joint.name)),
            )
    ordered_joints, ordered_links = arrange(joints, links, base, source=source, lines=lines)
    ordered_links, told = check_bodies(ordered_links, physical=physical, source=source, lines=lines)
    notes += told
    system = System(
        name=name,
        joints=ordered_joints,
        links=ordered_links,
        base=base,
        gravity=gravity,
        tolerance=tolerance,
        tolerances=tolerances,
        attachments=tuple(_attachment(table) for table in effect_tables),
        source=source,
        notes=tuple(notes),
        loops=tuple(loops),
        gimbals=tuple(read_gimbal(table, joints) for table in gimbal_tables),
    )
    check_names(system, lines)
    check_mimics(system, lines)
    system = replace(system, notes=(*system.notes, *check_loops(system, lines)))
    check_dynamics(system, lines=lines)
    return system


def _note_line(lines: dict[tuple[str, str], int], kind: str, name: str, line: int | None) -> None:
    if line is not None:
        lines[(kind, name)] = line


def _tables(top: TableReader, kind: str, places: Mapping[str, list[tuple[int, dict[str, int]]]]) -> list[TableReader]:
    if not top.has(kind):
        return []
    value = top.table[kind]
    if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
        top.refuse(f"{kind!r} must be a list of tables", f"write [[{kind}]] with two brackets", kind)
    where = places.get(kind, [])
    readers = []
    for k, item in enumerate(value):
        line, keys = where[k] if len(where) == len(value) else (None, {})
        called = f"{kind} {item['name']!r}" if isinstance(item.get("name"), str) else f"{kind} number {k + 1}"
        readers.append(TableReader(item, called, top.source, line, keys))
    return readers


def _joint(table: TableReader) -> Joint:
    name = table.text("name")
    kind = table.text("type")
    if kind not in set(JointType):
        table.refuse(f"unknown joint type {kind!r}", _type_mend(kind), "type")
    joint_type = JointType(kind)
    xyz, rotation = constant(np.zeros(3)), constant(np.eye(3))
    origin = table.inner("origin")
    if origin is not None:
        xyz = origin.vector("xyz", (0.0, 0.0, 0.0))
        rotation = constant(from_rpy(origin.vector("rpy", (0.0, 0.0, 0.0))))
        origin.finish()
    bare = joint_type in (JointType.FIXED, JointType.BALL, JointType.FREE)
    if bare and not table.has("axis"):
        axis = constant([0.0, 0.0, 1.0])
    else:
        axis = table.direction("axis", mend="add axis = [0, 1, 0], in the joint frame")
    axis2, pitch, mimic = _further(table, joint_type, axis)
    limits = table.inner("limits")
    lower, upper, effort, velocity = -np.inf, np.inf, np.inf, np.inf
    if limits is not None:
        lower = limits.number("lower", lower, infinite=True)
        upper = limits.number("upper", upper, infinite=True)
        effort = limits.number("effort", effort, non_negative=True, infinite=True)
        velocity = limits.number("velocity", velocity, non_negative=True, infinite=True)
        if lower > upper:
            limits.refuse(f"lower {lower:g} is above upper {upper:g}", "swap them")
        limits.finish()
    joint = Joint(
        name=name,
        type=joint_type,
        parent=table.text("parent"),
        child=table.text("child"),
        xyz=xyz,
        rotation=rotation,
        axis=axis,
        armature=table.number("armature", 0.0, non_negative=True),
        damping=table.number("damping", 0.0, non_negative=True),
        friction=table.number("friction", 0.0, non_negative=True),
        stiffness=table.number("stiffness", 0.0),
        rest_position=table.number("rest_position", 0.0),
        lower=lower,
        upper=upper,
        effort=effort,
        velocity=velocity,
        axis2=axis2,
        pitch=pitch,
        mimic=mimic,
    )
    if joint.turns_in_space:
        for key in ("friction", "stiffness", "rest_position"):
            if getattr(joint, key):
                table.refuse(f"{key!r} of a {kind} joint is not modelled", "take it out", key)
    table.finish()
    return joint


def _type_mend(kind: str) -> str:
    if kind in _SYNONYMS:
        return f'did you mean "{_SYNONYMS[kind]}"?'
    return did_you_mean(kind, [str(t) for t in JointType])


def _further(table: TableReader, kind: JointType, axis: Array) -> tuple[Array, float, Mimic | None]:
    """Second axis of a universal joint, pitch of a helical one, and what a joint follows."""
    axis2, pitch, mimic = constant([0.0, 1.0, 0.0]), 0.0, None
    if kind is JointType.UNIVERSAL:
        axis2 = table.direction("axis2", mend="add axis2 = [0, 1, 0], in the joint frame")
        if float(np.linalg.norm(np.cross(axis, axis2))) < 1e-6:
            table.refuse("'axis' and 'axis2' are parallel", "the axes of a universal joint cross", "axis2")
    if kind is JointType.HELICAL:
        pitch = table.number("pitch", mend="add pitch = …, the shift for a turn of one radian [m/rad]")
    inner = table.inner("mimic")
    if inner is not None:
        mimic = Mimic(inner.text("joint"), inner.number("multiplier", 1.0), inner.number("offset", 0.0))
        inner.finish()
    return axis2, pitch, mimic


def _link(table: TableReader, tolerance: float, notes: list[str]) -> Link:
    name = table.text("name")
    if table.has("length"):
        for key in ("com", "inertia", "end"):
            if key in table.table:
                table.refuse(f"{key!r} follows from length, section and mass", "take it out of a flexible link", key)
        link = read_flexible_link(table, name, tolerance)
        table.finish()
        return link
    for key in ("direction", "bending", "section", "material", "modes"):
        if key in table.table:
            table.refuse(f"{key!r} belongs to a flexible link, but 'length' is missing", "add length = …", key)
    mass = table.number(
        "mass",
        non_negative=True,
        mend="a rigid link has mass, com and inertia; a flexible one has length; mass = 0.0 is massless",
    )
    if mass > 0.0:
        notes += [
            f"link {name!r}: no {key} given, taken as {meaning}"
            for key, meaning in (("com", "the link's origin"), ("inertia", "a point mass"))
            if not table.has(key)
        ]
    link = Link(
        name=name,
        mass=mass,
        com=table.vector("com", (0.0, 0.0, 0.0)),
        inertia=table.tensor("inertia") if table.has("inertia") else constant(np.zeros((3, 3))),
        end=table.vector("end", (0.0, 0.0, 0.0)) if table.has("end") else None,
    )
    table.finish()
    return link


def _attachment(table: TableReader) -> Attachment:
    def values(key: str) -> dict[str, float]:
        inner = table.inner(key)
        if inner is None:
            return {}
        return {name: inner.number(name) for name in inner.table}

    attachment = Attachment(
        effect=table.text("name"), site=table.text("site"), parameters=values("parameters"), std=values("std")
    )
    table.finish()
    return attachment
