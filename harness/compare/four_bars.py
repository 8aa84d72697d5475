"""Bodies and joints that closed mechanisms in the plane are made of, and the N-four-bar mechanism."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.system import Frame, Joint, JointType, Link, Loop, System
from harness.system.description import Array, constant

_UP = constant([0.0, 0.0, 1.0])
_STILL = constant(np.eye(3))


def hinge(name: str, parent: str, child: str, xyz: Sequence[float] = (0.0, 0.0, 0.0), axis: Array = _UP) -> Joint:
    """A revolute joint about z, or about ``axis``."""
    return Joint(name, JointType.REVOLUTE, parent, child, xyz=constant(xyz), axis=constant(axis))


def flat(name: str, mass: float, com: Sequence[float], inertia: float) -> Link:
    """A body that moves in the plane z = 0; inertia about its centre of mass [kg·m²]."""
    return Link(name, mass=mass, com=constant([*com, 0.0]), inertia=constant(np.diag([inertia, inertia, inertia])))


def rod(name: str, mass: float, end: Sequence[float]) -> Link:
    """A slender rod from the link's origin to ``end``."""
    along = np.asarray(end, dtype=np.float64)
    inertia = mass / 12.0 * (along @ along * np.eye(3) - np.outer(along, along))
    return Link(name, mass=mass, com=constant(along / 2.0), inertia=constant(inertia), end=constant(along))


def pin(name: str, first: tuple[str, Sequence[float]], second: tuple[str, Sequence[float]]) -> Loop:
    """Two points that coincide in the plane z = 0."""
    one, other = (Frame(link, constant([*place, 0.0]), _STILL) for link, place in (first, second))
    return Loop(name, one, other, ("x", "y"))


def four_bars(windows: int) -> System:
    """The N-four-bar mechanism: rods of 1 m and 1 kg, cranks upright at zero angle, in the plane x, y; gravity along −y.

    González, Dopico, Gutiérrez, Cuadrado, A benchmarking system for MBS simulation software, Multibody Syst. Dyn. 16 (2006).
    """
    joints, links, loops = [], [], []
    for k in range(windows + 1):
        joints.append(hinge(f"crank{k}", "base", f"rod{k}", (float(k), 0.0, 0.0)))
        links.append(rod(f"rod{k}", 1.0, (0.0, 1.0, 0.0)))
    for k in range(windows):
        joints.append(hinge(f"knee{k}", f"rod{k}", f"bar{k}", (0.0, 1.0, 0.0)))
        links.append(rod(f"bar{k}", 1.0, (1.0, 0.0, 0.0)))
        loops.append(pin(f"window{k}", (f"bar{k}", (1.0, 0.0)), (f"rod{k + 1}", (0.0, 1.0))))
    return System(
        f"{windows}-four-bar", tuple(joints), tuple(links), gravity=constant([0.0, -9.81, 0.0]), loops=tuple(loops)
    )
