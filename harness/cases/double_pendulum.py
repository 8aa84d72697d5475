"""A double pendulum: a regular swing of 10 s, and a chaotic one up to its measured horizon."""

import math

from harness.cases.case import Case
from harness.cases.checks import ChaoticAgreement, EnergyKept, FrequencyTruth, TrajectoryAgreement
from harness.cases.pendulums import GRAVITY, chain_of_bars
from harness.cases.users import state_checks
from harness.system import System

LENGTH = 0.30


def system() -> System:
    return chain_of_bars("double pendulum", ("shoulder", "elbow"), length=LENGTH)


def frequencies() -> tuple[float, float]:
    """ω² l/g = 3 ∓ 6/√7 for two equal uniform bars, from det(K − ω² M) = 0 in absolute angles."""
    slow, fast = (
        math.sqrt((3.0 + sign * 6.0 / math.sqrt(7.0)) * GRAVITY / LENGTH) / (2.0 * math.pi) for sign in (-1.0, 1.0)
    )
    return slow, fast


CASE = Case(
    name="double_pendulum",
    title="Double pendulum of two equal bars",
    source="det(K − ω² M) = 0: ω² l/g = 3 ∓ 6/√7",
    system=system,
    checks=(
        *state_checks(2),
        FrequencyTruth(
            values=frequencies(),
            allowed=1e-6,
            why="central differences of the acceleration in engines that have no linearization of their own",
        ),
        TrajectoryAgreement(
            allowed=1e-8,
            why="RK4 at 0.2 ms; swings of 17° stay regular",
            step=2e-4,
            position=(("shoulder", 0.3), ("elbow", -0.2)),
        ),
        ChaoticAgreement(position=(("shoulder", 2.0), ("elbow", 1.0)), duration=20.0, step=2e-4),
        EnergyKept(
            allowed=1e-7,
            why="adaptive integration at relative tolerance 1e-10 over 60 s",
            position=(("shoulder", 2.0), ("elbow", 1.0)),
        ),
    ),
    group="chaos",
    cost=12.0,
)
