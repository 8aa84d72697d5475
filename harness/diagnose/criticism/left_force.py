"""The force that a fit leaves out, as the recordings show it, and the one place where most of it lies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from harness.diagnose.criticism.constants import (
    FAR_OUT_SHARE,
    FAST_MOTION_SHARE,
    FEWEST_READ,
    FEWEST_TURNS,
    MIDDLE_SHARE,
    NARROW_SHARES,
    NARROW_STEP,
    NOISE_OF_REST,
    SLOW_MOTION_SHARE,
    TELLING_PLACE_RATIO,
    TELLING_PLACE_SHARE,
)
from harness.diagnose.estimation.discrepancy import Discrepancy, covariance_at, pieces_of
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.outcome import Outcome
from harness.effects.scale import references
from harness.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LeftForce:
    """The force that a fit leaves out at one joint: at times of a recording [s], with the motion there.

    run: which recording; force: the likeliest given the residuals [N·m or N]; q, qd: position and velocity, as recorded where the
    joint is; all (G,). memory: how long the force keeps [s].
    """

    joint: str
    run: int
    time: Array
    q: Array
    qd: Array
    force: Array
    memory: float = 0.0


@dataclass(frozen=True)
class Place:
    """Where most of a left-out force lies: at which joint, in words, the share of its square there and of the time spent there."""

    joint: str
    where: str
    share: float
    of_time: float


def left_force(outcome: Outcome, fitted: Fit, force: Discrepancy) -> list[LeftForce]:
    """The likeliest course of the force given what a fit leaves (the mean of a Gaussian process given its response).

    Initial states are as likely as they can be beside it: without the force they were fitted to what it did, and a blow at the
    beginning would put them right again.
    """
    out = []
    free = outcome.study.profiled_under(force.responses.probe.likelihood, fitted)
    for window, profile in zip(fitted.windows, free, strict=True):
        motion = force.responses.motion(window)
        found = pieces_of(force.responses, [window], [profile])
        if motion is None or not found:
            continue
        ((along, r, knots),) = ((piece.along, piece.r, piece.knots) for piece in found)
        spread = covariance_at(knots, np.array(force.sizes) / force.scale, force.memory)
        values, vectors = np.linalg.eigh(r @ spread @ r.T)
        own_axes = vectors.T @ along / np.sqrt(force.louder) / (1.0 + np.maximum(values, 0.0))
        # Residuals are prediction − measurement: what pushes the measurement is what the prediction lacks.
        course = -spread @ r.T @ (vectors @ own_axes)
        # The motion is that of another fit, which may have more coordinates than this one, or fewer.
        each = zip(force.joints, force.responses.places, np.split(course, len(force.joints)), strict=True)
        for joint, k, own in each:
            size = force.scale * np.interp(motion.time, knots, own)
            time = motion.time + outcome.problem.runs[window.run].time[window.first]
            # A model that lacks a force is soon elsewhere than the mechanism was, which the force has pushed.
            q, qd = recorded(outcome.problem, window, joint, time, force.memory) or (motion.q[:, k], motion.qd[:, k])
            out.append(LeftForce(joint, window.run, time, q, qd, size, force.memory))
    return out


def recorded(problem: Problem, window: Window, joint: str, time: Array, memory: float) -> tuple[Array, Array] | None:
    """Position and velocity (G,) of a joint by its own channel at times of the recording [s]; None where it has none.

    The velocity is the slope of straight lines as long as a force keeps, as nothing of it is known finer, and zero where noise
    makes such slopes.
    """
    channel = problem.position_of(joint)
    if channel is None:
        return None
    run = problem.runs[window.run]
    part = slice(window.first, window.last)
    read = np.isfinite(run.values[channel, part])
    if np.count_nonzero(read) < FEWEST_READ:
        return None
    when, what = run.time[part][read], run.values[channel, part][read]
    even = np.arange(when[0], when[-1] + 0.5 * run.interval, run.interval)
    length = min(2 * int(0.5 * memory / run.interval) + 1, len(even) - 1 + len(even) % 2)
    length = max(length, 3)
    slope = savgol_filter(np.interp(even, when, what), length, 1, deriv=1, delta=run.interval)
    noise = run.roughness[channel] / run.interval * np.sqrt(12.0 / (length * (length**2 - 1.0)))
    slope = np.where(np.abs(slope) > NOISE_OF_REST * noise, slope, 0.0)
    return np.interp(time, when, what), np.interp(time, even, slope)


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
        pieces = max(sum(_pieces(p) for p in own), 1.0)
        for words, masks, alike in _places(system, recordings, own):
            inside = sum(_square(p, m) for p, m in zip(own, masks, strict=True)) / max(squares[joint], 1e-300)
            time = sum(float(np.sum(m)) for m in masks) / max(sum(len(p.time) for p in own), 1)
            # Of all that is left, a place with less than its share of the time says where it does not lie.
            if time <= 0.0 or inside < TELLING_PLACE_RATIO * time or at_joint * inside < max(time, TELLING_PLACE_SHARE):
                continue
            # Of places that hold more than their time, the one that holds most beyond it: less what the best of so many alike
            # holds of a force without any place, whose square in independent pieces varies by twice its mean's square.
            chance = float(np.sqrt(2.0 * np.log(alike)) * np.sqrt(2.0 * time * (1.0 - time) / pieces))
            worth = at_joint * (inside - time - chance)
            if worth <= 0.0:
                continue
            if best is None or worth > best[0]:
                best = worth, Place(joint, words, at_joint * inside, time)
    return best[1] if best is not None else None


def _square(part: LeftForce, mask: NDArray[np.bool_] | None = None) -> float:
    step = float(np.median(np.diff(part.time))) if len(part.time) > 1 else 1.0
    own = part.force if mask is None else part.force[mask]
    return float(np.sum(own**2)) * step


def _pieces(part: LeftForce) -> float:
    """How many values of a force there are that do not hang together: an exponential memory τ leaves T / 2τ."""
    step = float(np.median(np.diff(part.time))) if len(part.time) > 1 else 1.0
    return len(part.time) * step / max(2.0 * part.memory, step)


def _places(
    system: System, recordings: Sequence[str], own: Sequence[LeftForce]
) -> Iterator[tuple[str, list[NDArray[np.bool_]], int]]:
    """Places that have a name, each with where every part of the force is within it and how many like it are looked at."""
    for words, masks in _wide_places(system, recordings, own):
        yield words, masks, 1
    for narrow in (list(_narrow_places(system, own)), list(_stretches_of_time(recordings, own))):
        for words, masks in narrow:
            yield words, masks, len(narrow)


def _stretches_of_time(
    recordings: Sequence[str], own: Sequence[LeftForce]
) -> Iterator[tuple[str, list[NDArray[np.bool_]]]]:
    """Of every recording what comes before a moment, after it, and between two: something that comes off, and that passes."""
    for run in dict.fromkeys(p.run for p in own):
        name = recordings[run]
        begin = min(float(p.time[0]) for p in own if p.run == run)
        span = max(float(p.time[-1]) for p in own if p.run == run) - begin
        if not span > 0.0:
            continue
        count = round(1.0 / NARROW_STEP)
        decimals = max(1 - int(np.floor(np.log10(span))), 0)
        moments = begin + span * NARROW_STEP * np.arange(1, count)
        said = [f"{round(float(t), decimals) + 0.0:.{decimals}f}" for t in moments]
        for k, moment in enumerate(moments):
            yield f"before {said[k]} s of {name}", [(p.time < moment) & (p.run == run) for p in own]
            yield f"after {said[k]} s of {name}", [(p.time >= moment) & (p.run == run) for p in own]
            for later in [k + round(share / NARROW_STEP) for share in NARROW_SHARES]:
                if later >= len(moments):
                    break
                within = [(p.time >= moment) & (p.time < moments[later]) & (p.run == run) for p in own]
                yield f"from {said[k]} to {said[later]} s of {name}", within


def _narrow_places(system: System, own: Sequence[LeftForce]) -> Iterator[tuple[str, list[NDArray[np.bool_]]]]:
    """Stretches of the joint's way, or of a turn of what turns many times over."""
    joint = system.joint(own[0].joint)
    unit = "m" if joint.prismatic else "rad"
    low, high = min(float(np.min(p.q)) for p in own), max(float(np.max(p.q)) for p in own)
    turning = not joint.prismatic and high - low > FEWEST_TURNS * 2.0 * np.pi
    way = 2.0 * np.pi if turning else high - low
    if not way > 0.0:
        return
    for share in NARROW_SHARES:
        width = share * way
        places = round((1.0 if turning else 1.0 - share) / NARROW_STEP) + (not turning)
        decimals = max(1 - int(np.floor(np.log10(width))), 0)
        for k in range(places):
            begin = k * NARROW_STEP * way + (0.0 if turning else low)
            first, last = (f"{round(end, decimals) + 0.0:.{decimals}f}" for end in (begin, begin + width))
            if turning:
                yield (
                    f"within {first} … {last} {unit} of every turn",
                    [np.mod(p.q - begin, 2.0 * np.pi) < width for p in own],
                )
                continue
            words = f"within {first} … {last} {unit}"
            if k == 0:
                words = f"below {last} {unit}"
            elif k == places - 1:
                words = f"above {first} {unit}"
            # The last one holds the end of the way whatever rounding leaves of it.
            yield words, [(p.q >= begin) & ((p.q <= begin + width) | (k == places - 1)) for p in own]


def _wide_places(
    system: System, recordings: Sequence[str], own: Sequence[LeftForce]
) -> Iterator[tuple[str, list[NDArray[np.bool_]]]]:
    """Halves and thirds: by speed, by place, by direction, and by the time of each recording."""
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
