"""Bricard's mechanism: counted degrees of freedom say that it cannot move, and it does."""

from harness.cases.case import Bench, Case, Row
from harness.cases.checks import EnergyKept, Measured
from harness.cases.checks.loop_motion import LoopMotion, LoopsKept
from harness.cases.loop_mechanisms import bricard
from harness.cases.users import state_checks
from harness.system.closure import closed_position, usual_rank


def independent(bench: Bench) -> list[Row]:
    """Five tree joints, five conditions, of which four are independent: one degree of freedom is left."""
    found = usual_rank(bench.system, closed_position(bench.system))
    return [
        bench.row(
            "independent_conditions",
            ("denoc", "published"),
            abs(found - 4),
            0.0,
            why="a count",
            note=f"{found} of {sum(len(loop.conditions) for loop in bench.system.loops)}",
            source="one degree of freedom: IFToMM library of computational multibody problems, A03",
        )
    ]


CASE = Case(
    name="bricard",
    title="Bricard's over-constrained mechanism, falling from rest",
    source="IFToMM library of computational multibody problems, A03: energy is kept, one condition is redundant",
    system=bricard,
    checks=(
        *state_checks(5),
        Measured("independent_conditions", independent),
        LoopMotion(duration=1.0, mujoco=1e-6),
        LoopsKept(),
        EnergyKept(allowed=1e-8, why="adaptive integration at relative tolerance 1e-10", duration=10.0),
    ),
    group="loops",
    cost=15.0,
)
