"""A system compiled once into flat arrays: one row a body, one body a movable joint or a flexible link."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.denoc.recursion.rows import (
    ACCELERATION,
    ARMATURE,
    COLUMNS,
    DAMPING,
    FIRST,
    FIXED,
    INERTIA,
    KIND,
    MASS,
    MODES,
    MOMENT,
    OFFSET,
    PARENT,
    PLACE,
    PRISMATIC,
    REST,
    REVOLUTE,
    RUN,
    RUN_LENGTH,
    SLOT,
    STATION,
    STIFFNESS,
    TURN,
    WIDTH,
)
from harness.errors import InputError
from harness.system import Joint, JointType, Link, System
from harness.system.inertia import about_origin
from harness.system.lowering import refuse_loops
from harness.system.rotation import along_z

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

_UPPER = np.triu_indices(3)


@dataclass(frozen=True, eq=False)
class Seat:
    """Where a link's frame stands: body row (0 is the base), rotation link axes to body axes, origin in body axes."""

    body: int
    rotation: Array
    origin: Array


@dataclass(frozen=True, eq=False)
class Tree:
    """A mechanism as the kernels see it; rigid links on fixed joints are merged into the body that carries them.

    n: coordinates; bodies: rows besides the base's.
    rows: constants of every body and room for its workspace, (bodies + 1, WIDTH); columns in ``rows``.
    topology: (bodies + 1, COLUMNS) integers.
    seats: by link name.
    joints: the joint that carries each body, (bodies,).
    beams: name of the flexible link by body row.
    """

    system: System
    n: int
    bodies: int
    rows: Array
    topology: Integers
    seats: dict[str, Seat]
    joints: tuple[Joint, ...]
    beams: dict[int, str] = field(default_factory=dict)


def compile_tree(system: System) -> Tree:
    """Flat arrays of a system.

    Every joint has one independent degree of freedom, or none: others are lowered before (``harness.system.lowering``).
    Raises InputError naming joint or link if a number is not finite or an axis has no direction, UnsupportedError for loops, which
    are closed over the tree (``harness.denoc.loops``).
    """
    refuse_loops(system, "what knows trees alone")
    count = sum(joint.movable or link.flexible for joint, link in zip(system.joints, system.links, strict=True))
    # A rigid link welded onto a beam keeps a row of its own, without coordinate.
    room = count + sum(not joint.movable for joint in system.joints)
    rows = np.zeros((room + 1, WIDTH))
    topology = np.zeros((room + 1, COLUMNS), dtype=np.int64)
    topology[:, STATION] = -1
    rows[0, TURN : TURN + 9] = np.eye(3).ravel()
    rows[0, ACCELERATION + 3 : ACCELERATION + 6] = -np.asarray(system.gravity)
    seats = {system.base: Seat(0, np.eye(3), np.zeros(3))}
    carriers: list[Joint] = []
    beams: dict[int, str] = {}
    body = 0
    coordinate = 0
    for joint, link in zip(system.joints, system.links, strict=True):
        _check(joint, link)
        seat = seats[joint.parent]
        rotation = seat.rotation @ joint.rotation
        origin = seat.origin + seat.rotation @ joint.xyz
        # Nothing moves against the parent: the link becomes part of the parent's body.
        if joint.type is JointType.FIXED and not link.flexible and seat.body not in beams:
            seats[link.name] = Seat(seat.body, rotation, origin)
            if seat.body > 0:
                _add_inertia(rows[seat.body], link, rotation, origin)
            continue
        body += 1
        carriers.append(joint)
        axes = np.eye(3) if joint.type is JointType.FIXED else along_z(np.asarray(joint.axis))
        seats[link.name] = Seat(body, axes.T, np.zeros(3))
        row = rows[body]
        row[PLACE : PLACE + 9] = (rotation @ axes).ravel()
        row[OFFSET : OFFSET + 3] = origin
        row[ARMATURE], row[DAMPING] = joint.armature, joint.damping
        row[STIFFNESS], row[REST] = joint.stiffness, joint.rest_position
        kind = FIXED if joint.type is JointType.FIXED else PRISMATIC if joint.prismatic else REVOLUTE
        modes = link.beam.coordinates if link.beam is not None else 0
        topology[body, [PARENT, KIND, FIRST, MODES]] = seat.body, kind, coordinate, modes
        coordinate += (kind != FIXED) + modes
        _add_inertia(row, link, axes.T, np.zeros(3))
        if link.flexible:
            beams[body] = link.name
    _find_runs(topology[: body + 1])
    return Tree(
        system=system,
        n=coordinate,
        bodies=body,
        rows=np.ascontiguousarray(rows[: body + 1]),
        topology=np.ascontiguousarray(topology[: body + 1]),
        seats=seats,
        joints=tuple(carriers),
        beams=beams,
    )


def _find_runs(topology: Integers) -> None:
    """Runs of bodies, to the columns RUN and SLOT."""
    children = np.bincount(topology[1:, PARENT], minlength=len(topology))
    for body in range(1, len(topology)):
        before = body - 1
        first = topology[before, RUN]
        if before > 0 and topology[body, PARENT] == before and children[before] == 1 and body - first < RUN_LENGTH:
            topology[body, [RUN, SLOT]] = first, topology[before, SLOT]
        else:
            topology[body, [RUN, SLOT]] = body, topology[before, SLOT] + (before > 0)


def _add_inertia(row: Array, link: Link, rotation: Array, origin: Array) -> None:
    """Add a link's ten inertial parameters, link frame at (rotation, origin) in body axes, to a row."""
    com = rotation @ link.com + origin
    row[MASS] += link.mass
    row[MOMENT : MOMENT + 3] += link.mass * com
    placed = Link(name=link.name, mass=link.mass, com=com, inertia=rotation @ link.inertia @ rotation.T)
    row[INERTIA : INERTIA + 6] += about_origin(placed)[_UPPER]


def _check(joint: Joint, link: Link) -> None:
    numbers: dict[str, ArrayLike] = {
        "origin": joint.xyz,
        "rotation": joint.rotation,
        "axis": joint.axis,
        "armature": joint.armature,
        "damping": joint.damping,
        "friction": joint.friction,
        "stiffness": joint.stiffness,
        "rest position": joint.rest_position,
    }
    for name, value in numbers.items():
        if not np.isfinite(value).all():
            raise InputError(f"joint {joint.name!r}: {name} is not finite", mend="give finite numbers in SI units")
    if joint.movable and not np.linalg.norm(joint.axis) > 1e-9:
        raise InputError(f"joint {joint.name!r}: axis has no length", mend="give a direction, such as [0, 0, 1]")
    body: dict[str, ArrayLike] = {"mass": link.mass, "centre of mass": link.com, "inertia": link.inertia}
    for name, value in body.items():
        if not np.isfinite(value).all():
            raise InputError(f"link {link.name!r}: {name} is not finite", mend="give finite numbers in SI units")
