"""A chain of ten links, rigid and flexible in turn, against planar rigid bodies and ANCF beams."""

from __future__ import annotations

from harness.cases.beams import alternating_chain
from harness.cases.case import NATIVE, Case
from harness.cases.checks import EnergyKept
from harness.cases.checks.deflection import Accuracy, DeflectionAgreement
from harness.system import System

START = (("joint1", 0.3), ("joint2", 0.2))


def system() -> System:
    return alternating_chain(10, 3)


CASE = Case(
    name="ten_links_alternating",
    title="Ten links, rigid and flexible in turn",
    source="J. Gerstmayr and H. Irschik, J. Sound Vib. 318 (2008) 461-487 (ANCF cable); conservation of energy",
    system=system,
    checks=(
        DeflectionAgreement(
            peer="exudyn_ancf",
            position=START,
            duration=0.5,
            step=1e-4,
            elements=8,
            accuracies=(
                Accuracy(3, 0.02, 5e-4, "eight cables on each beam at 0.1 ms are certain to about 1 % of the peak"),
            ),
            also_modes=(1, 2),
        ),
        EnergyKept(
            allowed=1e-6, why="the integrator's tolerance over 10 s of undamped motion", position=START, duration=10.0
        ),
    ),
    group="flexible",
    engines=(NATIVE, "exudyn_ancf"),
    cost=12.0,
)
