"""What sensors on flexible links would read, from coordinates, velocities and accelerations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from harness.denoc.beam import BENDING
from harness.denoc.elastic import AXES
from harness.denoc.rows import ACCELERATION, BEAM, FIRST, FIXED, KIND, SPIN, TURN

if TYPE_CHECKING:
    from harness.denoc.model import Denoc
    from harness.denoc.tree import Array


def channels(model: Denoc, position: Array, velocity: Array, acceleration: Array | None) -> dict[str, Array]:
    """Channels of every flexible link; position, velocity, acceleration (T, n), result by column name, each (T,).

    ``<link>.tip_deflection`` [m]: along the bending direction, from the line that leaves the joint along the
    undeformed link. ``<link>.root_strain`` [1]: half depth times curvature at the root, positive where the beam bends
    towards positive deflection (what a gauge on the side away from it reads); left out if the depth is unknown.
    ``<link>.tip_acceleration`` [m/s²]: specific force (acceleration less gravity) of the tip along the bending
    direction of the tip's own, turned section; left out without accelerations.
    """
    found: dict[str, Array] = {}
    for body, data in model.beams.items():
        first = int(model.tree.topology[body, FIRST] + (model.tree.topology[body, KIND] != FIXED))
        b = position[:, first : first + data.coordinates]
        bends = data.plane == BENDING
        found[f"{data.link}.tip_deflection"] = b[:, bends] @ data.tip.s[bends]
        if np.isfinite(data.half_depth):
            found[f"{data.link}.root_strain"] = data.half_depth * (b[:, bends] @ data.at(0.0).curvature[bends])
        if acceleration is not None:
            found[f"{data.link}.tip_acceleration"] = np.array(
                [
                    tip_acceleration(model, body, q, v, a)
                    for q, v, a in zip(position, velocity, acceleration, strict=True)
                ]
            )
    return found


def tip_acceleration(model: Denoc, body: int, q: Array, qd: Array, qdd: Array) -> float:
    """Specific force of a beam's tip along its section's bending direction [m/s²]."""
    data = model.beams[body]
    tree = model.tree
    # Fills spin and acceleration of the hub; the base carries -g, so this is acceleration less gravity.
    model.inverse_dynamics(q, qd, qdd)
    row = tree.rows[body]
    packed = model.packed_beams
    axes = packed[tree.topology[body, BEAM] + AXES :][:9].reshape(3, 3)
    turn = row[TURN : TURN + 9].reshape(3, 3) @ axes
    spin = turn.T @ row[SPIN : SPIN + 3]
    angular = turn.T @ row[ACCELERATION : ACCELERATION + 3]
    linear = turn.T @ row[ACCELERATION + 3 : ACCELERATION + 6]
    first = int(tree.topology[body, FIRST] + (tree.topology[body, KIND] != FIXED))
    b, bd, bdd = (x[first : first + data.coordinates] for x in (q, qd, qdd))
    s, slope = data.tip.s, data.tip.slope
    h = data.tip.H if data.geometric_stiffening else np.zeros_like(data.tip.H)
    along = [data.plane == kind for kind in range(3)]
    place = np.array([data.length - 0.5 * b @ h @ b, s[along[0]] @ b[along[0]], s[along[1]] @ b[along[1]]])
    rate = np.array([-b @ h @ bd, s[along[0]] @ bd[along[0]], s[along[1]] @ bd[along[1]]])
    second = np.array([-b @ h @ bdd - bd @ h @ bd, s[along[0]] @ bdd[along[0]], s[along[1]] @ bdd[along[1]]])
    acceleration = (
        linear + np.cross(angular, place) + np.cross(spin, np.cross(spin, place)) + 2.0 * np.cross(spin, rate) + second
    )
    one, two = float(slope[along[0]] @ b[along[0]]), float(slope[along[1]] @ b[along[1]])
    twist = float(s[along[2]] @ b[along[2]])
    # The section's h in the beam's axes: turned about n, then about -h, then twisted.
    side = np.array([-np.sin(one), np.cos(one), 0.0])
    normal = np.array([-np.cos(one) * np.sin(two), -np.sin(one) * np.sin(two), np.cos(two)])
    return float((side * np.cos(twist) + normal * np.sin(twist)) @ acceleration)
