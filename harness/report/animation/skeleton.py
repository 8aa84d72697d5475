"""A mechanism as lines: from joint to joint, and from the last joint to the tip or the centre of mass."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.denoc import Denoc
from harness.system import System

Array = NDArray[np.float64]

SPOKE = 0.2  # of the mechanism's extent: what shows the turning of a link whose centre lies on its joint
ON_THE_JOINT = 1e-9  # m


@dataclass(frozen=True, eq=False)
class Skeleton:
    """``marks``: the link each point belongs to and its place in the link's frame [m]; ``edges``: pairs of points, shape (E, 2)."""

    system: System
    marks: tuple[tuple[str, Array], ...]
    edges: NDArray[np.intp]

    def points(self, positions: Mapping[str, Array]) -> Array:
        """Points over time in base coordinates [m], shape (T, K, 3).

        positions: of joints by name [rad or m], each shape (T,); joints that are not named stand at zero, links do not bend.
        """
        model = Denoc(replace(self.system, attachments=()))
        count = len(next(iter(positions.values()))) if positions else 1
        out = np.empty((count, len(self.marks), 3))
        q = np.zeros(model.n)
        places = [(model.names.index(name), values) for name, values in positions.items() if name in model.names]
        for t in range(count):
            for place, values in places:
                q[place] = values[t]
            poses = {link: model.link_pose(q, link) for link in dict.fromkeys(link for link, _ in self.marks)}
            for k, (link, own) in enumerate(self.marks):
                rotation, origin = poses[link]
                out[t, k] = origin + rotation @ own
        return out


def skeleton(system: System) -> Skeleton:
    """The lines of a system."""
    model = Denoc(replace(system, attachments=()))
    rest = {link.name: model.link_pose(np.zeros(model.n), link.name)[1] for link in system.links}
    extent = max((float(np.linalg.norm(p)) for p in rest.values()), default=0.0)
    extent = max(
        [extent, *(link.beam.length if link.beam else float(np.linalg.norm(link.com)) for link in system.links)]
    )
    marks: list[tuple[str, Array]] = [(link.name, np.zeros(3)) for link in system.links]
    index = {link.name: k for k, link in enumerate(system.links)}
    edges = [(index[j.parent], index[j.child]) for j in system.joints if j.parent in index]
    parents = {j.parent for j in system.joints}
    for joint, link in zip(system.joints, system.links, strict=True):
        if link.beam is not None:
            tip = link.beam.length * np.asarray(link.beam.direction, dtype=np.float64)
        elif link.name in parents:
            continue
        else:
            tip = np.asarray(link.com, dtype=np.float64)
            if np.linalg.norm(tip) < ON_THE_JOINT:
                tip = SPOKE * (extent or 1.0) * _across(np.asarray(joint.axis, dtype=np.float64))
        edges.append((index[link.name], len(marks)))
        marks.append((link.name, tip))
    return Skeleton(system, tuple(marks), np.array(edges, dtype=np.intp).reshape(-1, 2))


def _across(axis: Array) -> Array:
    """A unit vector at right angles to an axis."""
    least = np.eye(3)[int(np.argmin(np.abs(axis)))]
    found = np.cross(axis, least)
    return np.asarray(found / np.linalg.norm(found))
