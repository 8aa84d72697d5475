"""Closed mechanisms of the suite, from published tables."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from harness.compare.four_bars import flat, hinge, pin, rod
from harness.system import Frame, Joint, JointType, Link, Loop, System
from harness.system.description import Array, constant
from harness.system.loop import REVOLUTE

_UP = constant([0.0, 0.0, 1.0])
_STILL = constant(np.eye(3))
_NOWHERE = constant(np.zeros(3))


# The seven-body mechanism of Andrews, table of Hairer and Wanner, Solving ODEs II, VII.7 [SI].
_MASS = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
_INERTIA = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
_A, _B, _C = (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
SQUEEZER_TORQUE = 0.033
SQUEEZER_START = (
    -0.0617138900142764496358948458001,
    0.0,
    0.455279819163070380255912382449,
    0.222668390165885884674473185609,
    0.487364979543842550225598953530,
    -0.222668390165885884674473185609,
    1.23054744454982119249735015568,
)
SQUEEZER_NAMES = ("beta", "theta", "gamma", "phi", "delta", "omega", "epsilon")


def squeezer() -> System:
    """Andrews' squeezing mechanism; its spring is a massless strut. Drawn up in the plane x, y, without gravity.

    A joint turns from where the table's angle is zero: axes of body k are turned by the angle (and by that of the body that it
    hangs on, where the table's angle is relative).
    """
    d, da, e, ea, rr, ra = 28e-3, 115e-4, 2e-2, 1421e-5, 7e-3, 92e-5
    ss, sa, sb, sc, sd = 35e-3, 1874e-5, 1043e-5, 18e-3, 2e-2
    ta, tb, u, ua, ub, zf, zt, fa = 2308e-5, 916e-5, 4e-2, 1228e-5, 449e-5, 2e-2, 4e-2, 1421e-5
    m, i = _MASS, _INERTIA
    joints = (
        hinge("beta", "base", "k1"),
        hinge("theta", "k1", "k2", (rr, 0.0, 0.0)),
        hinge("gamma", "base", "k3", (*_B, 0.0)),
        hinge("delta", "base", "k5", (*_A, 0.0)),
        hinge("phi", "k5", "k4", (zt, 0.0, 0.0)),
        hinge("epsilon", "base", "k7", (*_A, 0.0)),
        hinge("omega", "k7", "k6", (0.0, -u, 0.0)),
        hinge("strut", "base", "tube", (*_C, 0.0)),
        Joint(
            "spring",
            JointType.PRISMATIC,
            "tube",
            "piston",
            axis=constant([1, 0, 0]),
            stiffness=4530.0,
            rest_position=0.07785,
        ),
    )
    links = (
        flat("k1", m[0], (ra, 0.0), i[0]),
        flat("k2", m[1], (-da, 0.0), i[1]),
        flat("k3", m[2], (sa, sb), i[2]),
        flat("k5", m[4], (ta, tb), i[4]),
        flat("k4", m[3], (0.0, -(e - ea)), i[3]),
        flat("k7", m[6], (ua, ub), i[6]),
        flat("k6", m[5], (zf - fa, 0.0), i[5]),
        Link("tube"),
        Link("piston"),
    )
    knee = ("k2", (-d, 0.0))
    loops = (
        pin("knee_k3", knee, ("k3", (0.0, -ss))),
        pin("knee_k4", knee, ("k4", (0.0, -e))),
        pin("knee_k6", knee, ("k6", (zf, 0.0))),
        pin("spring_end", ("k3", (sd, -sc)), ("piston", (0.0, 0.0))),
    )
    return System("Andrews' squeezing mechanism", joints, links, gravity=_NOWHERE, loops=loops)


def squeezer_start(names: Sequence[str]) -> Array:
    """Published initial positions, the strut's where its end is on body 3, by ``names`` of the coordinates."""
    at = dict(zip(SQUEEZER_NAMES, SQUEEZER_START, strict=True))
    gamma, sc, sd = at["gamma"], 18e-3, 2e-2
    x = sd * math.cos(gamma) + sc * math.sin(gamma) + _B[0] - _C[0]
    y = sd * math.sin(gamma) - sc * math.cos(gamma) + _B[1] - _C[1]
    at |= {"strut": math.atan2(y, x), "spring": math.hypot(x, y)}
    return np.array([at[name] for name in names])


