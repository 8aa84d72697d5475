"""Beams packed for the kernels: mass reduced to a few points, sections that joints ride on.

Every inertia of a beam is an integral of products of two of the functions 1, x, s_k(x), H_kl(x). An orthogonal
factorization of their values at the quadrature nodes (weighted by the square root of the mass there) therefore gives
*points*, as few as there are independent functions, whose sums equal those integrals to rounding: with one mode four
points instead of some sixty nodes. A point has no station of its own; it is a row of values of those functions.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from harness.denoc.beam.integrals import BENDING, BENDING2, TORSION, BeamData, Station, beam_data
from harness.denoc.recursion.rows import BEAM, EXTENDED, INERTIA, MASS, MODES, MOMENT, OFFSET, PARENT, POINTS, STATION
from harness.denoc.recursion.tree import Array, Tree
from harness.system.inertia import point_inertia

# Layout of a beam's constants. Axes: f, h, n = f × h as columns, in body axes.
AXES, POLAR, HAS_TIP_INERTIA, TIP_INERTIA, HEAD = 0, 9, 10, 11, 20

# Directions that carry less than this share of the mass moments are rounding.
_RANK = 1e-15


def stiffness_at(beam: int, m: int) -> int:
    """Where K (m, m) begins; damping C (m, m) follows it."""
    return beam + HEAD


def station_size(m: int) -> int:
    """Numbers of a section: x, s (m) in each plane, H (m, m), slope (m) in each plane, twist (m)."""
    return 1 + 5 * m + m * m


def point_size(m: int) -> int:
    """Numbers of a point: value of 1, then as a section begins: x, s (m) in each plane, H (m, m)."""
    return 2 + 2 * m + m * m


def beam_size(m: int, points: int) -> int:
    """Numbers of a beam: head, K, C, twist's momentum (m) and inertia (m, m), tip section, points."""
    return HEAD + 3 * m * m + m + station_size(m) + points * point_size(m)


def workspace_size(m: int) -> int:
    """Numbers of a body's elastic workspace: N (m, 6), A (m, m), bias (m), A⁻¹N (m, 6), A⁻¹y (m), two scratch (m)."""
    return m * m + 16 * m


def pack_beams(tree: Tree) -> tuple[Array, dict[int, BeamData]]:
    """Constants and workspace of all beams in one array; completes the tree's rows and integers accordingly."""
    parts: list[Array] = []
    size = 0
    beams: dict[int, BeamData] = {}

    def add(part: Array) -> int:
        nonlocal size
        begin = size
        parts.append(np.asarray(part, dtype=np.float64).ravel())
        size += parts[-1].size
        return begin

    for body, name in tree.beams.items():
        data = beam_data(tree.system, name)
        beams[body] = data
        m = data.coordinates
        rotation = tree.seats[name].rotation
        points = mass_points(data)
        axes = rotation @ np.column_stack([data.direction, data.bending, data.normal])
        twist = data.plane == TORSION
        polar = data.polar_inertia
        turning = polar * data.length if twist.any() else 0.0
        moment = np.where(twist, polar * data.S0, 0.0)
        inertia = polar * data.S1 * np.outer(twist, twist)
        local = np.column_stack([data.direction, data.bending, data.normal])
        tip = local.T @ data.payload_inertia @ local
        head: list[ArrayLike] = [axes.ravel(), [turning, float(tip.any())], tip.ravel()]
        constants = [np.concatenate(head), data.K, data.C, moment, inertia, section(data, data.tip), points]
        begin = add(np.concatenate([np.ravel(part) for part in constants]))
        tree.topology[body, [BEAM, POINTS]] = begin, len(points)
        tree.topology[body, EXTENDED] = add(np.zeros(workspace_size(m)))
        _leave_hub(tree.rows[body], data, rotation)
    for body in range(1, tree.bodies + 1):
        parent = int(tree.topology[body, PARENT])
        if parent not in beams:
            continue
        data = beams[parent]
        direction = tree.seats[data.link].rotation @ data.direction
        origin = tree.rows[body, OFFSET : OFFSET + 3]
        x = float(np.clip(origin @ direction, 0.0, data.length))
        # What is left of the origin is a rigid offset from the section.
        origin -= x * direction
        m = int(tree.topology[parent, MODES])
        tree.topology[body, STATION] = add(np.concatenate([section(data, data.at(x)), np.zeros(6 * m)]))
    return (np.concatenate(parts) if parts else np.zeros(0)), beams


def section(data: BeamData, station: Station) -> Array:
    """A section as the kernels read it."""
    first, second, twist = data.plane == BENDING, data.plane == BENDING2, data.plane == TORSION
    return np.concatenate(
        [
            [station.x],
            station.s * first,
            station.s * second,
            (station.H if data.geometric_stiffening else np.zeros_like(station.H)).ravel(),
            station.slope * first,
            station.slope * second,
            station.s * twist,
        ]
    )


def mass_points(data: BeamData) -> Array:
    """Points that carry the mass of beam and payload, one a row: values of 1, x, s (two planes), H; (P, 2 + 2m + m²)."""
    m = data.coordinates
    first, second = data.plane == BENDING, data.plane == BENDING2
    together = (data.plane[:, None] == data.plane) & (first | second)
    h = data.H * together if data.geometric_stiffening else np.zeros_like(data.H)
    h_tip = data.tip.H * together if data.geometric_stiffening else np.zeros_like(data.tip.H)
    # Nodes of the beam, and the payload as one more.
    mass = np.append(data.rho * data.weights, data.payload)
    ones = np.ones(len(mass))
    x = np.append(data.x, data.length)
    s = np.vstack([data.s, data.tip.s])
    values = np.column_stack([ones, x, s * first, s * second, np.concatenate([h, h_tip[None]]).reshape(-1, m * m)])
    weighted = values * np.sqrt(mass)[:, None]
    # Scaled, so that rank is judged function by function, and decomposed: U is orthonormal and drops out of all sums.
    scale = np.linalg.norm(weighted, axis=0)
    scale[scale == 0.0] = 1.0
    _, singular, right = scipy.linalg.svd(weighted / scale, full_matrices=False)
    keep = singular > _RANK * singular[0]
    return np.ascontiguousarray(singular[keep, None] * right[keep] * scale)


def _leave_hub(row: Array, data: BeamData, rotation: NDArray[np.float64]) -> None:
    """Take beam and payload, undeformed, out of the link's rigid inertia: what is left turns with the hub."""
    direction = rotation @ data.direction
    l, mass = data.length, data.rho * data.length
    moment = mass * l / 2 + data.payload * l
    across = np.eye(3) - np.outer(direction, direction)
    inertia = mass * l * l / 3 * across + point_inertia(data.payload, direction * l)
    inertia = inertia + rotation @ data.payload_inertia @ rotation.T
    taken = np.concatenate([[mass + data.payload], moment * direction, inertia[np.triu_indices(3)]])
    own = np.concatenate([row[[MASS]], row[MOMENT : MOMENT + 3], row[INERTIA : INERTIA + 6]])
    left = own - taken
    # Differences of rounding are no hub.
    left[np.abs(left) < 1e-12 * np.array([own[0], *[np.abs(own[1:4]).max()] * 3, *[np.abs(own[4:]).max()] * 6])] = 0.0
    row[MASS], row[MOMENT : MOMENT + 3], row[INERTIA : INERTIA + 6] = left[0], left[1:4], left[4:]
