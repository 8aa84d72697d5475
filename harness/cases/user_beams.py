"""What can be asked of a user's own flexible mechanism: its motion against finite elements."""

from __future__ import annotations

import math

from harness.cases.case import Check
from harness.cases.checks.deflection import Accuracy, DeflectionAgreement
from harness.system import Beam, System

ENOUGH = 5
# Periods of the slowest beam, clamped, that the run lasts, and steps in each: for the paper's strip 0.5 s and 50 µs.
_PERIODS, _STEPS, _SAMPLES = 4.5, 2200, 110


def beam_checks(system: System) -> tuple[Check, ...]:
    """Free motion from a bent pose, against ANCF beams, or against a floating frame where stiffening is off."""
    beams = [link.beam for link in system.links if link.beam is not None]
    if not beams:
        return ()
    stiffened = all(beam.geometric_stiffening for beam in beams)
    period = max(_period(beam) for beam in beams)
    # A step of finite elements takes time in proportion to the beams; many of them are watched for a shorter while.
    periods = _PERIODS / max(1.0, len(beams) / 2.0)
    own = max(beam.modes for beam in beams)
    certain = "eight elements on each beam are themselves certain to about 1 % of the peak"
    accuracies = [Accuracy(ENOUGH, 0.03, 2e-3, certain)] if own < ENOUGH else []
    accuracies.append(
        Accuracy(
            None,
            0.03 if own >= ENOUGH else 0.25,
            2e-3 if own >= ENOUGH else 2e-2,
            certain
            if own >= ENOUGH
            else f"what {own} mode{'s' * (own > 1)} on a beam leave out; more modes leave less",
        )
    )
    return (
        DeflectionAgreement(
            peer="exudyn_ancf" if stiffened else "exudyn_ffrf",
            accuracies=tuple(accuracies),
            position=tuple((name, 0.5 if k == 0 else 0.2) for k, name in enumerate(system.joint_names)),
            duration=periods * period,
            rate=_SAMPLES / period,
            step=period / _STEPS,
            elements=8 if stiffened else None,
            band=(2.0 / (periods * period), 0.4 * _SAMPLES / period),
        ),
    )


def _period(beam: Beam) -> float:
    """First period of the beam clamped at its root [s]; (β l)² = 3.516."""
    rate = math.sqrt(beam.bending_stiffness / (beam.mass + 4.0 * beam.payload) / beam.length**3)
    return 2.0 * math.pi / (3.516 * rate)
