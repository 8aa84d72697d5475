"""Readings that begin anew at a constant step: an angle within one turn, a counter of sixteen bits, half turns behind a gear.

A joint is where it moves on to. Where a reading jumps against its motion by one and the same step, the step is the reading's: it is
taken off again, whatever its size. Jumps that are not beyond doubt are refused with what can be done.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_lsq_spline
from scipy.ndimage import median_filter

from harness.errors import InputError
from harness.recording.columns import unit_stated
from harness.recording.differences import white_noise
from harness.recording.recording import QualityNote
from harness.system.description import Array

TURN = 2.0 * np.pi
AROUND = 7  # steps whose median is the motion around a jump: fewer than half of them are jumps
LONG = 5  # samples on either side that say where the motion goes
DITHER, DITHERS = 3, 6  # samples between jumps to and fro, and how many of these no joint makes
WITHIN = 1.02  # of the modulus that readings span at most: noise at both ends
SHARE = 0.25  # of the modulus that the motion may take from one sample to the next to be beyond doubt
EQUAL = 0.03  # of the modulus by which jumps may differ, where the motion is not straight over a few samples
AGAINST = 0.75  # of the jumps that go against the motion; what jumps with it has moved
CLEAR = 12.0  # times the usual deviation of a step from those around it
MOST = 0.5  # of the steps that jump
REPEATED = 3  # jumps that make a rule where readings go beyond the modulus
MANY = 4  # jumps that no counter makes
GAP = 3.0  # times the usual interval from which a jump is one over a gap
SWINGS = 3.0  # moduli that a motion to and fro spans at most
FEWEST_FOR_SPLINE = 40  # samples: fewer say no more than their jumps do
KNOTS = 8  # samples from knot to knot of a spline that no motion worth recording goes faster than
SURE, APART = 4.0, 20.0  # standard deviations within which a modulus is a part of a turn, and that these then lie apart
STEPS = 8.0  # quantisation steps that a modulus has at least
ROUND = (
    100.0,
    180.0,
    200.0,
    360.0,
    400.0,
    1000.0,
    3600.0,
    4000.0,
    10000.0,
    36000.0,
)  # counts in use besides powers of two


@dataclass(frozen=True, eq=False)
class Fold:
    """A constant step that readings jump by.

    modulus, error: the step and how far it may be off at most [channel unit]; std: its standard deviation as all jumps together
    tell it. at: steps (from sample to sample) that jump. turns: +1 where the reading fell, −1 where it rose. bounded: whether all
    readings lie within one step.
    """

    modulus: float
    error: float
    std: float
    at: NDArray[np.intp]
    turns: NDArray[np.intp]
    bounded: bool


def unfold(
    name: str, unit: str, time: Array, values: Array, step: float, factor: float, source: Path, header: str = ""
) -> tuple[Array, tuple[QualityNote, ...]]:
    """Readings of a position made continuous where they jump by a constant step.

    time, values: shape (T,), values nan where missing. step: quantisation step. factor: SI over the file's numbers, in which
    moduli are round. header: the file's own, of what is mapped.
    Raises InputError where a jump could as well be motion: more than a quarter of the modulus from sample to
    sample, a jump over a gap, or one that is no fold, of more than half a turn.
    """
    present = np.flatnonzero(np.isfinite(values))
    reading, stamps = values[present], time[present]
    if len(reading) < 4 * AROUND:
        return values, ()
    fold = find_fold(stamps, reading, step)
    if fold is None:
        if unit == "rad":
            _refuse_jump(name, stamps, reading, factor, source, header)
        return values, ()
    modulus = round_modulus(fold, step, factor, unit)
    turn = unit == "rad" and abs(modulus - TURN) < 1e-9
    words = "a turn" if turn else f"{modulus:.4g} {unit}"
    turns = np.zeros(len(reading) - 1)
    turns[fold.at] = fold.turns
    across = _is_gap(stamps)
    turns[across] = -np.rint((np.diff(reading) - _around(stamps, reading))[across] / modulus)
    left = np.diff(reading) + modulus * turns
    # Within one step a motion can be told by parts of it only; beyond, by how it goes on.
    doubt = left if fold.bounded else left - _around(stamps, reading)
    _refuse_doubt(header or name, unit, stamps, doubt, modulus, words, source)
    whole = reading[0] + np.concatenate([[0.0], np.cumsum(left)])
    done = "made continuous"
    if turn:
        what, kind = f"{np.count_nonzero(turns)} jumps by a turn", "wrapped_angle"
    else:
        told = "" if abs(factor) == 1.0 else f" ({modulus / abs(factor):.6g} in the file)"
        what, kind = f"{np.count_nonzero(turns)} jumps by {words}{told}, where the reading begins anew", "folded"
        if float(np.ptp(whole)) < SWINGS * modulus:
            # Which of its rounds the reading began in is not told; a joint that swings does so around its zero.
            whole -= modulus * np.rint(np.median(whole) / modulus)
            done += "; of zeros a step apart the one nearest the middle of the motion"
    mended = values.copy()
    mended[present] = whole
    at = np.flatnonzero(turns)
    where = tuple((float(stamps[k]), float(stamps[k + 1])) for k in at[:16])
    return mended, (QualityNote(kind, name, what, done, len(at), where, modulus),)


def find_fold(time: Array, reading: Array, step: float) -> Fold | None:
    """The constant step by which readings (T,) jump against their motion, or None if there is no such step."""
    steps = np.diff(reading)
    span = float(np.ptp(reading))
    if span <= 0.0:
        return None
    off = np.where(_is_gap(time), 0.0, steps - _around(time, reading))
    far = np.flatnonzero((np.abs(steps) > 0.5 * span) & ~_is_gap(time))
    fold = _fold(time, reading, far, -np.sign(steps[far]).astype(np.intp), span, step)
    if fold is not None and span <= WITHIN * fold.modulus + step:
        return replace(fold, bounded=True)
    usual = 1.4826 * float(np.median(np.abs(off - np.median(off))))
    least = max(CLEAR * usual, STEPS * step, 1e-6 * span)
    clear = np.flatnonzero(np.abs(off) > least)
    if len(clear) > 0.2 * len(off):
        return None
    if not len(clear):
        return None
    rough = float(np.median(np.abs(off[clear])))
    times = -np.rint(off[clear] / rough).astype(np.intp)
    if not np.all(np.abs(times) == 1):
        return None
    fold = _fold(time, reading, clear, times, rough, step)
    # Were it less than twice what is told from noise, some of its jumps would be missed.
    return fold if fold is not None and len(fold.at) >= REPEATED and fold.modulus > 2.0 * least else None


def _around(time: Array, reading: Array) -> Array:
    """The motion that the steps around each let expect of it: one a turn of a wheel is expected as well as a thousand."""
    intervals = np.diff(time)
    return np.asarray(median_filter(np.diff(reading) / intervals, AROUND, mode="nearest") * intervals)


def _is_gap(time: Array) -> NDArray[np.bool_]:
    intervals = np.diff(time)
    return np.asarray(intervals > GAP * float(np.median(intervals)))


def _fold(
    time: Array, reading: Array, jumps: NDArray[np.intp], turns: NDArray[np.intp], rough: float, step: float
) -> Fold | None:
    """The fold that some steps make, if they jump by one size against the motion. rough: about that size."""
    if not len(jumps) or len(jumps) > MOST * (len(reading) - 1):
        return None
    steps = np.diff(reading)
    left = steps.copy()
    left[jumps] += rough * turns
    # The motion at a jump is that on either side of it, as far as these are no jumps themselves.
    motion = left / np.diff(time)
    jump = np.zeros(len(steps), dtype=bool)
    jump[jumps] = True
    sides = np.stack([np.concatenate([motion[:1], motion[:-1]]), np.concatenate([motion[1:], motion[-1:]])])
    known = ~np.stack([np.concatenate([[True], jump[:-1]]), np.concatenate([jump[1:], [True]])])
    count = known.sum(axis=0)
    beside = (sides * known).sum(axis=0) / np.maximum(count, 1) * np.diff(time)
    told = count[jumps] > 0
    if not told.any():
        return None
    sizes = (-(steps[jumps] - beside[jumps]) * turns)[told]
    modulus = float(np.median(sizes))
    left[jumps] += (modulus - rough) * turns
    whole = np.concatenate([[0.0], np.cumsum(left)])
    noise = white_noise(time, whole)
    noise = 0.0 if np.isnan(noise) else noise
    scatter = 1.4826 * float(np.median(np.abs(sizes - modulus)))
    if modulus < STEPS * step or modulus < CLEAR * noise:
        return None
    if float(np.max(np.abs(sizes - modulus))) > EQUAL * modulus + 6.0 * noise + 2.0 * step:
        return None
    if not _is_reading(jumps, turns, whole, noise, step):
        return None
    typical = 4.0 * max(scatter, 2.0 * noise, 0.5 * step) / np.sqrt(len(jumps))
    error = typical + float(np.max(np.abs(sizes - modulus)))
    modulus, std = _told_by_all(time, reading, jumps, turns, modulus, typical)
    return Fold(modulus, float(error), std, jumps, turns, False)


def _told_by_all(
    time: Array, reading: Array, jumps: NDArray[np.intp], turns: NDArray[np.intp], modulus: float, error: float
) -> tuple[float, float]:
    """The step that makes the readings smoothest, and its standard deviation: least squares beside a spline through the motion.

    Jump by jump noise enters each size twice and more, and every further round adds the error once more. As it was, within
    ``error``, where that gives something else: a jump may have been missed.
    """
    if len(reading) < FEWEST_FOR_SPLINE:
        return modulus, error
    rounds = np.concatenate([[0.0], np.cumsum(np.bincount(jumps, turns, minlength=len(reading) - 1))])
    knots = time[KNOTS:-KNOTS:KNOTS]
    knots = np.concatenate([[time[0]] * 4, knots, [time[-1]] * 4])
    rough = [signal - make_lsq_spline(time, signal, knots)(time) for signal in (reading, rounds)]
    told = float(rough[1] @ rough[1])
    found = -float(rough[0] @ rough[1]) / told if told > 0.0 else np.nan
    if not abs(found - modulus) <= error:
        return modulus, error
    left = rough[0] + found * rough[1]
    freedom = max(len(reading) - len(knots), 1)
    return found, float(np.sqrt(left @ left / freedom / told))


def _is_reading(jumps: NDArray[np.intp], turns: NDArray[np.intp], whole: Array, noise: float, step: float) -> bool:
    """Whether jumps are the reading's rather than the joint's, or single readings far off.

    whole: readings with the jumps taken off, (T,). A reading that begins anew jumps against its motion, a joint that is flung
    jumps with it; and no joint jumps to and fro and to again in a few samples, as noise makes a reading do at its end.
    """
    quick = (np.diff(jumps) <= DITHER) & (turns[1:] == -turns[:-1])
    if np.count_nonzero(quick) >= DITHERS and np.count_nonzero(quick) > 0.5 * len(jumps):
        return True
    lone = _lasting(jumps, turns)
    if not len(lone):
        return False
    goes = np.array(
        [np.mean(whole[k + 1 : k + 1 + LONG]) - np.mean(whole[max(k + 1 - LONG, 0) : k + 1]) for k in jumps[lone]]
    )
    return float(np.mean(goes * turns[lone] > 2.0 * noise + 0.5 * step)) >= AGAINST


def _lasting(jumps: NDArray[np.intp], turns: NDArray[np.intp]) -> NDArray[np.intp]:
    """Which jumps are not undone by the next sample: a single reading far off is an outlier, noise at the fold goes to and fro."""
    kept: list[int] = []
    for k in range(len(jumps)):
        if kept and jumps[k] == jumps[kept[-1]] + 1 and turns[k] == -turns[kept[-1]]:
            kept.pop()
        else:
            kept.append(k)
    return np.array(kept, dtype=np.intp)


def round_modulus(fold: Fold, step: float, factor: float, unit: str) -> float:
    """The modulus [channel unit] put onto a turn or its parts, a power of two or a round number of the file's within its error.

    step: quantisation step [channel unit]. factor: channel unit over the file's numbers.
    """
    scale = abs(factor)
    within = fold.error + 1.01 * min(step, scale)
    if unit == "rad":
        for part in (1.0, 2.0, 0.5, 0.25, 4.0):
            if abs(part * TURN - fold.modulus) <= min(within, 0.02 * fold.modulus):
                return part * TURN
    counts = [2.0**k for k in range(4, 33)]
    for base, choices in ((scale, counts), (step, counts), (scale, list(ROUND))):
        if base <= 0.0:
            continue
        near = min(choices, key=lambda choice: abs(choice * base - fold.modulus))
        if abs(near * base - fold.modulus) <= min(within, 0.02 * fold.modulus):
            return near * base
    if unit == "rad":
        # A turn of a sensor behind a gear of whole numbers, or half of one.
        parts = max(round(TURN / fold.modulus), 1)
        part, next_ = TURN / parts, TURN / (parts + 1)
        if abs(part - fold.modulus) <= SURE * fold.std + 1e-9 and part - next_ > APART * fold.std:
            return part
    return fold.modulus


def _refuse_doubt(name: str, unit: str, stamps: Array, left: Array, modulus: float, words: str, source: Path) -> None:
    kind = "angle is wrapped" if words == "a turn" else f"reading begins anew every {words}"
    safe = SHARE * modulus
    across = _is_gap(stamps)
    doubtful = np.flatnonzero((np.abs(left) > safe) & ~across)
    if len(doubtful):
        at = float(stamps[doubtful[0] + 1])
        raise InputError(
            f"the {kind}, and at {at:.4g} s it moves by {abs(left[doubtful[0]]):.3g} {unit} or {words} less that from one "
            "sample to the next",
            mend="sample faster or record the motion without jumps",
            source=source,
            column=name,
        )
    intervals = np.diff(stamps)
    speed = np.abs(left) / intervals
    near = np.maximum(np.concatenate([speed[:1], speed[:-1]]), np.concatenate([speed[1:], speed[-1:]]))
    blind = np.flatnonzero(across & (near * intervals > safe))
    if len(blind):
        raise InputError(
            f"the {kind}, and in the gap at {float(stamps[blind[0]]):.4g} s it may have gone round",
            mend="cut the recording at the gap or record the motion without jumps",
            source=source,
            column=name,
        )


def _refuse_jump(name: str, stamps: Array, reading: Array, factor: float, source: Path, header: str) -> None:
    """An angle that jumps by more than half a turn off the motion around it: one sample a turn of a wheel does not."""
    steps = np.diff(reading)
    jumps = np.flatnonzero(np.abs(steps - _around(stamps, reading)) > np.pi)
    jumps = jumps[_lasting(jumps, np.sign(steps[jumps]).astype(np.intp))]
    if not len(jumps):
        return
    if len(jumps) < MANY:
        mend = "a dropped sample or a reset counter; cut the recording there"
    elif abs(factor) == 1.0:
        mend = f"it does so {len(jumps)} times; if it is in degrees, {unit_stated(header, name, 'deg')}"
    else:
        mend = f"it does so {len(jumps)} times; are the column and its unit the right ones?"
    raise InputError(
        f"the angle jumps by {steps[jumps[0]]:.3g} rad at {float(stamps[jumps[0] + 1]):.4g} s, in a record that is not wrapped to "
        "one turn",
        mend=mend,
        source=source,
        column=header or name,
    )
