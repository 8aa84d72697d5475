"""Periods of a simple pendulum up to 170°, where the period is more than doubled."""

import math

from harness.cases.case import Case
from harness.cases.checks import PeriodTruth
from harness.cases.pendulums import GRAVITY, hinge
from harness.system import Link, System
from harness.system.description import constant


def system() -> System:
    """1 kg at the end of a massless rod of 1 m."""
    return System(
        "simple pendulum",
        (hinge("pivot", "base", "bob"),),
        (Link("bob", 1.0, constant([0.0, 0.0, -1.0])),),
        gravity=constant([0.0, 0.0, -GRAVITY]),
    )


CASE = Case(
    name="large_swings",
    title="Simple pendulum: periods at 30° to 170°",
    source="(2/π) K(sin(A/2)) = 1.0174087975, 1.0731820071, 1.1803405990, 1.3728805006, 1.7622037295, 2.4393627196",
    system=system,
    checks=(
        PeriodTruth(
            joint="pivot",
            small=2.0 * math.pi / math.sqrt(GRAVITY),
            amplitudes=(30.0, 60.0, 90.0, 120.0, 150.0, 170.0),
            allowed=1e-8,
            why="fixed-step engines integrate by RK4 at 1 ms: 1e-9 over two swings; passages found by cubic splines",
        ),
    ),
    cost=2.0,
)
