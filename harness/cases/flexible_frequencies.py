"""Bending frequencies of one strip on every mount that has a closed form."""

from __future__ import annotations

from harness.cases.beams import LENGTH, cantilever, closed_form, flexible_pendulum, strip
from harness.cases.case import NATIVE, Case
from harness.cases.checks.beam_frequency import BeamFrequencyTruth
from harness.cases.flexible_pendulum import ANCF, ANCF_LEAVES, pinned_with_hub
from harness.cases.pendulums import HUB
from harness.system import System

BLEVINS = "R. D. Blevins, Formulas for Natural Frequency and Mode Shape (1979), table 8-1"
EXACT = "exact shapes and quadrature: rounding, and central differences in the linearization"


def _case(
    name: str,
    title: str,
    system: System,
    values: tuple[float, ...],
    source: str,
    peer: tuple[str, float, str] = ANCF_LEAVES,
) -> Case:
    return Case(
        name=name,
        title=title,
        source=source,
        system=lambda: system,
        checks=(BeamFrequencyTruth(values, 1e-6, EXACT, (peer,)),),
        group="flexible",
        engines=(NATIVE, ANCF),
        cost=0.5,
    )


def _cases() -> tuple[Case, ...]:
    plain = strip(modes=3)
    loaded = strip(modes=5, payload=strip().mass)
    hub_ratio = HUB / (plain.mass * LENGTH**2)
    return (
        _case(
            "frequencies_clamped_free",
            "Cantilever: 9.0598, 56.777, 158.98 Hz",
            cantilever(plain),
            tuple(closed_form(root, plain) for root in (1.875104068712, 4.694091132974, 7.854757438238)),
            f"{BLEVINS}: 1 + cos z cosh z = 0",
        ),
        _case(
            "frequencies_pinned_free",
            "Pinned-free strip: 39.728, 128.75 Hz",
            flexible_pendulum(plain, hub=0.0, gravity=0.0),
            tuple(closed_form(root, plain) for root in (3.926602312048, 7.068582745629)),
            f"{BLEVINS}: tan z = tanh z",
        ),
        _case(
            "frequencies_pinned_hub",
            "Strip pinned with hub inertia: 37.540, 103.08, 186.29 Hz",
            flexible_pendulum(plain, gravity=0.0),
            tuple(closed_form(root, plain) for root in pinned_with_hub(hub_ratio, 3)),
            "cos z sinh z - sin z cosh z = h z³ (1 + cos z cosh z)",
        ),
        _case(
            "frequencies_tip_mass",
            "Cantilever that carries its own mass at the tip",
            cantilever(loaded),
            tuple(closed_form(square**0.5, plain) for square in (1.557298, 16.25009, 50.89584, 105.1983, 179.2320)),
            "1 + cos z cosh z + z (cos z sinh z - sin z cosh z) = 0, (β l)² to seven digits",
            (
                ANCF,
                5e-4,
                "sixteen cables: the error grows as the fourth power of the wave number, 3e-4 in the fifth mode",
            ),
        ),
    )


CASES = _cases
