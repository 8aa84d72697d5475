"""A chain on parallel revolute joints, seen in the plane it moves in; for engines that model the plane only.

Conventions, all of them: the plane is spanned by x and y with z = x × y along the first joint's axis; the base's origin
is the plane's. In the zero pose every link has axes parallel to x and y; ``turn`` is how far it is turned from there,
counted positive about z. A joint whose axis points along -z counts its position negative: q = sign · (turn of the child
- turn of the parent's section it rides on).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.beam.integrals import BeamData, beam_data
from harness.engines.protocol import Array
from harness.errors import UnsupportedError
from harness.system import Beam, Joint, JointType, Link, System
from harness.system.inertia import about_origin

# Directions that should agree do so within this (radians); model files print angles with fewer digits.
_PARALLEL = 1e-9


@dataclass(frozen=True, eq=False)
class PlanarLink:
    """One link of the chain and the joint that carries it.

    parent: index of the parent link, -1 for the base. coordinate: index of the joint's position in the system's
    coordinates, -1 if fixed; elastic: indices of the bending coordinates in them, (m,).
    hinge: joint's place on the parent, from the parent's origin, in the zero pose [m], (2,).
    com [m] (2,), inertia about the centre of mass [kg·m²].
    direction, bending: unit vectors in the zero pose, (2,); zero for a rigid link.
    """

    link: Link
    joint: Joint
    parent: int
    sign: float
    coordinate: int
    elastic: NDArray[np.intp]
    hinge: Array
    com: Array
    inertia: float
    direction: Array
    bending: Array
    data: BeamData | None

    @property
    def beam(self) -> Beam:
        assert self.link.beam is not None
        return self.link.beam


@dataclass(frozen=True, eq=False)
class PlanarChain:
    """The chain in its plane; gravity: free-fall acceleration in the plane [m/s²], (2,)."""

    links: tuple[PlanarLink, ...]
    gravity: Array


@dataclass(frozen=True, eq=False)
class Pose:
    """Where a link is: origin (2,), turn, and, on a beam, points (p, 2) and slope vectors (p, 2) at stations."""

    origin: Array
    turn: Any
    points: Array
    slopes: Array
    tip_turn: Any


def why_not_planar(system: System) -> str | None:
    """Why a system is no chain on parallel revolute joints, or None."""
    try:
        planar_chain(system)
    except UnsupportedError as error:
        return error.what
    return None


def planar_chain(system: System) -> PlanarChain:
    """The system in its plane; UnsupportedError with a one-line reason if it has none.

    A fixed joint is taken at the base only, and gives the plane by its beam: z along the normal of bending.
    """
    rotations: dict[str, Array] = {system.base: np.eye(3)}
    normal: Array | None = None
    index = {link.name: k for k, link in enumerate(system.links)}
    names = system.coordinate_names
    x_axis = y_axis = np.zeros(3)
    links: list[PlanarLink] = []
    for joint, link in zip(system.joints, system.links, strict=True):
        if sum(other.parent == joint.parent for other in system.joints) > 1:
            raise UnsupportedError(f"{joint.parent!r} carries more than one joint; only chains are modelled")
        rotation = rotations[joint.parent] @ joint.rotation
        rotations[link.name] = rotation
        fixed = joint.type is JointType.FIXED
        if fixed and joint.parent != system.base:
            raise UnsupportedError(f"joint {joint.name!r} is fixed; only at the base is that modelled")
        if joint.prismatic:
            raise UnsupportedError(f"joint {joint.name!r} slides; only revolute joints are modelled")
        if fixed:
            if link.beam is None:
                raise UnsupportedError(f"link {link.name!r} is rigid and fixed to the base")
            axis = rotation @ np.cross(link.beam.direction, link.beam.bending)
        else:
            axis = rotation @ joint.axis
        if normal is None:
            normal = axis / np.linalg.norm(axis)
            x_axis, y_axis = _plane(normal, rotation @ link.beam.direction if link.beam else None)
        share = float(axis @ normal)
        if abs(abs(share) - 1.0) > _PARALLEL:
            raise UnsupportedError(f"the axis of joint {joint.name!r} is not parallel to the first one's")

        def flat(vector: Array, x: Array = x_axis, y: Array = y_axis) -> Array:
            return np.array([vector @ x, vector @ y])

        direction, bending, data = np.zeros(2), np.zeros(2), None
        elastic = np.zeros(0, dtype=np.intp)
        if link.beam is not None:
            across = float(rotation @ np.cross(link.beam.direction, link.beam.bending) @ normal)
            if abs(abs(across) - 1.0) > _PARALLEL:
                raise UnsupportedError(f"link {link.name!r} bends out of the plane of motion")
            if link.beam.bending2 or link.beam.torsion_modes:
                raise UnsupportedError(f"link {link.name!r} bends or twists out of the plane of motion")
            direction, bending = flat(rotation @ link.beam.direction), flat(rotation @ link.beam.bending)
            data = beam_data(system, link.name)
            elastic = np.array([names.index(f"{link.name}.mode{k + 1}") for k in range(link.beam.modes)], dtype=np.intp)
        axis_local = rotation.T @ normal
        about = float(axis_local @ about_origin(link) @ axis_local)
        com = flat(rotation @ link.com)
        links.append(
            PlanarLink(
                link=link,
                joint=joint,
                parent=index.get(joint.parent, -1),
                sign=float(np.sign(share)),
                coordinate=-1 if fixed else names.index(joint.name),
                elastic=elastic,
                hinge=flat(rotations[joint.parent] @ joint.xyz),
                com=com,
                inertia=about - link.mass * float(com @ com),
                direction=direction,
                bending=bending,
                data=data,
            )
        )
    if normal is None:
        raise UnsupportedError("the system has no joint")
    return PlanarChain(tuple(links), np.array([system.gravity @ x_axis, system.gravity @ y_axis]))


def _plane(normal: Array, first: Array | None) -> tuple[Array, Array]:
    """Axes of the plane; x along the first link if it is a beam in the plane."""
    seed = first if first is not None and abs(float(first @ normal)) < _PARALLEL else None
    if seed is None:
        seed = np.eye(3)[int(np.argmin(np.abs(normal)))]
        seed = seed - normal * float(seed @ normal)
    x = seed / np.linalg.norm(seed)
    return x, np.cross(normal, x)


def poses(chain: PlanarChain, q: Array, stations: int) -> list[Pose]:
    """Where every link is in state q (real, or complex for derivatives by a complex step).

    stations: points on each beam, evenly from root to tip, deflected by the elastic coordinates to second order.
    """
    placed: list[Pose] = []
    for link in chain.links:
        if link.parent < 0:
            origin, turn = link.hinge.astype(q.dtype), q.dtype.type(0.0)
        else:
            before, parent = placed[link.parent], chain.links[link.parent]
            if parent.data is None:
                origin = before.origin + _turned(link.hinge, before.turn)
            else:
                # What is left of the hinge's place, seen from the tip, turns with the tip's section.
                rest = link.hinge - parent.data.length * parent.direction
                origin = before.points[-1] + _turned(rest, before.tip_turn)
            turn = before.tip_turn
        if link.coordinate >= 0:
            turn = turn + link.sign * q[link.coordinate]
        if link.data is None:
            placed.append(Pose(origin, turn, origin[None, :], np.zeros((1, 2)), turn))
            continue
        data, b = link.data, q[link.elastic]
        x = np.linspace(0.0, data.length, stations)
        sections = [data.at(float(station)) for station in x]
        u = np.array([section.s @ b for section in sections])
        slope = np.array([section.slope @ b for section in sections])
        short = np.array([0.5 * b @ section.H @ b for section in sections])
        d, e = _turned(link.direction, turn), _turned(link.bending, turn)
        points = origin + np.outer(x - short, d) + np.outer(u, e)
        slopes = np.outer(1.0 - 0.5 * slope**2, d) + np.outer(slope, e)
        # The native model turns a section by its slope, to first order.
        side = float(np.sign(link.direction[0] * link.bending[1] - link.direction[1] * link.bending[0]))
        placed.append(Pose(origin, turn, points, slopes, turn + side * slope[-1]))
    return placed


def poses_and_rates(chain: PlanarChain, q: Array, qd: Array, stations: int) -> tuple[list[Pose], list[Pose]]:
    """Poses, and their rates of change at velocities qd (exact, by a complex step)."""
    h = 1e-30
    stepped = poses(chain, q + 1j * h * qd, stations)

    def rate(pose: Pose) -> Pose:
        return Pose(*(np.imag(part) / h for part in (pose.origin, pose.turn, pose.points, pose.slopes, pose.tip_turn)))

    return poses(chain, np.asarray(q, dtype=np.float64), stations), [rate(pose) for pose in stepped]


def _turned(vector: Array, angle: Any) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])
