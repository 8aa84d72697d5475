"""The DeNOC matrices as in the textbook, in plain NumPy: for proofs, teaching, and as a second opinion on the recursions.

Nothing here is shared with the kernels: links keep their own frames (welded links their own rows), beams are integrated
node by node. The twist of link i stacks angular velocity, velocity of the link's origin (base axes) and, for a flexible
link, its modal rates; there are n̂ = 6 n_r + (6 + m) n_f rows. With θ̇ the generalized rates,

    t = N_l N_d θ̇,        N_dᵀ N_lᵀ (M ṫ + …) = τ,        I = N_dᵀ N_lᵀ M N_l N_d.

Sources: S. K. Saha, Dynamics of serial multibody systems using the decoupled natural orthogonal complement matrices,
ASME J. Applied Mechanics 66 (1999) 986-996; the flexible blocks follow from the kinematics in ``docs/theory.md``.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.denoc.beam.integrals import BENDING, BENDING2, TORSION, BeamData, Station, beam_data
from harness.errors import InputError, UnsupportedError
from harness.system import Joint, JointType, Link, System
from harness.system.inertia import about_origin, point_inertia
from harness.system.rotation import about_axis, along_z, from_quaternion, skew

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Section:
    """A section of a bent beam in the link's frame: place (3,), rotation (3, 3), partial velocities and spins (3, m)."""

    place: Array
    rotation: Array
    velocities: Array
    spins: Array


@dataclass(frozen=True, eq=False)
class DenocMatrices:
    """The matrices of a system at one configuration; n̂ rows of twists, n coordinates, one block a link.

    N_l: (n̂, n̂), lower block triangular: how a link's twist carries on to the links it bears.
    N_d: (n̂, n), block diagonal: what a joint (its motion subspace, one column a velocity), and a link's own modes, add.
    M: (n̂, n̂), block diagonal: mass matrices of the links about their origins, extended by the modes.
    composite: mass matrix of the composite body that each link bears, one (6 + m, 6 + m) a link.
    rows, columns: where each link's block begins and ends.
    parents: index of each link's parent link, -1 for the base.
    armature: diagonal of what joints add on their own account, (n,).
    """

    N_l: Array
    N_d: Array
    M: Array
    composite: tuple[Array, ...]
    rows: tuple[slice, ...]
    columns: tuple[slice, ...]
    parents: tuple[int, ...]
    armature: Array

    @property
    def inertia(self) -> Array:
        """Generalized inertia matrix I = N_dᵀ N_lᵀ M N_l N_d, armature added, (n, n)."""
        n = self.N_l @ self.N_d
        return np.asarray(n.T @ self.M @ n + np.diag(self.armature))

    def element(self, i: int, j: int) -> Array:
        """Block I_ij = N_d,iᵀ M̃_i A_ij N_d,j of the generalized inertia matrix, j at or before i: the recursive form.

        M̃_i is the composite body's mass matrix; the block vanishes unless link j bears link i. Armature is left out.
        """
        carried = self.N_l[self.rows[i], self.rows[j]]
        own, other = self.N_d[self.rows[i], self.columns[i]], self.N_d[self.rows[j], self.columns[j]]
        return np.asarray(own.T @ self.composite[i] @ carried @ other)

    def udu(self) -> tuple[Array, Array]:
        """Factors I = U D Uᵀ by articulated bodies: U unit upper triangular (n, n), D its positive diagonal (n,).

        Coordinates are eliminated one after the other, the last link's first; each takes its share, ψ ψᵀ / D, out of
        the articulated mass matrix M̂ that its link hands on.
        """
        n = self.N_d.shape[1]
        articulated = [self.M[rows, rows].copy() for rows in self.rows]
        upper, diagonal = np.eye(n), np.zeros(n)
        for i in range(len(self.rows) - 1, -1, -1):
            own = self.N_d[self.rows[i], self.columns[i]]
            for k in range(own.shape[1] - 1, -1, -1):
                column = self.columns[i].start + k
                psi = articulated[i] @ own[:, k]
                diagonal[column] = own[:, k] @ psi + self.armature[column]
                share = psi / diagonal[column]
                for l in range(k):
                    upper[self.columns[i].start + l, column] = own[:, l] @ share
                j = self.parents[i]
                while j >= 0:
                    carried = self.N_l[self.rows[i], self.rows[j]] @ self.N_d[self.rows[j], self.columns[j]]
                    upper[self.columns[j], column] = carried.T @ share
                    j = self.parents[j]
                articulated[i] -= np.outer(psi, share)
            j = self.parents[i]
            if j >= 0:
                step = self.N_l[self.rows[i], self.rows[j]]
                articulated[j] += step.T @ articulated[i] @ step
        return upper, diagonal