def bricard() -> System:
    """Bricard's mechanism: five rods of 1 m and 1 kg along edges of a cube, six revolute joints, over-constrained.

    Benchmark A03 of the IFToMM library of computational multibody problems; gravity along −y.
    """
    # Points of the cube, and the axes of the six joints; the first and the last are on the base.
    points = np.array([[0, 0, 0], [1, 0, 0], [1, -1, 0], [1, -1, 1], [0, -1, 1], [0, 0, 1]], dtype=np.float64)
    axes = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 0]], dtype=np.float64)
    joints, links = [], []
    parent, where = "base", points[0]
    for k in range(5):
        along = points[k + 1] - points[k]
        joints.append(hinge(f"joint{k + 1}", parent, f"rod{k + 1}", tuple(where), axis=axes[k]))
        links.append(rod(f"rod{k + 1}", 1.0, tuple(along)))
        parent, where = f"rod{k + 1}", along
    end = Frame("rod5", constant(points[5] - points[4]), _STILL)
    loop = Loop("joint6", Frame("base", constant(points[5]), _STILL), end, REVOLUTE["rx"])
    return System(
        "Bricard's mechanism", tuple(joints), tuple(links), gravity=constant([0.0, -9.81, 0.0]), loops=(loop,)
    )


def slider_crank(crank: float = 0.1, connecting: float = 0.3) -> System:
    """A crank, a connecting rod, both slender, and a slider on the x axis; gravity along −y."""
    joints = (
        hinge("crank", "base", "crank_rod"),
        hinge("pin", "crank_rod", "connecting_rod", (crank, 0.0, 0.0)),
        Joint("slider", JointType.PRISMATIC, "base", "piston", axis=constant([1, 0, 0])),
    )
    links = (
        rod("crank_rod", 0.2, (crank, 0.0, 0.0)),
        rod("connecting_rod", 0.5, (connecting, 0.0, 0.0)),
        flat("piston", 0.3, (0.0, 0.0), 1e-4),
    )
    loops = (pin("wrist", ("piston", (0.0, 0.0)), ("connecting_rod", (connecting, 0.0))),)
    return System("slider-crank", joints, links, gravity=constant([0.0, -9.81, 0.0]), loops=loops)


def governor() -> System:
    """A fly-ball governor: a spindle about z, two arms with balls on a yoke, links from the arms to a sleeve; gravity along −z.

    Arms of 0.3 m hang from the spindle's axis, links of equal length close a rhombus to the sleeve, so that its height is twice the
    arm's: Watt's governor with the closed form of ``fly_ball_governor``.
    """
    length = 0.3
    y = constant([0.0, 1.0, 0.0])
    joints, links, loops = (
        [hinge("spindle", "base", "shaft")],
        [Link("shaft", 0.5, inertia=constant(np.diag([2e-3] * 3)))],
        [],
    )
    joints.append(Joint("sleeve", JointType.PRISMATIC, "shaft", "collar", axis=_UP))
    links.append(Link("collar", 0.4, inertia=constant(np.diag([1e-3] * 3))))
    for side, sign in (("left", -1.0), ("right", 1.0)):
        joints.append(hinge(f"{side}_arm", "shaft", f"{side}_rod", axis=y))
        # A ball at the knee of the rhombus; arm and link have no mass but theirs.
        links.append(
            Link(f"{side}_rod", 0.25, com=constant([sign * length, 0.0, 0.0]), inertia=constant(np.diag([1e-4] * 3)))
        )
        joints.append(hinge(f"{side}_knee", f"{side}_rod", f"{side}_link", (sign * length, 0.0, 0.0), axis=y))
        links.append(Link(f"{side}_link", 0.01, inertia=constant(np.diag([1e-5] * 3))))
        foot = Frame(f"{side}_link", constant([-sign * length, 0.0, 0.0]), _STILL)
        loops.append(Loop(f"{side}_foot", Frame("collar", _NOWHERE, _STILL), foot, ("x", "z")))
    return System("fly-ball governor", tuple(joints), tuple(links), loops=tuple(loops))
