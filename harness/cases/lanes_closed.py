"""Loops in the lanes: a parallelogram, which swings as one pendulum does, and where a four-bar mechanism closes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.cases.four_bar import crank_rocker
from harness.compare.four_bars import hinge, pin, rod
from harness.denoc.lanes.model import LaneModel
from harness.engines.pendulum import swing
from harness.system import System
from harness.system.description import constant

LENGTH, COUPLER, MASS, G = 0.3, 0.5, 0.4, 9.81  # m, m, kg, m/s²
# Two rods about their ends, and the coupler, which never turns, at their lower ends; all three weights.
INERTIA = 2.0 * MASS * LENGTH**2 / 3.0 + MASS * LENGTH**2
MOMENT = 2.0 * MASS * G * LENGTH / 2.0 + MASS * G * LENGTH
START = 1.2  # rad
DAMPING = {"left": 0.01, "pin": 0.03, "right": 0.005}  # N·m·s
TIME = np.linspace(0.0, 4.0, 201)
WHY = "1e-11 a step, loops closed to rounding"


def system() -> System:
    """Two equal cranks that hang down and a coupler between them."""
    joints = (
        hinge("left", "base", "first"),
        hinge("pin", "first", "coupler", (0.0, -LENGTH, 0.0)),
        hinge("right", "base", "second", (COUPLER, 0.0, 0.0)),
    )
    links = (
        rod("first", MASS, (0.0, -LENGTH, 0.0)),
        rod("coupler", MASS, (COUPLER, 0.0, 0.0)),
        rod("second", MASS, (0.0, -LENGTH, 0.0)),
    )
    loops = (pin("knee", ("coupler", (COUPLER, 0.0)), ("second", (0.0, -LENGTH))),)
    return System("parallelogram", joints, links, gravity=constant([0.0, -G, 0.0]), loops=loops)


def motion(bench: Bench) -> Iterable[Row | Series]:
    """All three joints turn as the pendulum does, the coupler's the other way; damping of each counts by how far it turns."""
    model = LaneModel(replace(bench.system, leading=("left",)))
    free = swing(START, 0.0, float(np.sqrt(MOMENT / INERTIA)), TIME)[0]
    braked = solve_ivp(
        lambda t, y: [y[1], (-MOMENT * np.sin(y[0]) - sum(DAMPING.values()) * y[1]) / INERTIA],
        (0.0, TIME[-1]), [START, 0.0], "DOP853", t_eval=TIME, rtol=1e-12, atol=1e-13,
    ).y[0]  # fmt: skip
    for quantity, truth, slots, term in (
        ("lanes_loop_motion", free, {}, "loops"),
        ("lanes_loop_damping", braked, DAMPING, "damping"),
    ):
        row = model.row()
        for joint, value in slots.items():
            row[model.slot(joint, "damping")] = value
        start = np.array([START, -START, START])
        found = np.asarray(model.simulate(row, start, np.zeros(3), TIME)[0][0])
        apart = np.abs(found - np.stack([truth, -truth, truth], axis=1)).max(axis=0)
        worst = int(np.argmax(np.nan_to_num(apart, nan=np.inf)))
        yield bench.row(
            quantity,
            (NATIVE, "analytic"),
            float(apart[worst]),
            1e-8,
            unit="rad",
            why=WHY,
            about={"term": term, "signal": model.names[worst]},
            source="φ'' = −(W/I) sin φ − (c₁ + c₂ + c₃) φ'/I of two rods and what they carry",
        )


def states(bench: Bench) -> Iterable[Row | Series]:
    """Where coupler and rocker of a four-bar mechanism are at an angle of the crank, by the circles about their ends."""
    model = LaneModel(replace(crank_rocker(), leading=("crank",)))
    angles = np.linspace(-2.5, 2.5, 11)
    start = np.tile(np.append(model.placed, np.zeros(3)), (len(angles), 1))
    start[:, 0] = angles
    found = model.closed(np.tile(model.row(), (len(angles), 1)), start)[:, :3]
    coupler, rocker, base = 0.3, 0.2, np.array([0.3, 0.0])
    true = np.array([_by_circles(angle, coupler, rocker, base) for angle in angles])
    # The mechanism closes in two ways; it stays in the one that it is stated in.
    apart = np.abs(np.angle(np.exp(1j * (found[:, None] - true)))).max(axis=2).min(axis=1)
    yield bench.row(
        "lanes_states_closed",
        (NATIVE, "analytic"),
        float(apart.max()) if np.isfinite(found).all() else float("nan"),
        1e-10,
        unit="rad",
        why="Newton's steps until rounding is left",
        about={"term": "closed", "loop": "knee"},
        source="intersection of two circles",
    )


def _by_circles(angle: float, coupler: float, rocker: float, base: Array) -> Array:
    """Angles of crank, coupler and rocker, in both ways that the mechanism closes in, (2, 3)."""
    end = 0.1 * np.array([np.cos(angle), np.sin(angle)])
    apart = base - end
    far = float(np.linalg.norm(apart))
    along = (far**2 + coupler**2 - rocker**2) / (2.0 * far)
    across = np.sqrt(coupler**2 - along**2)
    both = []
    for side in (1.0, -1.0):
        knee = end + (along * apart + side * across * np.array([-apart[1], apart[0]])) / far
        turned = np.arctan2(*(knee - end)[::-1]) - angle
        # The rocker lies along y of its link.
        both.append([angle, turned, np.arctan2(*(knee - base)[::-1]) - 0.5 * np.pi])
    return np.array(both)


CASE = Case(
    name="lanes_closed",
    title="A parallelogram of four hinges, and where a four-bar mechanism closes, in the lanes",
    source="the pendulum that a parallelogram is, in Jacobi's functions; intersections of circles",
    system=system,
    checks=(Measured("lanes_loop_motion", motion), Measured("lanes_states_closed", states)),
    group="lanes",
    engines=(NATIVE,),
    cost=4.0,
)
