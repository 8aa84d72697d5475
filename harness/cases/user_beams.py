"""What can be asked of a user's own flexible mechanism: its motion against finite elements, and its rigid limit."""

from __future__ import annotations

import math
from dataclasses import replace

from harness.cases.case import Check
from harness.cases.checks.deflection import Accuracy, DeflectionAgreement
from harness.cases.checks.frozen import FrozenAgreement
from harness.system import Beam, System

ENOUGH = 5
# Periods of the slowest beam, clamped, that the run lasts, and steps in each: for the paper's strip 0.5 s and 50 µs.
_PERIODS, _STEPS, _SAMPLES = 4.5, 2200, 110


def comparable(system: System) -> tuple[System, str]:
    """The mechanism as finite elements can express it, and one sentence for what was left out (empty if nothing).

    Damping ratios of modes are the native engine's alone: a finite element has no modes to give them to.
    """
    damped = [link.name for link in system.links if link.beam is not None and any(link.beam.modal_damping)]
    for name in damped:
        link = system.link(name)
        if link.beam is not None:
            system = system.replace_link(replace(link, beam=replace(link.beam, modal_damping=())))
    return system, f"compared without the modal damping of {', '.join(damped)}" if damped else ""


def straight_checks(system: System) -> tuple[Check, ...]:
    """Flexible links held straight against engines of rigid bodies."""
    if not system.flexible:
        return ()
    allowed = 1e-12 if len(system.coordinate_names) <= 50 else 1e-11
    why = "the integrals of a straight beam are those of a slender rod: rounding of double precision"
    return tuple(FrozenAgreement(of, allowed, why) for of in ("inverse_dynamics", "mass_matrix", "bias", "gravity"))


def beam_checks(system: System, left_out: str = "") -> tuple[Check, ...]:
    """Free motion from a bent pose, against ANCF beams, or against a floating frame where stiffening is off.

    left_out: said beside the reason for what is allowed.
    """
    beams = [link.beam for link in system.links if link.beam is not None]
    if not beams:
        return ()
    stiffened = all(beam.geometric_stiffening for beam in beams)
    period = max(_period(beam) for beam in beams)
    # A step of finite elements takes time in proportion to the beams; many of them are watched for a shorter while.
    periods = _PERIODS / max(1.0, len(beams) / 2.0)
    own = max(beam.modes for beam in beams)
    remark = f"; {left_out}" if left_out else ""
    certain = "eight elements on each beam are themselves certain to about 1 % of the peak" + remark
    # Sampled shapes are as many as they are: there are no further ones to bring in.
    more = own < ENOUGH and all(beam.shapes != "samples" for beam in beams)
    accuracies = [Accuracy(ENOUGH, 0.03, 2e-3, certain)] if more else []
    accuracies.append(
        Accuracy(
            None,
            0.03 if own >= ENOUGH else 0.25,
            2e-3 if own >= ENOUGH else 2e-2,
            certain
            if own >= ENOUGH
            else f"what {own} mode{'s' * (own > 1)} on a beam leave out; more modes leave less{remark}",
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
