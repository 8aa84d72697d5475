"""Each channel looked at by itself: missing samples, outliers, steps, plateaus at the extremes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from harness.errors import InputError
from harness.recording.differences import white_noise
from harness.recording.recording import QualityNote
from harness.system.description import Array

OUTLIER_SIGMAS = 8.0  # some eleven of the samples' own: a cubic through four neighbours errs more than a sample does
NEIGHBOURHOOD = 101  # samples that say how loud noise is around a sample
BESIDE = 1.5  # of such deviations that neighbours of an outlier may be off by themselves
LONE = 0.2  # of an outlier's distance: what its neighbours may be off; 0.3 at a corner on a sample
BURST = 25  # samples of a burst at most: a glitch of a bus or a dropped packet, and no motion
WILD = 0.7  # of the samples of a burst that are outliers by themselves
LEAP = 3.0  # times the fastest change from sample to sample elsewhere, by which a burst begins and ends
PLATEAU = 4  # equal samples in a row at an extreme
SHORT_GAP = 5  # samples of an effort that are filled by a straight line


def quantisation_step(values: Array) -> float:
    """Step that all values are whole multiples of (from each other), 0 if none can be seen.

    The step is the smallest distance between neighbouring levels, if all distances are whole multiples of it.
    Decimal digits of the file are a step as well; whether it matters is for the noise to say.
    """
    finite = values[np.isfinite(values)]
    levels = np.unique(finite)
    if len(levels) < 3 or len(levels) > 0.7 * len(finite):
        return 0.0
    gaps = np.diff(levels)
    # Printing leaves levels that differ in their last digit only; they are one level.
    tiny = 64 * np.finfo(np.float64).eps * float(np.abs(levels).max()) + 2e-7 * float(np.abs(levels).max())
    gaps = gaps[gaps > tiny]
    if len(gaps) < 2:
        return 0.0
    step = float(np.quantile(gaps, 0.02))
    # Refine: the mean of those gaps that are one step.
    step = float(gaps[gaps < 1.5 * step].mean())
    multiples = gaps / step
    if float(np.mean(np.abs(multiples - np.round(multiples)) < 0.1 + tiny / step)) < 0.95:
        return 0.0
    span = float(levels[-1] - levels[0])
    refined = span / round(span / step)
    return refined if abs(refined - step) < 0.1 * step else step


def find_saturation(name: str, time: Array, values: Array, step: float) -> QualityNote | None:
    """Plateaus at an extreme that the motion runs into with speed, unlike a turning point or a rest; or noise cut off flat."""
    present = np.flatnonzero(np.isfinite(values))
    signal, stamps = values[present], time[present]
    if len(signal) < 4 * PLATEAU or float(np.ptp(signal)) == 0.0:
        return None
    tolerance = 1e-9 * float(np.abs(signal).max())
    windows: list[tuple[float, float]] = []
    count, limits = 0, []
    for extreme in (float(signal.max()), float(signal.min())):
        runs = [run for run in runs_of(np.abs(signal - extreme) <= tolerance) if run[1] - run[0] >= PLATEAU]
        cut = [run for run in runs if _runs_into(signal, run, step)] or _noise_cut_off(
            stamps, signal, extreme, tolerance, step
        )
        if cut:
            limits.append(extreme)
            count += sum(last - first for first, last in cut)
            windows += [(float(stamps[first]), float(stamps[last - 1])) for first, last in cut]
    if not windows:
        return None
    words = " and ".join(f"{limit:.5g}" for limit in limits)
    return QualityNote(
        "saturation",
        name,
        f"the signal is cut off flat at {words}",
        "kept; sensor_saturation and end_stop are among the candidates",
        count,
        tuple(sorted(windows)[:16]),
        float(max(map(abs, limits))),
    )


def _noise_cut_off(time: Array, signal: Array, extreme: float, tolerance: float, step: float) -> list[tuple[int, int]]:
    """Where an extreme is read again and again between smaller readings: louder noise than its steps would else go beyond it."""
    if abs(extreme) <= tolerance or not white_noise(time, signal) > 2.0 * max(step, tolerance):
        return []
    runs = runs_of(np.abs(signal - extreme) <= tolerance)
    return runs if len(runs) >= PLATEAU and sum(last - first for first, last in runs) >= 2 * PLATEAU else []


def runs_of(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Stretches in which a mask is set, as (first, last + 1)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def _runs_into(signal: Array, run: tuple[int, int], step: float) -> bool:
    """Whether the slope at the plateau's edges, carried on into it, overshoots it by much more than a turning point.

    A parabola that turns within the plateau rises above its edges by slope · width / 4; a quantised one stays
    within a step of that. Both edges together: stamps that come late make either one look steep.
    """
    first, last = run
    width = last - first
    slopes = []
    if first >= PLATEAU:
        slopes.append(abs(signal[first - 1] - signal[first - PLATEAU]) / (PLATEAU - 1))
    if last + PLATEAU <= len(signal):
        slopes.append(abs(signal[last + PLATEAU - 1] - signal[last]) / (PLATEAU - 1))
    if not slopes:
        return False
    # Rounding alone makes a slope between two readings steeper by as much as a step.
    slope = sum(slopes) / len(slopes) - step / (PLATEAU - 1)
    return slope * width / 4.0 > max(4.0 * step, 1e-3 * float(np.ptp(signal)))


def find_outliers(name: str, time: Array, values: Array, step: float) -> tuple[Array, QualityNote | None]:
    """Single samples far off the line of their neighbours, set to nan.

    A sample is held against the cubic through two neighbours on either side. It is an outlier if its distance is beyond eight
    robust standard deviations of such distances around it, and its neighbours, held against theirs without it, are on their line:
    at a corner of the motion (a stop) they are not.
    """
    present = np.flatnonzero(np.isfinite(values))
    if len(present) < 32:
        return values, None
    x, t = values[present], time[present]
    index = np.arange(4, len(x) - 4)
    error = np.abs(x[index] - _predicted(t, x, index, index, (-2, -1, 1, 2)))
    # Where noise grows with speed, what is loud among quiet samples is not so among its own.
    scale = _loudness(x, error, step, median_filter(error, min(NEIGHBOURHOOD, len(error)), mode="nearest"))
    loud = error > OUTLIER_SIGMAS * scale
    far, scale = index[loud], scale[loud]
    size = np.abs(x[far] - _predicted(t, x, far, far, (-2, -1, 1, 2)))
    after = np.abs(x[far + 1] - _predicted(t, x, far, far + 1, (-2, -1, 2, 3)))
    before = np.abs(x[far - 1] - _predicted(t, x, far, far - 1, (-3, -2, 1, 2)))
    lone = np.maximum(after, before) < np.maximum(LONE * size, BESIDE * scale)
    where, size = far[lone], size[lone]
    if not len(where) or len(where) > 0.02 * len(x):
        return values, None
    mended = values.copy()
    mended[present[where]] = np.nan
    note = QualityNote(
        "outlier",
        name,
        f"{len(where)} single samples lie up to {float(size.max()):.3g} off the line of their neighbours",
        "left out",
        len(where),
        tuple((float(t[k]), float(t[k])) for k in where[:16]),
        float(size.max()),
    )
    return mended, note


def find_bursts(name: str, time: Array, values: Array, step: float) -> tuple[Array, QualityNote | None]:
    """Stretches of up to ``BURST`` samples far off the line of what is before and after them, set to nan.

    A reading that leaps off its line within a sample, stays far off it, and leaps back onto the same line within another one was
    no motion: a stop or an impact leaves another line behind. For positions and velocities; accelerations may do so.
    """
    present = np.flatnonzero(np.isfinite(values))
    if len(present) < 4 * BURST:
        return values, None
    x, t = values[present], time[present]
    change = np.abs(np.diff(x))
    index = np.arange(2, len(x) - 2)
    error = np.abs(x[index] - _predicted(t, x, index, index, (-2, -1, 1, 2)))
    far = OUTLIER_SIGMAS * float(_loudness(x, error, step))
    leaps = np.flatnonzero(change > LEAP * float(np.quantile(change, 0.98)) + far) + 1
    found: list[tuple[int, int]] = []
    for first in leaps.tolist():
        if first < (found[-1][1] if found else 4):
            continue
        ends = leaps[(leaps > first + 1) & (leaps <= min(first + BURST, len(x) - 4))].tolist()
        # The longest one: a burst leaps within as well.
        last = next((end for end in reversed(ends) if _is_burst(t, x, first, end, far)), None)
        if last is not None:
            found.append((first, last))
    count = sum(last - first for first, last in found)
    if not found or count > 0.02 * len(x):
        return values, None
    mended, size = values.copy(), 0.0
    for first, last in found:
        mended[present[first:last]] = np.nan
        size = max(size, float(_off_line(t, x, first, last).max()))
    return mended, QualityNote(
        "outlier",
        name,
        f"{count} samples in {len(found)} burst{'s' if len(found) > 1 else ''} lie up to {size:.3g} off the line of what is "
        "before and after",
        "left out",
        count,
        tuple((float(t[first]), float(t[last - 1])) for first, last in found[:16]),
        size,
    )


def _loudness(values: Array, error: Array, step: float, around: Array | float = 0.0) -> Array:
    """Robust standard deviation of distances from the line of neighbours; around: their median near each sample, if it is larger.

    What stands still has no noise, and does not count.
    """
    least = 1e-9 * float(np.ptp(values))
    usual = float(np.median(error[error > least])) if bool(np.any(error > least)) else 0.0
    return np.asarray(1.4826 * np.maximum(around, usual) + 0.5 * step + least)


def _is_burst(time: Array, values: Array, first: int, last: int, far: float) -> bool:
    """Whether most samples of a stretch are off the line of what is before and after it, and those right beside it are not."""
    beside = _off_line(time, values, first - 1, last + 1)[[0, -1]]
    return bool(np.all(beside < far) and np.mean(_off_line(time, values, first, last) > far) >= WILD)


def _off_line(time: Array, values: Array, first: int, last: int) -> Array:
    """Distances of the samples of a stretch from the cubic through the two before and the two after it."""
    nodes, inside = np.array([first - 2, first - 1, last, last + 1]), np.arange(first, last)
    line = np.polyfit(time[nodes] - time[first], values[nodes], 3)
    return np.asarray(np.abs(values[inside] - np.polyval(line, time[inside] - time[first])))


def _predicted(
    time: Array, values: Array, centre: NDArray[np.intp], target: NDArray[np.intp], nodes: tuple[int, ...]
) -> Array:
    """Value at the samples ``target`` of the polynomial through the samples ``centre`` + nodes."""
    total = np.zeros(len(centre))
    for j in nodes:
        weight = np.ones(len(centre))
        for k in nodes:
            if k != j:
                weight *= (time[target] - time[centre + k]) / (time[centre + j] - time[centre + k])
        total += weight * values[centre + j]
    return total


def fill_effort(
    name: str, time: Array, values: Array, source: Path, header: str = ""
) -> tuple[Array, QualityNote | None]:
    """An applied effort must be known at every sample: short holes are bridged by a straight line, long ones refused."""
    missing = ~np.isfinite(values)
    if not missing.any():
        return values, None
    longest = max(last - first for first, last in runs_of(missing))
    if longest > SHORT_GAP:
        raise InputError(
            f"the applied effort is missing for {longest} samples in a row",
            mend="an input must be known throughout; cut the recording there",
            source=source,
            column=header or name,
        )
    filled = values.copy()
    filled[missing] = np.interp(time[missing], time[~missing], values[~missing])
    count = int(missing.sum())
    return filled, QualityNote("missing", name, f"{count} samples are missing", "bridged by straight lines", count)
