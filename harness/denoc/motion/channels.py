"""What sensors on flexible links would read, from coordinates, velocities and accelerations."""

from __future__ import annotations

import numpy as np

from harness.denoc.beam.integrals import BENDING, BENDING2, TORSION
from harness.denoc.beam.static_correction import left_out
from harness.denoc.motion.mechanism import Mechanism
from harness.denoc.recursion.elastic import AXES
from harness.denoc.recursion.rows import BEAM, FIRST, FIXED, KIND
from harness.denoc.recursion.tree import Array


def channels(model: Mechanism, position: Array, velocity: Array, acceleration: Array) -> dict[str, Array]:
    """Channels of every flexible link; position, velocity, acceleration (T, n), result by column name, each (T,).

    ``<link>.tip_deflection`` [m]: along the bending direction, from the line that leaves the joint along the undeformed link,
    with what the modes leave out of it (see ``left_out``). ``<link>.root_strain`` [1]: half depth times curvature at the
    root, positive where the beam bends towards positive deflection (what a gauge on the side away from it reads); left out
    if the depth is unknown.
    ``<link>.tip_acceleration`` [m/s²]: specific force (acceleration less gravity) of the tip along the bending
    direction of the tip's own, turned section.
    """
    found: dict[str, Array] = {}
    for body, data in model.beams.items():
        first = int(model.tree.topology[body, FIRST] + (model.tree.topology[body, KIND] != FIXED))
        place = model.position_place(first)
        b = position[:, place : place + data.coordinates]
        bends = data.plane == BENDING
        rest = left_out(model.system, data)
        motion = spin, angular, linear = _root_motion(model, body, position, velocity, acceleration)
        second = acceleration[:, first : first + data.coordinates][:, bends]
        root, turning = linear[:, 1], angular[:, 2] + spin[:, 0] * spin[:, 1]
        tip = b[:, bends] @ data.tip.s[bends] + rest.read(rest.tip, root, turning, second)
        found[f"{data.link}.tip_deflection"] = tip
        if np.isfinite(data.half_depth):
            curvature = b[:, bends] @ data.at(0.0).curvature[bends] + rest.read(rest.curvature, root, turning, second)
            found[f"{data.link}.root_strain"] = data.half_depth * curvature
        found[f"{data.link}.tip_acceleration"] = _tip_acceleration(
            model, body, motion, position, velocity, acceleration
        )
    return found


def _root_motion(
    model: Mechanism, body: int, position: Array, velocity: Array, acceleration: Array
) -> tuple[Array, Array, Array]:
    """Angular velocity and acceleration of a beam's root, and its acceleration less gravity, in its axes f, h, n, each (T, 3)."""
    axes = model.packed_beams[model.tree.topology[body, BEAM] + AXES :][:9].reshape(3, 3)
    hub = model.hub_motion(body, position, velocity, acceleration)
    turn = hub[:, :9].reshape(-1, 3, 3) @ axes
    spin, angular, linear = (np.einsum("tij,ti->tj", turn, hub[:, k : k + 3]) for k in (9, 12, 15))
    return spin, angular, linear


def _tip_acceleration(
    model: Mechanism,
    body: int,
    motion: tuple[Array, Array, Array],
    position: Array,
    velocity: Array,
    acceleration: Array,
) -> Array:
    """Specific force of a beam's tip along its section's bending direction [m/s²], (T,); motion: of its root; others (T, n)."""
    data = model.beams[body]
    spin, angular, linear = motion
    first = int(model.tree.topology[body, FIRST] + (model.tree.topology[body, KIND] != FIXED))
    at = model.position_place(first)
    b = position[:, at : at + data.coordinates]
    bd, bdd = (x[:, first : first + data.coordinates] for x in (velocity, acceleration))
    s, slope = data.tip.s, data.tip.slope
    one, two, twist = (data.plane == kind for kind in (BENDING, BENDING2, TORSION))
    shapes = np.column_stack([np.zeros(len(s)), s * one, s * two])
    h = data.tip.H if data.geometric_stiffening else np.zeros_like(data.tip.H)
    axial = np.array([1.0, 0.0, 0.0])

    def quadratic(x: Array, y: Array) -> Array:
        return np.einsum("tk,kl,tl->t", x, h, y)[:, None] * axial

    place = data.length * axial + b @ shapes - 0.5 * quadratic(b, b)
    rate = bd @ shapes - quadratic(b, bd)
    second = bdd @ shapes - quadratic(b, bdd) - quadratic(bd, bd)
    total = (
        linear + np.cross(angular, place) + np.cross(spin, np.cross(spin, place)) + 2.0 * np.cross(spin, rate) + second
    )
    # The section's h: turned about n, then about -h, then twisted.
    c1, s1 = np.cos(b @ (slope * one)), np.sin(b @ (slope * one))
    c2, s2 = np.cos(b @ (slope * two)), np.sin(b @ (slope * two))
    c3, s3 = np.cos(b @ (s * twist)), np.sin(b @ (s * twist))
    side = np.column_stack([-s1 * c3 - c1 * s2 * s3, c1 * c3 - s1 * s2 * s3, c2 * s3])
    return np.asarray(np.einsum("ti,ti->t", side, total))
