"""A triple pendulum: regular when it swings a little, soon unpredictable when it swings a lot."""

from harness.cases.case import Case
from harness.cases.checks import ChaoticAgreement, EnergyKept, TrajectoryAgreement
from harness.cases.pendulums import chain_of_bars
from harness.cases.users import state_checks
from harness.system import System


def system() -> System:
    return chain_of_bars("triple pendulum", ("hip", "knee", "ankle"))


CASE = Case(
    name="triple_pendulum",
    title="Triple pendulum of three equal bars",
    source="agreement of independent engines; conservation of energy",
    system=system,
    checks=(
        *state_checks(3),
        TrajectoryAgreement(
            allowed=1e-8,
            why="RK4 at 0.2 ms; swings of 12° stay regular",
            step=2e-4,
            position=(("hip", 0.2), ("knee", -0.1), ("ankle", 0.1)),
        ),
        ChaoticAgreement(position=(("hip", 1.6), ("knee", 0.8), ("ankle", -0.5)), duration=12.0, step=2e-4),
        EnergyKept(
            allowed=1e-7,
            why="adaptive integration at relative tolerance 1e-10 over 60 s",
            position=(("hip", 1.6), ("knee", 0.8), ("ankle", -0.5)),
        ),
    ),
    group="chaos",
    cost=12.0,
)
