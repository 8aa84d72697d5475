"""A fly-ball governor: steady at Watt's speed, and swinging about it against the Lagrangian of its two coordinates."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from harness.cases.case import NATIVE, Bench, Case, Row
from harness.cases.checks import Measured
from harness.cases.checks.loop_motion import LoopMotion, LoopsKept
from harness.cases.checks.trajectory import initial_state
from harness.cases.loop_mechanisms import governor
from harness.cases.loop_truths import governor_motion, governor_speed
from harness.cases.users import state_checks

ANGLE = 0.9
SPIN = 1.15 * governor_speed(ANGLE)
# Of the two ways to close it, a rhombus: with knees at zero the links lie on the arms and the sleeve does not move.
ARMS = (("left_arm", -ANGLE), ("right_arm", ANGLE), ("left_knee", 2.0 * ANGLE), ("right_knee", -2.0 * ANGLE))
SPUN = (("spindle", SPIN),)


def steady(bench: Bench) -> Iterable[Row]:
    """At Watt's speed nothing but the spindle moves; begun faster, arms and sleeve swing."""
    model = bench.models[NATIVE]
    q, qd = initial_state(bench.system, dict(ARMS), {"spindle": governor_speed(ANGLE)})
    moved = model.forward_dynamics(q, qd, np.zeros_like(qd))
    yield bench.row(
        "steady",
        (NATIVE, "analytic"),
        float(np.abs(moved).max() / governor_speed(ANGLE) ** 2),
        1e-12,
        why="rounding of double precision",
        note=f"accelerations over the speed squared, at {governor_speed(ANGLE):.6g} rad/s",
        source="ω² = g (M + m) / (m l sin β): Watt's governor with a sleeve",
    )
    time = np.linspace(0.0, 3.0, 301)
    start = initial_state(bench.system, dict(ARMS), dict(SPUN))
    run = model.simulate(*start, time)
    truth = governor_motion((0.0, ANGLE, SPIN, 0.0), time)
    arms = run.position[:, [run.names.index(name) for name in ("spindle", "right_arm")]]
    yield bench.row(
        "motion",
        (NATIVE, "analytic"),
        float(np.abs(arms - truth).max()),
        1e-7,
        unit="rad",
        why="three seconds at relative tolerance 1e-10",
        note=f"arms swing over {np.ptp(truth[:, 1]):.2f} rad",
        source="Lagrangian of spindle and arms alone, integrated to 1e-13",
    )


CASE = Case(
    name="fly_ball_governor",
    title="Fly-ball governor with a sleeve",
    source="Watt's governor in closed form; Lagrangian of its two coordinates",
    system=governor,
    checks=(
        *state_checks(6),
        Measured("motion", steady),
        # Exudyn 1.13's joints between links of a tree that slide on one that spins go another way: not asked.
        LoopMotion(position=ARMS, velocity=SPUN, mujoco=1e-6, exudyn=None),
        LoopsKept(position=ARMS, velocity=SPUN),
    ),
    group="loops",
    cost=15.0,
)
