"""Whether a mechanism moves in one plane, so that ``lanes.planar`` does for it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.denoc.joint_laws import laws
from harness.denoc.lanes.nodes import KIND, PARENT, SECTION, SIGN
from harness.denoc.lanes.rows import BASE_SLOTS, BEAM_NODE, LAW_ROW, NODE, PER_JOINT
from harness.system import System

Array = NDArray[np.float64]

# Directions closer than this are parallel [rad]; what is beyond the plane then changes nothing that rounding would not.
PARALLEL = 1e-14


@dataclass(frozen=True, eq=False)
class Plane:
    """The plane of motion.

    axes: X, Y and the normal N in base coordinates, (3, 3), right-handed; normals: N in every joint's frame, (joints, 3);
    signs: of every node of the tree; loads: where in a row the load-dependent friction of slides stands.
    """

    axes: Array
    normals: Array
    signs: NDArray[np.int64]
    loads: NDArray[np.int64]

    def holds(self, rows: Array) -> NDArray[np.bool_]:
        """Which of the rows (B, P) keep to the plane: joints turned about N alone; no friction that feels what is across."""
        if not rows[:, self._leading_out].any():
            return np.ones(len(rows), dtype=np.bool_)
        flat = (rows[:, self.loads] == 0.0).all(axis=1)
        flat &= (np.abs(np.cross(rows[:, self._turns], self.normals)) <= PARALLEL).all(axis=(1, 2))
        return np.asarray(flat)

    @cached_property
    def _turns(self) -> NDArray[np.int64]:
        """Where in a row the turns of every joint stand, (joints, 3)."""
        return len(BASE_SLOTS) + PER_JOINT * np.arange(len(self.normals))[:, None] + 3 + np.arange(3)

    @cached_property
    def _leading_out(self) -> NDArray[np.int64]:
        """All places of a row where something other than zero may lead out of the plane."""
        return np.concatenate([self._turns.ravel(), self.loads])

    def tables(self, tables: tuple[Any, ...]) -> tuple[Any, ...]:
        """The kernels' tables for motion in the plane."""
        links, tree, sizes, axes, nominal, _ = tables
        signed = tree.copy()
        signed[:, SIGN] = self.signs
        return links, signed, sizes, axes, nominal, self.axes


def plane_of(system: System, links: Any, tree: Any) -> Plane | None:
    """The plane that all of a mechanism moves in, or None; links, tree: the tables of ``lanes.rows`` and ``lanes.nodes``."""
    turns: dict[str, Array] = {system.base: np.eye(3)}
    normals: list[tuple[int, Array]] = []  # node, axis in base coordinates
    slides: list[Array] = []
    loads: list[int] = []
    for joint, link, line in zip(system.joints, system.links, links, strict=True):
        turn = turns[joint.parent] @ joint.rotation
        turns[link.name] = turn
        node = int(line[NODE])
        if joint.movable and joint.prismatic:
            slides.append(turn @ joint.axis)
            loads.append(int(line[LAW_ROW]) + laws.MU_RADIUS)
        elif joint.movable:
            normals.append((node, turn @ joint.axis))
        if link.beam is not None:
            normals.append((int(line[BEAM_NODE]), turn @ np.cross(link.beam.direction, link.beam.bending)))
    if normals:
        normal = normals[0][1]
    else:
        across = next(
            (np.cross(slides[0], d) for d in slides[1:] if np.linalg.norm(np.cross(slides[0], d)) > 0.1), None
        )
        normal = np.cross(slides[0], np.eye(3)[np.argmin(np.abs(slides[0]))]) if across is None else across
    normal = normal / np.linalg.norm(normal)
    if any(np.abs(np.cross(normal, axis)).max() > PARALLEL for _, axis in normals):
        return None
    if any(abs(float(normal @ d)) > PARALLEL for d in slides):
        return None
    x = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    x /= np.linalg.norm(x)
    signs = np.ones(len(tree), dtype=np.int64)
    for node, axis in normals:
        signs[node] = 1 if float(axis @ normal) > 0.0 else -1
    for i, node in enumerate(tree):
        if node[KIND] == SECTION:
            signs[i] = signs[node[PARENT]]
    inward = np.array([turns[joint.child].T @ normal for joint in system.joints])
    return Plane(np.array([x, np.cross(normal, x), normal]), inward, signs, np.array(loads, dtype=np.int64))
