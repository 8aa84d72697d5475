"""The paper's rigid pendulum with the damping found there, ξ = 1.9e-3 N·m·s: a swing's frequency depends on when."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from harness.cases.case import Bench, Case, Row, Series
from harness.cases.checks import Measured, TrajectoryAgreement
from harness.cases.checks.period import passages, period_ratio
from harness.cases.pendulums import paper_inertia, paper_pendulum, paper_restoring, paper_small_frequency
from harness.errors import UnsupportedError
from harness.system import System

DAMPING = 1.9e-3  # N·m·s, the paper's ξ


def system() -> System:
    return paper_pendulum(damping=DAMPING)


def decrement(bench: Bench) -> Iterable[Row | Series]:
    """Ratio of successive speeds through the bottom of a 0.5° swing against exp(-ξ T / 2J) of the linear oscillator."""
    decay = DAMPING / (2.0 * paper_inertia())
    circular = math.sqrt(paper_restoring() / paper_inertia() - decay**2)
    true = math.exp(-decay * 2.0 * math.pi / circular)
    time = np.linspace(0.0, 3.0, 3001)
    for name, model in bench.models.items():
        if name == "analytic":
            continue
        try:
            run = model.simulate(np.array([math.radians(0.5)]), np.zeros(1), time)
        except UnsupportedError as reason:
            yield bench.skipped("decrement", (name, "analytic"), str(reason))
            continue
        speed = passages(time, run.position[:, 0], run.velocity[:, 0])[:, 1]
        found = speed[2] / speed[0]
        yield bench.row(
            "decrement",
            (name, "analytic"),
            abs(found - true) / true,
            1e-5,
            why="the closed form is linear; at 0.5° the sine costs A²/16 = 5e-6",
            note=f"{found:.7f} against {true:.7f} a period",
            source="damped linear oscillator, logarithmic decrement δ = ξ T / 2J",
        )


def half_swings(bench: Bench) -> Iterable[Row | Series]:
    """Frequency of each half-swing against what the elliptic integral gives undamped at the amplitude there."""
    time = np.linspace(0.0, 10.0, 5001)
    small = paper_small_frequency()
    amplitude = np.linspace(1.0, 95.0, 150)
    yield Series(
        bench.case.name,
        "frequency_amplitude",
        "elliptic integral, undamped",
        tuple(amplitude.tolist()),
        tuple((small / np.array([period_ratio(a) for a in np.radians(amplitude)])).tolist()),
        "amplitude [°]",
        "frequency [Hz]",
        title=bench.case.title,
    )
    for name, model in bench.models.items():
        if name == "analytic":
            continue
        try:
            run = model.simulate(np.array([math.pi / 2.0]), np.zeros(1), time)
        except UnsupportedError as reason:
            yield bench.skipped("half_swing_frequency", (name, "analytic"), str(reason))
            continue
        at, speed = passages(time, run.position[:, 0], run.velocity[:, 0]).T
        frequency = 0.5 / np.diff(at)
        # The amplitude of a half-swing is that of the undamped one with the mean energy of its two passages.
        energy = 0.25 * paper_inertia() * (speed[1:] ** 2 + speed[:-1] ** 2)
        swing = np.arccos(np.clip(1.0 - energy / paper_restoring(), -1.0, 1.0))
        true = small / np.array([period_ratio(a) for a in swing])
        error = np.abs(frequency - true) / true
        yield bench.row(
            "half_swing_frequency",
            (name, "analytic"),
            float(error.max()),
            3e-3,
            why="the damping ratio (2 %) enters the period squared, and the amplitude changes within the half-swing",
            note=f"{frequency[0]:.3f} Hz in the first to {frequency[-1]:.3f} Hz in the last half-swing within 10 s",
            source="elliptic integral at the amplitude of each half-swing",
        )
        yield Series(
            bench.case.name,
            "frequency_amplitude",
            name,
            tuple(np.degrees(swing).tolist()),
            tuple(frequency.tolist()),
            "amplitude [°]",
            "frequency [Hz]",
            title=bench.case.title,
            style="points",
        )


CASE = Case(
    name="rigid_pendulum_damped",
    title="The paper's rigid pendulum with ξ = 1.9e-3 N·m·s: frequency of each half-swing against its amplitude",
    source="Section 5.1 of the paper: ξ = 1.9e-3 N·m·s identified from the decay",
    system=system,
    checks=(
        TrajectoryAgreement(
            allowed=1e-8,
            why="RK4 at 1 ms leaves 5e-10 rad over 10 s at this amplitude; the motion is regular",
            position=(("pivot", math.pi / 2.0),),
        ),
        Measured("decrement", decrement),
        Measured("half_swing_frequency", half_swings),
    ),
    cost=2.0,
)
