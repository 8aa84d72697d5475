"""A slider-crank of rigid rods, against the equation of its one coordinate and three engines."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from harness.cases.case import NATIVE, Bench, Case, Row
from harness.cases.checks import EnergyKept, Measured
from harness.cases.checks.loop_motion import LoopMotion, LoopsKept
from harness.cases.checks.trajectory import initial_state
from harness.cases.loop_mechanisms import slider_crank
from harness.cases.loop_truths import slider_crank_angle
from harness.cases.users import state_checks

ANGLE, SPEED = 0.5, 12.0
TURNED, TURNING = (("crank", ANGLE),), (("crank", SPEED),)


def closed_form(bench: Bench) -> Iterable[Row]:
    """The crank's angle over five seconds."""
    time = np.linspace(0.0, 5.0, 501)
    start = initial_state(bench.system, {"crank": ANGLE}, {"crank": SPEED})
    run = bench.models[NATIVE].simulate(*start, time)
    yield bench.row(
        "motion",
        (NATIVE, "analytic"),
        float(np.abs(run.position[:, run.names.index("crank")] - slider_crank_angle((ANGLE, SPEED), time)).max()),
        1e-7,
        unit="rad",
        why="five seconds at relative tolerance 1e-10, nine turns",
        source="I(θ) θ̈ + ½ I′(θ) θ̇² + V′(θ) = 0 of the one coordinate, integrated to 1e-13",
    )


CASE = Case(
    name="slider_crank",
    title="Slider-crank of rigid rods",
    source="equation of motion of the one coordinate; Pinocchio, MuJoCo, Exudyn",
    system=slider_crank,
    checks=(
        *state_checks(3),
        Measured("motion", closed_form),
        LoopMotion(position=TURNED, velocity=TURNING),
        LoopsKept(position=TURNED, velocity=TURNING),
        EnergyKept(
            allowed=1e-8,
            why="adaptive integration at relative tolerance 1e-10",
            position=TURNED,
            velocity=TURNING,
            duration=10.0,
        ),
    ),
    group="loops",
    cost=15.0,
)
