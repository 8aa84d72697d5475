"""Where a point of the mechanism is at a given time, against a published figure."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from harness.cases.case import Array, Bench, Row, Series
from harness.cases.checks.trajectory import initial_state
from harness.errors import UnsupportedError
from harness.system import System


@dataclass(frozen=True)
class PointTruth:
    """Distance between the published and the simulated coordinates of a point fixed to a link.

    link, point: the link and the point in its frame [m]. time: when [s]. where: published coordinates [m] by axis
    (``x``, ``y``, ``z``). allowed [m]. position: initial position by coordinate name.
    """

    link: str
    point: tuple[float, float, float]
    time: float
    where: tuple[tuple[str, float], ...]
    allowed: float
    why: str
    cites: str
    position: tuple[tuple[str, float], ...] = ()
    quantity: str = "point"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        q0, qd0 = initial_state(bench.system, dict(self.position), {})
        time = np.linspace(0.0, self.time, 501)
        axes = ["xyz".index(axis) for axis, _ in self.where]
        published = np.array([value for _, value in self.where])
        for name, model in bench.models.items():
            try:
                run = model.simulate(q0, qd0, time, step=None)
            except UnsupportedError as error:
                yield bench.skipped(self.quantity, (name, "published"), str(error))
                continue
            order = [run.names.index(joint) for joint in bench.system.joint_names]
            found = position_of(bench.system, run.position[-1, order], self.link, np.array(self.point))[axes]
            yield bench.row(
                self.quantity,
                (name, "published"),
                float(np.abs(found - published).max()),
                self.allowed,
                unit="m",
                why=self.why,
                note="at t = {:g} s: {}".format(
                    self.time,
                    ", ".join(f"{axis} = {value:.7g}" for (axis, _), value in zip(self.where, found, strict=True)),
                ),
                source=self.cites,
            )


def position_of(system: System, q: Array, link: str, point: Array) -> Array:
    """Base coordinates [m] of a point fixed to a rigid link, from the definition of joints and frames alone."""
    values = dict(zip(system.joint_names, q, strict=True))
    poses: dict[str, tuple[Array, Array]] = {system.base: (np.eye(3), np.zeros(3))}
    for joint in system.joints:
        rotation, origin = poses[joint.parent]
        origin = origin + rotation @ joint.xyz
        rotation = rotation @ joint.rotation
        value = values.get(joint.name, 0.0)
        if joint.prismatic:
            origin = origin + rotation @ (joint.axis * value)
        elif joint.movable:
            rotation = rotation @ Rotation.from_rotvec(joint.axis * value).as_matrix()
        poses[joint.child] = (rotation, origin)
    rotation, origin = poses[link]
    return origin + rotation @ point
