"""The physical pendulum of Project Chrono's validation of its revolute joint."""

from harness.cases.case import Case
from harness.cases.checks import PointTruth, TrajectoryAgreement
from harness.cases.pendulums import hinge
from harness.system import Link, System
from harness.system.description import constant


def system() -> System:
    """1 kg, centre of gravity 2 m from the hinge, 0.1 kg·m² about it, horizontal at zero."""
    return System(
        "Chrono pendulum",
        (hinge("pivot", "base", "body"),),
        (Link("body", 1.0, constant([2.0, 0.0, 0.0]), constant([[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])),),
        gravity=constant([0.0, 0.0, -9.80665]),
    )


CITES = "Project Chrono validation, revolute joint, physical pendulum from the horizontal, against ADAMS"

CASE = Case(
    name="chrono_pendulum",
    title="Physical pendulum as published by Project Chrono: where its centre of gravity is after 5 s",
    source=CITES,
    system=system,
    checks=(
        PointTruth(
            link="body",
            point=(2.0, 0.0, 0.0),
            time=5.0,
            where=(("x", -1.99968), ("z", -0.0355587)),
            allowed=1e-5,
            why="the published figures have six digits",
            cites=CITES,
        ),
        TrajectoryAgreement(allowed=1e-8, why="RK4 at 1 ms leaves less than 1e-9 rad over 10 s; the motion is regular"),
    ),
)
