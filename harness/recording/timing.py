"""The time axis of a file made one that ascends, or refused."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.recording.magnitudes import check_span
from harness.recording.recording import QualityNote
from harness.system.description import Array

UNORDERED_SHARE = 0.05  # of the samples; more is no jitter but two recordings in one, or the wrong column
LATE_AT_MOST = 10  # samples that one at the beginning comes late by
COARSEST = 100  # samples between the first and the last tick of a rounded clock; in fewer their rate is not known to a per cent
REPEATED_SHARE = 0.1  # of the samples; more is a rounded clock
GAP_FACTOR = 5.0  # interval over the median one, and over twice the 99th percentile
SAME = 1e-9  # of the median interval; stamps closer than that are one
UNEVEN = 0.01  # relative deviation of an interval from the median one that is worth a word


@dataclass(frozen=True, eq=False)
class Timing:
    """The mended axis.

    time: [s] from the first sample, strictly ascending, shape (T,). start: of the file [s].
    groups: for every row of the file the sample it belongs to, −1 if it was left out, shape (rows,).
    """

    time: Array
    start: float
    groups: NDArray[np.intp]
    notes: tuple[QualityNote, ...]


def mend_time(stamps: Array, lines: tuple[int, ...] | None, source: Path) -> Timing:
    """Put time stamps [s] (rows,) in order, join repeated ones, and tell gaps and unevenness.

    Raises InputError for a clock that is reset, stands still, or is no clock.
    """
    notes: list[QualityNote] = []
    usable = np.isfinite(stamps)
    lost = int((~usable).sum())
    if lost:
        notes.append(QualityNote("missing", "time", f"{lost} rows have no time", "left out", lost))
    rows = np.flatnonzero(usable)
    if len(rows) < 2 or np.all(stamps[rows] == stamps[rows[0]]):
        raise InputError("time does not pass", mend="check the column and its unit", source=source, column="time")
    time = stamps[rows]
    check_span(time, rows, lines, source)
    steps = np.diff(time)
    if np.all(steps < 0.0):
        raise InputError(
            "time runs backwards throughout", mend="check the column, or reverse the rows", source=source, column="time"
        )
    backwards = np.flatnonzero(steps < 0.0)
    if len(backwards):
        rows, time = _order(rows, time, backwards, lines, source, notes)
    start = float(time[0])
    time = time - start
    time, groups = _join(rows, time, len(stamps), source, notes)
    _tell_spacing(time, notes)
    return Timing(time, start, groups, tuple(notes))


def _order(
    rows: NDArray[np.intp],
    time: Array,
    backwards: NDArray[np.intp],
    lines: tuple[int, ...] | None,
    source: Path,
    notes: list[QualityNote],
) -> tuple[NDArray[np.intp], Array]:
    forward = np.diff(time)
    usual = float(np.median(forward[forward > 0.0]))
    worst = int(backwards[np.argmin(forward[backwards])])
    back = -float(forward[worst])
    line = lines[int(rows[worst + 1])] if lines is not None else None
    # From far in back to the very first stamp is a new beginning, however short what came before was.
    anew = np.any((backwards >= LATE_AT_MOST) & (time[backwards + 1] <= time[0] + usual))
    if back > 50.0 * usual or len(backwards) > UNORDERED_SHARE * len(time) or anew:
        raise InputError(
            f"time jumps back by {back:g} s",
            mend="one recording a file; split it where the clock was reset",
            source=source,
            line=line,
            column="time",
        )
    order = np.argsort(time, kind="stable")
    at = time[backwards] - time.min()
    notes.append(
        QualityNote(
            "unordered_time",
            "time",
            f"{len(backwards)} samples are stamped earlier than the one before, by up to {back:.3g} s",
            "put in order of their stamps",
            len(backwards),
            tuple((float(t), float(t)) for t in at[:8]),
            back,
        )
    )
    return rows[order], time[order]


def _join(
    rows: NDArray[np.intp], time: Array, count: int, source: Path, notes: list[QualityNote]
) -> tuple[Array, NDArray[np.intp]]:
    """Samples with one stamp become one, unless the clock is merely rounded."""
    groups = np.full(count, -1, dtype=np.intp)
    steps = np.diff(time)
    if np.any(steps > 0.0):
        # Closer than any clock tells apart: rates of change there would be noise magnified, or overflow.
        for k in np.flatnonzero((steps > 0.0) & (steps < SAME * float(np.median(steps[steps > 0.0])))):
            time[k + 1] = time[k]
    repeated = np.diff(time) == 0.0
    share = float(repeated.mean())
    if share <= REPEATED_SHARE:
        unique, inverse = np.unique(time, return_inverse=True)
        groups[rows] = inverse
        if repeated.any():
            at = time[1:][repeated]
            notes.append(
                QualityNote(
                    "repeated_time",
                    "time",
                    f"{int(repeated.sum())} samples repeat the time of the one before",
                    "joined to one sample, the mean",
                    int(repeated.sum()),
                    tuple((float(t), float(t)) for t in at[:8]),
                )
            )
        return unique, groups
    # Many equal stamps: an even clock printed with too few digits leaves stamps within one such digit of a straight line.
    steps = np.diff(time)
    quantum = float(np.min(steps[steps > 0.0]))
    index = np.arange(len(time), dtype=np.float64)
    # Where the clock goes on is known to a sample, wherever in its digit it was begun and ended.
    ticks = np.flatnonzero(steps > 0.0)
    if len(ticks) < 3 or ticks[-1] - ticks[0] < COARSEST:
        raise InputError(
            f"time goes on {len(ticks)} times only, by {quantum:.3g} s, in {len(time)} samples",
            mend="export the time with more digits",
            source=source,
            column="time",
        )
    slope, intercept = np.polyfit(ticks + 0.5, time[ticks + 1], 1)
    even = intercept + slope * index
    if float(np.abs(even - time).max()) > 1.5 * quantum:
        raise InputError(
            f"{share:.0%} of the samples repeat the time of the one before, and not as a rounded clock would",
            mend="export the time with more digits",
            source=source,
            column="time",
        )
    groups[rows] = np.arange(len(time))
    notes.append(
        QualityNote(
            "rounded_time",
            "time",
            f"time is rounded to {quantum:.3g} s, so that {share:.0%} of the stamps repeat",
            f"even sampling at {1.0 / slope:.6g} Hz restored, every stamp within the rounding",
            int(repeated.sum()),
            size=quantum,
        )
    )
    return slope * index, groups


def _tell_spacing(time: Array, notes: list[QualityNote]) -> None:
    steps = np.diff(time)
    usual = float(np.median(steps))
    limit = GAP_FACTOR * max(usual, 2.0 * float(np.quantile(steps, 0.99)) / GAP_FACTOR)
    gaps = np.flatnonzero(steps > limit)
    if len(gaps):
        notes.append(
            QualityNote(
                "gap",
                "time",
                f"{len(gaps)} gap{'s' if len(gaps) > 1 else ''}, the longest {float(steps[gaps].max()):.4g} s "
                f"where {usual:.4g} s is usual",
                "left open; nothing is filled in",
                len(gaps),
                tuple((float(time[k]), float(time[k + 1])) for k in gaps[:16]),
                float(steps[gaps].max()),
            )
        )
    rest = np.delete(steps, gaps)
    spread = np.abs(rest - usual) > UNEVEN * usual
    if spread.mean() > 0.005:
        notes.append(
            QualityNote(
                "uneven_sampling",
                "time",
                f"intervals from {float(rest.min()):.4g} s to {float(rest.max()):.4g} s, median {usual:.4g} s",
                "used as stamped",
                int(spread.sum()),
                size=float(rest.std()),
            )
        )


def grouped_mean(values: Array, groups: NDArray[np.intp], samples: int) -> Array:
    """Values (rows,) averaged over the rows of each sample, nan where none has a number, shape (samples,)."""
    use = (groups >= 0) & np.isfinite(values)
    count = np.bincount(groups[use], minlength=samples)
    total = np.bincount(groups[use], weights=values[use], minlength=samples)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(count > 0, total / count, np.nan)