def denoc_matrices(system: System, q: ArrayLike) -> DenocMatrices:
    """The DeNOC matrices of a system at positions q, shape (nq,).

    Raises InputError for a wrong size, UnsupportedError for a joint that mimics another: N_d is then no block diagonal.
    """
    position = np.asarray(q, dtype=np.float64)
    n, nq = system.nv, system.nq
    if position.shape != (nq,):
        raise InputError(f"q has shape {position.shape}", mend=f"give shape ({nq},)")
    for joint in system.joints:
        if joint.mimic is not None:
            raise UnsupportedError(
                f"joint {joint.name!r} mimics {joint.mimic.joint!r}: the matrices have independent joints only",
                mend="take the mimic out; harness.Denoc knows it",
            )
    links = {link.name: k for k, link in enumerate(system.links)}
    parents = tuple(links.get(joint.parent, -1) for joint in system.joints)
    beams = [beam_data(system, link.name) if link.flexible else None for link in system.links]
    sizes = [6 + (data.coordinates if data else 0) for data in beams]
    begins = np.concatenate([[0], np.cumsum(sizes)])
    rows = tuple(slice(int(a), int(b)) for a, b in pairwise(begins))
    total = int(begins[-1])
    step_in, drive, mass = np.zeros((total, total)), np.zeros((total, n)), np.zeros((total, total))
    armature = np.zeros(n)
    columns: list[slice] = []
    rotations: list[Array] = []
    bent: list[Array] = []
    steps: list[Array] = []
    column = place = 0
    for k, (joint, link, data) in enumerate(zip(system.joints, system.links, beams, strict=True)):
        p = parents[k]
        carried = beams[p] if p >= 0 else None
        base = rotations[p] if p >= 0 else np.eye(3)
        elastic = bent[p] if carried else np.zeros(0)
        frame, reach, partial = _joint_frame(joint, carried, elastic)
        width, own = len(joint.position_names), len(joint.velocity_names)
        turn, slide, subspace = joint_motion(joint, position[place : place + width])
        frame = base @ frame
        slide = frame @ slide
        reach = base @ reach + slide
        rotation = frame @ turn
        modes = data.coordinates if data else 0
        bent.append(position[place + width : place + width + modes])
        block = slice(column, column + own + modes)
        columns.append(block)
        rotations.append(rotation)
        # A of this link against its parent: rigid shift, and partial twists of the section it rides on.
        step = np.zeros((sizes[k], sizes[p] if p >= 0 else 6))
        step[:3, :3] = step[3:6, 3:6] = np.eye(3)
        step[3:6, :3] = -skew(reach)
        if carried is not None:
            step[:3, 6:] = base @ partial[:3]
            step[3:6, 6:] = base @ partial[3:] - skew(slide) @ (base @ partial[:3])
        steps.append(step)
        armature[column : column + own] = joint.armature
        first = rows[k].start
        drive[first : first + 3, column : column + own] = frame @ subspace[:3]
        drive[first + 3 : first + 6, column : column + own] = frame @ subspace[3:]
        for l in range(modes):
            drive[rows[k].start + 6 + l, column + own + l] = 1.0
        local = _link_mass(link, data, bent[k])
        spread = np.eye(sizes[k])
        spread[:3, :3] = spread[3:6, 3:6] = rotation
        mass[rows[k], rows[k]] = spread @ local @ spread.T
        step_in[rows[k], rows[k]] = np.eye(sizes[k])
        j, product = p, step
        while j >= 0:
            step_in[rows[k], rows[j]] = product
            product = product @ steps[j]
            j = parents[j]
        column += own + modes
        place += width + modes
    composite = [mass[r, r].copy() for r in rows]
    for k in range(len(rows) - 1, -1, -1):
        if parents[k] >= 0:
            composite[parents[k]] += steps[k].T @ composite[k] @ steps[k]
    return DenocMatrices(step_in, drive, mass, tuple(composite), rows, tuple(columns), parents, armature)


