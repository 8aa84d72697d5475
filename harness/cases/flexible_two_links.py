"""Two flexible links hinged end to end, against two ANCF beams."""

from __future__ import annotations

from harness.cases.beams import two_strips
from harness.cases.case import NATIVE, Case
from harness.cases.checks.deflection import Accuracy, DeflectionAgreement
from harness.cases.flexible_pendulum import hanging_frequencies
from harness.system import System


def system() -> System:
    return two_strips(5)


CASE = Case(
    name="two_flexible_links",
    title="Two flexible links falling, against two ANCF beams",
    source="J. Gerstmayr and H. Irschik, J. Sound Vib. 318 (2008) 461-487 (ANCF cable); no closed form",
    system=system,
    checks=(
        hanging_frequencies(0.02, 4, "sixteen cables on each beam leave 2e-5 of the fourth frequency"),
        DeflectionAgreement(
            peer="exudyn_ancf",
            position=(("shoulder", -1.0), ("elbow", -0.5)),
            duration=1.0,
            step=4e-5,
            accuracies=(
                Accuracy(5, 0.01, 3e-4, "sixteen cables on each beam at 40 µs are certain to about 0.3 % of the peak"),
            ),
            also_modes=(1, 2, 3),
        ),
    ),
    group="flexible",
    engines=(NATIVE, "exudyn_ancf"),
    cost=20.0,
)
