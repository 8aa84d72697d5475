"""The force that a fit leaves out, as the recordings show it, and the one place where most of it lies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.criticism.constants import (
    FAR_OUT_SHARE,
    FAST_MOTION_SHARE,
    MIDDLE_SHARE,
    SLOW_MOTION_SHARE,
    TELLING_PLACE_RATIO,
)
from harness.diagnose.estimation.discrepancy import Discrepancy, covariance_at
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.outcome import Outcome
from harness.effects.scale import references
from harness.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LeftForce:
    """The force that a fit leaves out at one joint: at times of a recording [s], with the motion there.

    run: which recording; force: the likeliest given the residuals [N·m or N]; q, qd: position and velocity; all (G,).
    """

    joint: str
    run: int
    time: Array
    q: Array
    qd: Array
    force: Array


@dataclass(frozen=True)
class Place:
    """Where most of a left-out force lies: at which joint, in words, the share of its square there and of the time spent there."""

    joint: str
    where: str
    share: float
    of_time: float


def left_force(outcome: Outcome, fitted: Fit, force: Discrepancy) -> list[LeftForce]:
    """The likeliest course of the force given what a fit leaves (the mean of a Gaussian process given its response)."""
    seen = force.responses.probe.likelihood
    ((_, residuals),) = outcome.study.objective_under(seen, fitted).residuals([(fitted.x, fitted.states)])
    out = []
    for window, white in zip(fitted.windows, residuals, strict=True):
        residual = white / np.sqrt(force.louder)
        forced, motion = force.responses.of(window), force.responses.motion(window)
        if motion is None or not len(forced.knots):
            continue
        spread = covariance_at(forced.knots, np.array(force.sizes) / force.scale, force.memory)
        values, vectors = np.linalg.eigh(forced.r @ spread @ forced.r.T)
        own_axes = vectors.T @ (forced.q.T @ residual) / (1.0 + np.maximum(values, 0.0))
        # Residuals are prediction − measurement: what pushes the measurement is what the prediction lacks.
        course = -spread @ forced.r.T @ (vectors @ own_axes)
        # The motion is that of another fit, which may have more coordinates than this one, or fewer.
        each = zip(force.joints, force.responses.places, np.split(course, len(force.joints)), strict=True)
        for joint, k, own in each:
            size = force.scale * np.interp(motion.time, forced.knots, own)
            start = outcome.problem.runs[window.run].time[window.first]
            out.append(LeftForce(joint, window.run, motion.time + start, motion.q[:, k], motion.qd[:, k], size))
    return out


def place_of(system: System, recordings: Sequence[str], left: Sequence[LeftForce]) -> Place | None:
    """The one place that holds most of the force beyond its share of the time; None where it is spread evenly.

    recordings: their names, in the order of ``LeftForce.run``.
    """
    best: tuple[float, Place] | None = None
    joints = dict.fromkeys(part.joint for part in left)
    squares = {joint: sum(_square(p) for p in left if p.joint == joint) for joint in joints}
    natural = {j: max(float(references(system, j).torque), 1e-300) for j in joints}
    total = sum(squares[j] / natural[j] ** 2 for j in joints)
    for joint in joints:
        own = [p for p in left if p.joint == joint]
        at_joint = squares[joint] / natural[joint] ** 2 / max(total, 1e-300)
        for words, masks in _places(system, recordings, own):
            inside = sum(_square(p, m) for p, m in zip(own, masks, strict=True)) / max(squares[joint], 1e-300)
            time = sum(float(np.sum(m)) for m in masks) / max(sum(len(p.time) for p in own), 1)
            # Of all that is left, a place with less than its share of the time says where it does not lie.
            if time <= 0.0 or inside < TELLING_PLACE_RATIO * time or at_joint * inside < time:
                continue
            # Of places that hold more than their time, the one that holds most beyond it.
            worth = at_joint * (inside - time)
            if best is None or worth > best[0]:
                best = worth, Place(joint, words, at_joint * inside, time)
    return best[1] if best is not None else None


def _square(part: LeftForce, mask: NDArray[np.bool_] | None = None) -> float:
    step = float(np.median(np.diff(part.time))) if len(part.time) > 1 else 1.0
    own = part.force if mask is None else part.force[mask]
    return float(np.sum(own**2)) * step


def _places(
    system: System, recordings: Sequence[str], own: Sequence[LeftForce]
) -> Iterator[tuple[str, list[NDArray[np.bool_]]]]:
    """Places that have a name, each with where every part of the force is within it."""
    joint = system.joint(own[0].joint)
    unit = "m" if joint.prismatic else "rad"
    fast = max(float(np.max(np.abs(p.qd))) for p in own)
    low, high = min(float(np.min(p.q)) for p in own), max(float(np.max(p.q)) for p in own)
    centre, half = 0.5 * (low + high), 0.5 * (high - low)
    yield f"slower than {SLOW_MOTION_SHARE * fast:.2g} {unit}/s", [np.abs(p.qd) < SLOW_MOTION_SHARE * fast for p in own]
    yield f"faster than {FAST_MOTION_SHARE * fast:.2g} {unit}/s", [np.abs(p.qd) > FAST_MOTION_SHARE * fast for p in own]
    yield (
        f"between {centre - MIDDLE_SHARE * half:.2g} and {centre + MIDDLE_SHARE * half:.2g} {unit}",
        [np.abs(p.q - centre) < MIDDLE_SHARE * half for p in own],
    )
    yield f"below {centre - FAR_OUT_SHARE * half:.2g} {unit}", [p.q < centre - FAR_OUT_SHARE * half for p in own]
    yield f"above {centre + FAR_OUT_SHARE * half:.2g} {unit}", [p.q > centre + FAR_OUT_SHARE * half for p in own]
    yield "moving forwards", [p.qd > 0.0 for p in own]
    yield "moving backwards", [p.qd < 0.0 for p in own]
    runs = dict.fromkeys(p.run for p in own)
    for run in runs:
        end = max(float(p.time[-1]) for p in own if p.run == run)
        begin = min(float(p.time[0]) for p in own if p.run == run)
        third = (end - begin) / 3.0
        name = recordings[run]
        if len(runs) > 1:
            yield f"in {name}", [np.full(len(p.time), p.run == run) for p in own]
        yield f"before {begin + third:.2g} s of {name}", [(p.time < begin + third) & (p.run == run) for p in own]
        yield f"after {end - third:.2g} s of {name}", [(p.time > end - third) & (p.run == run) for p in own]
