"""Andrews' squeezing mechanism: seven bodies, three loops and a spring, driven through seventeen turns in 0.03 s."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from harness.cases.case import NATIVE, Bench, Case, Row
from harness.cases.checks import Measured
from harness.cases.loop_mechanisms import SQUEEZER_NAMES, SQUEEZER_TORQUE, squeezer, squeezer_start

# Test set for IVP solvers (Mazzia, Magherini), Andrews' squeezing mechanism, reference solution at 0.03 s.
PUBLISHED = (
    15.81077119629904,
    -15.75637105984298,
    0.04082224013073101,
    -0.5347301163226948,
    0.5244099658805304,
    0.5347301163226948,
    1.048080741042263,
)
# Accelerations of beta and theta in the published initial state, of all others zero (Hairer and Wanner, VII.7) [rad/s²].
BEGINNING = (14222.4439199541138705911625887, -10666.8329399655854029433719415)


def motion(bench: Bench) -> Iterable[Row]:
    """The end of the run, and the accelerations at its beginning."""
    model = bench.native
    start, still = squeezer_start(model.position_names), np.zeros(model.n)
    torque = np.zeros(model.n)
    torque[model.names.index("beta")] = SQUEEZER_TORQUE
    places = [model.names.index(name) for name in SQUEEZER_NAMES]
    first = model.forward_dynamics(start, still, torque)[places]
    yield bench.row(
        "acceleration",
        (NATIVE, "published"),
        float(np.abs(first - np.array([*BEGINNING, 0.0, 0.0, 0.0, 0.0, 0.0])).max() / BEGINNING[0]),
        1e-12,
        why="thirty published digits against rounding of double precision",
    )
    run = model.simulate(start, still, np.array([0.0, 0.03]), tau=torque, rtol=1e-12, atol=1e-14)
    yield bench.row(
        "positions_at_end",
        (NATIVE, "published"),
        float(np.abs(run.position[-1, places] - np.array(PUBLISHED)).max()),
        1e-8,
        unit="rad",
        why="the published solution has 14 digits and was made with a tolerance of its own",
        note="at t = 0.03 s, beta and theta beyond fifteen radians; the spring is a massless strut in a fourth loop",
    )


CASE = Case(
    name="andrews_squeezer",
    title="Andrews' squeezing mechanism",
    source="Test set for IVP solvers, Andrews' squeezing mechanism, reference solution; Hairer & Wanner, Solving ODEs II, VII.7",
    system=squeezer,
    checks=(Measured("positions_at_end", motion),),
    group="loops",
    engines=("denoc",),
    cost=6.0,
)
