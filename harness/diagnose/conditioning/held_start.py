"""Recordings that begin before a hand, or a catch, has let go, each at a time of its own.

A delay that all recordings share may be a sensor's (``sensor_delay``, ``late_release``) and is left to the fit. Where recordings
stand still for different times, no law of the mechanism or of a sensor says when each one begins to move, and what would have to
explain it is an invention.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from harness.diagnose.conditioning.constants import (
    BEGUN_EXTENT,
    FALL_EXTENT,
    FEWEST_HELD_SAMPLES,
    FEWEST_REMAINING_SAMPLES,
    HOLD_EVIDENCE,
    MOVEMENT_SIGMAS,
    RELEASES_APART_FALL,
    RELEASES_APART_SIGMAS,
    STILL_SCATTER,
)
from harness.recording.clean import quantisation_step
from harness.recording.differences import white_noise
from harness.recording.recording import Channel, QualityNote, Recording

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Hold:
    """A joint stands still until ``time`` [s from the first sample], known to ``std`` [s]; fall: how long it falls [s]."""

    time: float
    std: float
    fall: float
    joint: str


def hold(recording: Recording) -> Hold | None:
    """How long all joints of a free recording stand still before the first one falls from rest, or None."""
    channels = [c for c in recording.channels if c.quantity == "position"]
    found = [h for h in (_hold(recording.time, c) for c in channels) if h is not None]
    if not found:
        return None
    first = min(found, key=lambda h: h.time)
    before = recording.time < first.time
    still = all(_stands_still(recording.time, c, before) for c in channels)
    return first if still else None


def released(recordings: Sequence[Recording]) -> list[Recording]:
    """Recordings without what is held at their beginnings, if they are held for different times; a quality note tells.

    Driven recordings are left alone, and with one of them all others: what is pushed may stand still by itself.
    """
    if len(recordings) < 2 or any(np.any(effort.values != 0.0) for r in recordings for effort in r.efforts):
        return list(recordings)
    holds = [hold(recording) for recording in recordings]
    if all(h is None for h in holds):
        return list(recordings)
    latest = max((h for h in holds if h is not None), key=lambda h: h.time)
    earliest = min(
        (h or Hold(_begun(r), 0.0, 0.0, "") for r, h in zip(recordings, holds, strict=True)), key=lambda h: h.time
    )
    interval = max(recording.interval for recording in recordings)
    one_delay = max(
        RELEASES_APART_SIGMAS * float(np.hypot(earliest.std, latest.std)),
        RELEASES_APART_FALL * max(earliest.fall, latest.fall),
        3.0 * interval,
    )
    if latest.time - earliest.time < one_delay:
        return list(recordings)
    return [r if h is None else _without(r, h) for r, h in zip(recordings, holds, strict=True)]


def _without(recording: Recording, held: Hold) -> Recording:
    keep = recording.time > held.time + 3.0 * held.std
    if np.count_nonzero(keep) < FEWEST_REMAINING_SAMPLES:
        return recording
    note = QualityNote(
        "held_start",
        held.joint,
        f"stands still for {held.time:.3g} s and falls from rest then, other recordings at other times: a hand or a catch lets go",
        "left out",
        where=((0.0, held.time),),
        size=held.time,
    )
    return recording.only(keep, note)


def _begun(recording: Recording) -> float:
    """Time by which a joint has certainly moved [s]; infinite if none has."""
    begun = [np.inf]
    for channel in recording.channels:
        good = np.isfinite(channel.values)
        values, time = channel.values[good], recording.time[good]
        if channel.quantity == "position" and len(values) > FEWEST_HELD_SAMPLES:
            place = _first(np.abs(values - np.median(values[:3])) > MOVEMENT_SIGMAS * _noise(time, values))
            begun.append(float(time[place]) if place < len(time) else np.inf)
    return min(begun)


def _noise(time: Array, values: Array) -> float:
    """Standard deviation of a channel's noise, rounding included."""
    return float(np.hypot(white_noise(time, values), quantisation_step(values) / np.sqrt(12.0)))


def _stands_still(time: Array, channel: Channel, before: NDArray[np.bool_]) -> bool:
    good = np.isfinite(channel.values)
    values = channel.values[good & before]
    if len(values) < FEWEST_HELD_SAMPLES:
        return False
    extent = float(np.ptp(channel.values[good]))
    return float(np.std(values)) < STILL_SCATTER * max(_noise(time[good], channel.values[good]), 1e-6 * extent)


def _hold(time: Array, channel: Channel) -> Hold | None:
    """The hold that one channel shows: constant, then c + a/2 (t − t₀)² + b (t − t₀)⁴, better than any smooth motion from the
    first sample on."""
    good = np.isfinite(channel.values)
    t, y = time[good], channel.values[good]
    if len(y) < 4 * FEWEST_HELD_SAMPLES:
        return None
    extent = float(np.ptp(y))
    noise = max(_noise(t, y), 1e-6 * extent)
    away = np.abs(y - np.median(y[:FEWEST_HELD_SAMPLES]))
    moved = _first(away > max(MOVEMENT_SIGMAS * noise, BEGUN_EXTENT * extent))
    end = _first(away > max(2.0 * MOVEMENT_SIGMAS * noise, FALL_EXTENT * extent))
    if moved < FEWEST_HELD_SAMPLES or end >= len(y) or end < moved + FEWEST_HELD_SAMPLES // 2:
        return None
    # As much of what is held as of the fall is enough, and a wandering sensor does less harm there.
    begin = max(0, moved - 10 * (end - moved) - FEWEST_HELD_SAMPLES)
    t, y = t[begin:end], y[begin:end]

    def fall(release: float) -> Array:
        since = np.maximum(t - release, 0.0) / (t[-1] - t[0])
        return np.stack([np.ones_like(t), since**2, since**4], axis=1)

    def rest(release: float) -> float:
        basis = fall(release)
        return float(np.sum((y - basis @ np.linalg.lstsq(basis, y, rcond=None)[0]) ** 2))

    last = int(moved - begin)
    tried = np.linspace(t[0], t[last], 60)
    best = int(np.argmin([rest(release) for release in tried]))
    around = tried[max(best - 1, 0)], tried[min(best + 1, len(tried) - 1)]
    release = float(minimize_scalar(rest, bounds=around, method="bounded").x)
    if np.count_nonzero(t < release) < FEWEST_HELD_SAMPLES:
        return None
    smooth = np.vander((t - t[0]) / (t[-1] - t[0]), 6)
    left = float(np.sum((y - smooth @ np.linalg.lstsq(smooth, y, rcond=None)[0]) ** 2))
    floor = noise**2 * len(t)
    if len(t) * np.log(max(left, 1e-3 * floor) / max(rest(release), 1e-3 * floor)) < HOLD_EVIDENCE:
        return None
    basis = fall(release)
    size = np.linalg.lstsq(basis, y, rcond=None)[0]
    slope = (fall(release + 1e-6) - fall(release - 1e-6)) @ size / 2e-6
    slope -= basis @ np.linalg.lstsq(basis, slope, rcond=None)[0]
    loud = np.sqrt(max(rest(release), floor) / len(t))
    std = loud / max(float(np.sqrt(np.sum(slope**2))), 1e-300)
    return Hold(release, std, float(t[-1]) - release, channel.site)


def _first(which: NDArray[np.bool_]) -> int:
    """Place of the first two neighbours that are true (a single one is an outlier), or the length."""
    places = np.flatnonzero(which[:-1] & which[1:])
    return int(places[0]) if len(places) else len(which)