def joint_motion(joint: Joint, q: Array) -> tuple[Array, Array, Array]:
    """Where a joint at its own positions q puts its child, and its motion subspace S, all in axes of the joint frame.

    Returns rotation (3, 3) of the child's axes, shift (3,) of its origin and S (6, nv): angular velocity of the child and
    velocity of its origin, relative to the parent, by unit velocities of the joint.
    """
    eye, zero = np.eye(3), np.zeros(3)
    none = np.zeros((3, 3))
    axis = np.asarray(joint.axis)
    match joint.type:
        case JointType.FIXED:
            return eye, zero, np.zeros((6, 0))
        case JointType.PRISMATIC:
            return eye, axis * q[0], np.concatenate([zero, axis])[:, None]
        case JointType.HELICAL:
            along = joint.pitch * axis
            return about_axis(axis, q[0]), along * q[0], np.concatenate([axis, along])[:, None]
        case JointType.UNIVERSAL:
            first = about_axis(axis, q[0])
            spins = np.column_stack([axis, first @ joint.axis2])
            return first @ about_axis(joint.axis2, q[1]), zero, np.vstack([spins, np.zeros((3, 2))])
        case JointType.PLANAR:
            plane = along_z(axis)
            subspace = np.zeros((6, 3))
            subspace[3:, :2], subspace[:3, 2] = plane[:, :2], axis
            return about_axis(axis, q[2]), plane[:, :2] @ q[:2], subspace
        case JointType.BALL:
            rotation = from_quaternion(q)
            return rotation, zero, np.vstack([rotation, none])
        case JointType.FREE:
            rotation = from_quaternion(q[3:])
            return rotation, q[:3], np.block([[none, rotation], [eye, none]])
        case _:
            return about_axis(axis, q[0]), zero, np.concatenate([axis, zero])[:, None]


def section(data: BeamData, station: Station, b: Array) -> Section:
    """A section of a beam bent by elastic coordinates b (m,)."""
    f, h, n = data.direction, data.bending, data.normal
    first, second, twist = (data.plane == kind for kind in (BENDING, BENDING2, TORSION))
    bent = station.H if data.geometric_stiffening else np.zeros_like(station.H)
    place = (station.x - 0.5 * b @ bent @ b) * f + (station.s * first @ b) * h + (station.s * second @ b) * n
    velocities = np.outer(h, station.s * first) + np.outer(n, station.s * second) - np.outer(f, bent @ b)
    one = about_axis(n, float(station.slope * first @ b))
    two = one @ about_axis(-h, float(station.slope * second @ b))
    three = two @ about_axis(f, float(station.s * twist @ b))
    spins = (
        np.outer(n, station.slope * first)
        + np.outer(-one @ h, station.slope * second)
        + np.outer(two @ f, station.s * twist)
    )
    return Section(place, three, velocities, spins)


def _joint_frame(joint: Joint, data: BeamData | None, b: Array) -> tuple[Array, Array, Array]:
    """Rotation and origin of the joint frame in the parent's link frame; partial twists (6, m) if it rides on a beam."""
    if data is None:
        return np.asarray(joint.rotation), np.asarray(joint.xyz), np.zeros((6, 0))
    x = float(np.clip(joint.xyz @ data.direction, 0.0, data.length))
    cut = section(data, data.at(x), b)
    offset = cut.rotation @ (joint.xyz - x * data.direction)
    partial = np.vstack([cut.spins, cut.velocities - skew(offset) @ cut.spins])
    return cut.rotation @ joint.rotation, cut.place + offset, partial


def _link_mass(link: Link, data: BeamData | None, b: Array) -> Array:
    """Mass matrix of one link about its origin, in its own frame, extended by its modes."""
    if data is None:
        return _rigid_mass(link.mass, np.asarray(link.com) * link.mass, about_origin(link))
    m = data.coordinates
    result = np.zeros((6 + m, 6 + m))
    # What of the link is neither beam nor payload turns with the hub.
    line = data.rho * data.length * data.length**2 / 3 * (np.eye(3) - np.outer(data.direction, data.direction))
    tip = data.length * data.direction
    moment = link.mass * link.com - (data.rho * data.length / 2 + data.payload) * tip
    inertia = about_origin(link) - line - point_inertia(data.payload, tip) - data.payload_inertia
    result[:6, :6] = _rigid_mass(link.mass - data.rho * data.length - data.payload, moment, inertia)
    stations = [Station(data.x[k], data.s[k], data.slope[k], data.curvature[k], data.H[k]) for k in range(len(data.x))]
    masses = [*(data.rho * data.weights), data.payload]
    for station, mass in zip([*stations, data.tip], masses, strict=True):
        cut = section(data, station, b)
        partial = np.hstack([-skew(cut.place), np.eye(3), cut.velocities])
        result += mass * partial.T @ partial
    twist = data.plane == TORSION
    if twist.any():
        for station, weight in zip(stations, data.weights, strict=True):
            spin = np.concatenate([data.direction, np.zeros(3), station.s * twist])
            result += data.polar_inertia * weight * np.outer(spin, spin)
    cut = section(data, data.tip, b)
    spins = np.hstack([np.eye(3), np.zeros((3, 3)), cut.spins])
    result += spins.T @ cut.rotation @ data.payload_inertia @ cut.rotation.T @ spins
    return result


def _rigid_mass(mass: float, moment: Array, inertia: Array) -> Array:
    result = np.zeros((6, 6))
    result[:3, :3] = inertia
    result[:3, 3:] = skew(moment)
    result[3:, :3] = -skew(moment)
    result[3:, 3:] = mass * np.eye(3)
    return result
