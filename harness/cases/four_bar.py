"""Four-bar mechanisms: one against every engine, and rows of them through their singular positions."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import numpy as np

from harness.cases.case import NATIVE, Bench, Case, Row
from harness.cases.checks import EnergyKept, Measured
from harness.cases.checks.loop_motion import LoopMotion, LoopsKept
from harness.cases.checks.trajectory import initial_state
from harness.cases.loop_truths import four_bars_angle
from harness.cases.users import state_checks
from harness.compare.four_bars import four_bars, hinge, pin, rod
from harness.system import System
from harness.system.description import constant

SPEED = 1.0
DURATION = 10.0


def crank_rocker() -> System:
    """Crank 0.1 m, coupler 0.3 m, rocker 0.2 m on a base of 0.3 m: the crank goes right round (Grashof)."""
    joints = (
        hinge("crank", "base", "short"),
        hinge("pin", "short", "coupler", (0.1, 0.0, 0.0)),
        hinge("rocker", "base", "long", (0.3, 0.0, 0.0)),
    )
    links = (
        rod("short", 0.1, (0.1, 0.0, 0.0)),
        rod("coupler", 0.3, (0.3, 0.0, 0.0)),
        rod("long", 0.2, (0.0, 0.2, 0.0)),
    )
    loops = (pin("knee", ("coupler", (0.3, 0.0)), ("long", (0.0, 0.2))),)
    return System("crank-rocker", joints, links, gravity=constant([0.0, -9.81, 0.0]), loops=loops)


def closed_form(windows: int, bench: Bench) -> Iterable[Row]:
    """The first crank's angle over ten seconds, through a singular position twice a turn."""
    start = initial_state(bench.system, {"crank0": 0.0}, {"crank0": -SPEED})
    time = np.linspace(0.0, DURATION, 501)
    model = bench.native
    truth = four_bars_angle(windows, SPEED, time)
    steps = model.simulate(*start, time, method="rk4", step=5e-4)
    yield bench.row(
        "motion_in_steps",
        (NATIVE, "analytic"),
        float(np.abs(steps.position[:, steps.names.index("crank0")] + truth).max()),
        1e-9,
        unit="rad",
        why="RK4 at 0.5 ms; steps as long as that pass over singular positions",
        note="fixed steps",
        source="a pendulum of inertia (N+1)/3 + N that goes right round: Jacobi's amplitude function",
    )
    run = model.simulate(*start, time)
    yield bench.row(
        "motion",
        (NATIVE, "analytic"),
        float(np.abs(run.position[:, run.names.index("crank0")] + truth).max()),
        1e-4,
        unit="rad",
        why="ten seconds by steps that adapt, which beside a singular position see rounding divided by the distance to it",
        note=f"{truth[-1] / (2.0 * np.pi):.2f} turns, through a singular position (all rods in line) twice in each",
        source="a pendulum of inertia (N+1)/3 + N that goes right round: Jacobi's amplitude function",
    )
    energy = np.array([sum(model.energy(q, v)) for q, v in zip(run.position, run.velocity, strict=True)])
    largest = max(model.energy(q, v)[0] for q, v in zip(run.position, run.velocity, strict=True))
    yield bench.row(
        "energy_kept",
        (NATIVE, "analytic"),
        float(np.ptp(energy) / largest),
        1e-6,
        why="ten seconds by steps that adapt, which beside a singular position see rounding divided by the distance to it",
        source="conservation of energy",
    )


def _row(windows: int) -> Case:
    return Case(
        name=f"four_bar_{windows}_windows",
        title=f"{windows}-four-bar mechanism through its singular positions",
        source="González et al., Multibody Syst. Dyn. 16 (2006); closed form of a pendulum that goes right round",
        system=partial(four_bars, windows),
        checks=(
            Measured("motion", partial(closed_form, windows)),
            LoopsKept(position=(("crank0", 0.0),), velocity=(("crank0", -SPEED),)),
        ),
        group="loops",
        engines=("denoc",),
        cost=2.0 + 0.2 * windows,
    )


CASES = (
    Case(
        name="four_bar",
        title="A planar four-bar mechanism, crank and rocker",
        source="Pinocchio's constraint dynamics, MuJoCo's equality constraints, Exudyn's Lagrange multipliers",
        system=crank_rocker,
        checks=(
            *state_checks(3),
            LoopMotion(position=(("crank", 0.3),), velocity=(("crank", 5.0),)),
            LoopsKept(position=(("crank", 0.3),), velocity=(("crank", 5.0),)),
            EnergyKept(
                allowed=1e-8,
                why="adaptive integration at relative tolerance 1e-10",
                position=(("crank", 0.3),),
                velocity=(("crank", 5.0),),
                duration=10.0,
            ),
        ),
        group="loops",
        cost=15.0,
    ),
    _row(1),
    _row(5),
)
