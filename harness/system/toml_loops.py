"""``[[loop]]``, ``[[coupling]]`` and ``[[gimbal]]`` tables of the project's TOML, in and out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from harness.system.description import Gimbal, Joint, JointType, constant
from harness.system.loop import MOTIONS, Coupling, Frame, Loop
from harness.system.rotation import from_rpy, to_rpy
from harness.system.suggest import did_you_mean
from harness.system.table import TableReader

_MEND = 'closed = ["x", "y", "z"] is a ball joint; with "rx", "ry" it is a revolute joint about z'


def read_loop(table: TableReader) -> Loop:
    """A cut joint: two frames, and which of their relative motions are closed."""
    name = table.text("name")
    first, second = _frame(table, "first"), _frame(table, "second")
    if not table.has("closed"):
        table.refuse("'closed' is missing", _MEND)
    closed = table.table["closed"]
    if not isinstance(closed, list) or not closed or not all(isinstance(motion, str) for motion in closed):
        table.refuse(f"'closed' must be a list of motions, not {closed!r}", _MEND, "closed")
    for motion in closed:
        if motion not in MOTIONS:
            mend = did_you_mean(motion, MOTIONS) or f"motions are {', '.join(MOTIONS)}"
            table.refuse(f"unknown motion {motion!r} in 'closed'", mend, "closed")
    if len(set(closed)) < len(closed):
        table.refuse("'closed' names a motion twice", "name each once", "closed")
    table.finish()
    return Loop(name, first, second, tuple(motion for motion in MOTIONS if motion in closed))


def _frame(table: TableReader, key: str) -> Frame:
    inner = table.inner(key)
    if inner is None:
        table.refuse(f"{key!r} is missing", f'add {key} = {{ link = "…", xyz = [x, y, z] }}')
    frame = Frame(
        inner.text("link"),
        inner.vector("xyz", (0.0, 0.0, 0.0)),
        constant(from_rpy(inner.vector("rpy", (0.0, 0.0, 0.0)))),
    )
    inner.finish()
    return frame


def read_coupling(table: TableReader) -> Coupling:
    """A joint whose position is a polynomial of another's."""
    name, joint = table.text("name"), table.text("joint")
    leader = table.text("leader") if table.has("leader") else None
    coefficients = table.numbers("polynomial")
    most = 1 if leader is None else 5
    if not 1 <= len(coefficients) <= most:
        mend = (
            "ascending: [0.0, 2.0] is twice the leader's position; at most five" if leader else "one: where it is held"
        )
        table.refuse(f"'polynomial' has {len(coefficients)} coefficients", mend, "polynomial")
    c0, c1, c2, c3, c4 = (*coefficients, 0.0, 0.0, 0.0, 0.0, 0.0)[:5]
    table.finish()
    return Coupling(name, joint, leader, (c0, c1, c2, c3, c4))


def read_gimbal(table: TableReader, joints: Sequence[Joint]) -> Gimbal:
    """Three joints that are one in space together, as a diagnosis writes balls and floating bodies."""
    name, joint, child = table.text("name"), table.text("joint"), table.text("child")
    coordinates = table.table["coordinates"] if table.has("coordinates") else None
    slides = table.flag("slides", False)
    damping = table.number("damping", 0.0, non_negative=True)
    friction = table.number("friction", 0.0, non_negative=True)
    mend = 'coordinates = ["ball.rx", "ball.ry", "ball.rz"], of turns about x, y and z or of slides along them'
    if not isinstance(coordinates, list) or len(coordinates) != 3 or not all(isinstance(c, str) for c in coordinates):
        table.refuse("'coordinates' must name three joints", mend, "coordinates")
    own = [next((j for j in joints if j.name == c), None) for c in coordinates]
    kind = JointType.PRISMATIC if slides else JointType.REVOLUTE
    for k, part in enumerate(own):
        if part is None or part.type is not kind or not np.array_equal(part.axis, np.eye(3)[k]):
            table.refuse(f"{coordinates[k]!r} is no {kind} joint about or along {'xyz'[k]}", mend, "coordinates")
        before = own[k - 1]
        if k and before is not None and part is not None and part.parent != before.child:
            table.refuse(f"{part.name!r} does not follow {before.name!r}", mend, "coordinates")
    if name in [j.name for j in joints]:
        table.refuse(f"gimbal {name!r} has the name of a joint", "give it one of its own", "name")
    table.finish()
    first, second, third = coordinates
    return Gimbal(name, joint, child, (first, second, third), slides, damping, friction)


def write_gimbals(gimbals: Sequence[Gimbal]) -> dict[str, Any]:
    """The tables ``gimbal`` of a document, if there are any."""
    tables = [
        {
            "name": g.name,
            "joint": g.joint,
            "child": g.child,
            "coordinates": list(g.coordinates),
            "slides": g.slides,
            "damping": float(g.damping),
            "friction": float(g.friction),
        }
        for g in gimbals
    ]
    return {"gimbal": tables} if tables else {}


def write_loops(loops: tuple[Loop | Coupling, ...]) -> dict[str, Any]:
    """The tables ``loop`` and ``coupling`` of a document, each if there are any."""
    cut = [_loop(loop) for loop in loops if isinstance(loop, Loop)]
    coupled = [_coupled(loop) for loop in loops if isinstance(loop, Coupling)]
    return ({"loop": cut} if cut else {}) | ({"coupling": coupled} if coupled else {})


def _loop(loop: Loop) -> dict[str, Any]:
    return {
        "name": loop.name,
        "first": _placed(loop.first),
        "second": _placed(loop.second),
        "closed": list(loop.conditions),
    }


def _placed(frame: Frame) -> dict[str, Any]:
    table: dict[str, Any] = {"link": frame.link, "xyz": [float(x) for x in frame.xyz]}
    if np.any(np.asarray(frame.rotation) != np.eye(3)):
        table["rpy"] = [float(x) for x in to_rpy(frame.rotation)]
    return table


def _coupled(coupling: Coupling) -> dict[str, Any]:
    leader = {} if coupling.leader is None else {"leader": coupling.leader}
    count = 1 if coupling.leader is None else 5
    return (
        {"name": coupling.name, "joint": coupling.joint} | leader | {"polynomial": list(coupling.coefficients[:count])}
    )
