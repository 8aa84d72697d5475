"""The question put to diagnosis: a system, recordings to learn from, and recordings to be judged on.

Samples beyond 260 Hz are averaged in blocks; what a sensor makes of the motion is worked out at times within a block and averaged
as the samples are, so that an error that is faster than a block is neither lost nor mistaken. A velocity that was computed from the
position is left out, because its noise is coherent with the position's and tells nothing of its own. The part of a single recording
that is held out goes on in the recording's time: a drift, a shaken base and what a sensor remembers do not begin anew there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.signal import coherence

from harness.diagnose.problem.commands import are_commands
from harness.diagnose.problem.constants import (
    AT_REST_SHARE,
    BLOCK_SHORTNESS,
    COHERENCE_SEGMENT,
    COHERENT_CHANCE,
    COHERENT_SHARE,
    FEWEST_MOVING_SAMPLES,
    FEWEST_USABLE_SAMPLES,
    FINEST_RATE,
    HELD_OUT_SHARE,
    MOST_SAMPLES,
    SAMPLES_A_SWING,
)
from harness.diagnose.problem.payloads import carrying
from harness.effects.measured import Measured
from harness.effects.scale import swings
from harness.errors import InputError
from harness.recording.differences import white_noise
from harness.system import System

Array = NDArray[np.float64]

MEASURED = ("position", "velocity", "tip_deflection", "root_strain", "tip_acceleration")


@dataclass(frozen=True)
class ChannelInfo:
    """A measured channel that all recordings of a problem share: ``name`` is ``site.quantity``."""

    name: str
    site: str
    quantity: str
    unit: str


@dataclass(frozen=True, eq=False)
class Run:
    """One recording as the fit sees it.

    time: [s], shape (T,), ascending. values: shape (C, T), nan where a channel has no sample.
    effort: known generalized forces at the movable joints [N·m or N], shape (T, joints), or None when free.
    interval: median sampling interval [s]. averaged: recorded samples behind each value.
    since: how long before the first sample the recording had begun, with its sensors and whatever goes by the time [s].
    payload: what links carry more in it than in the problem's system (``problem.payloads``).
    """

    name: str
    time: Array
    values: Array
    effort: Array | None
    interval: float
    averaged: int = 1
    since: float = 0.0
    payload: Mapping[str, Array] = field(default_factory=dict)

    def date(self, sample: int) -> float:
        """Time of a sample from the beginning of the recording, what is not part of this run included [s]."""
        return float(self.time[sample] - self.time[0]) + self.since

    @property
    def duration(self) -> float:
        """From the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def roughness(self) -> Array:
        """White noise of every channel, robustly from third differences, a first guess that needs no model; shape (C,).

        nan for a channel without samples.
        """
        return np.array([white_noise(self.time, values) for values in self.values])


@dataclass(frozen=True, eq=False)
class Problem:
    """System, channels, and runs; parameters are fitted on ``train`` and judged on ``heldout``.

    held: recorded efforts act from their sample to the next one, as a controller's commands do; else smoothly through all samples.
    commanded: whether they look like commands, so that they are taken as held unless motions say otherwise.
    """

    system: System
    channels: tuple[ChannelInfo, ...]
    train: tuple[Run, ...]
    heldout: tuple[Run, ...]
    same_recording: bool = False
    steps: tuple[float, ...] = ()
    held: bool = False
    commanded: bool = False

    @property
    def runs(self) -> tuple[Run, ...]:
        return self.train + self.heldout

    def system_in(self, run: Run) -> System:
        """The system as it was in a run, with what its links carried then."""
        return carrying(self.system, run.payload) if run.payload else self.system

    def position_of(self, joint: str) -> int | None:
        """Which channel measures a joint's position, or None if none does."""
        found = (c for c, info in enumerate(self.channels) if info.site == joint and info.quantity == "position")
        return next(found, None)

    @property
    def driven(self) -> bool:
        """Whether a known effort acts in any recording."""
        return any(run.effort is not None for run in self.runs)


def pose(
    system: System,
    recordings: Sequence[Measured],
    *,
    heldout: Measured | None = None,
    finest_rate: float = FINEST_RATE,
    payloads: Sequence[Mapping[str, Array]] = (),
) -> Problem:
    """Put recordings of a system into the form the fit works on.

    heldout: recording judged on; by default the last of several, or the last 30 % of a single one.
    finest_rate: samples beyond this rate [Hz] are averaged in blocks. payloads: what links carry more than in the system, of every
    recording in turn, the one held out last.
    Raises InputError for recordings that share no channel with each other or with the system.
    """
    if not recordings:
        raise InputError("no recording given", mend="name at least one recording file")
    joints = system.joint_names
    links = tuple(link.name for link in system.links)
    first = recordings[0]
    names = [c.name for c in first.channels]
    for other in [*recordings[1:], *([heldout] if heldout is not None else [])]:
        present = {c.name for c in other.channels}
        names = [n for n in names if n in present]
    infos = []
    for channel in first.channels:
        if channel.name not in names or channel.quantity not in MEASURED:
            continue
        owners = joints if channel.quantity in ("position", "velocity") else links
        if channel.site not in owners:
            raise InputError(
                f"the recording speaks of {channel.site!r}, which the model does not have",
                mend=f"map the column to one of {', '.join(owners)}",
                column=channel.name,
            )
        infos.append(ChannelInfo(channel.name, channel.site, channel.quantity, channel.unit))
    if not infos:
        raise InputError(
            "the recordings share no measured channel of the model",
            mend="map a column to <joint>.position or another known quantity",
        )
    derived = {info.name for info in infos if info.quantity == "velocity" and _is_derived(info.site, recordings)}
    infos = [info for info in infos if info.name not in derived]
    carried = payloads or [{}] * (len(recordings) + 1)
    runs = [
        replace(_run(system, tuple(infos), recording, k), payload=carried[k]) for k, recording in enumerate(recordings)
    ]
    steps = tuple(_resolution([run.values[c] for run in runs]) for c in range(len(infos)))
    every = [*recordings, *([heldout] if heldout is not None else [])]
    # The data held out have no say in how they are predicted.
    learned = recordings if heldout is not None or len(recordings) == 1 else recordings[:-1]
    held = are_commands(effort.values for recording in learned for effort in recording.efforts)
    finest_rate = min(finest_rate, _affordable_rate(system, every))
    runs = [_thin(run, finest_rate) for run in runs]
    if heldout is not None:
        judged = replace(_run(system, tuple(infos), heldout, len(runs)), payload=carried[len(runs)])
        return Problem(system, tuple(infos), tuple(runs), (_thin(judged, finest_rate),), False, steps, held, held)
    if len(runs) > 1:
        return Problem(system, tuple(infos), tuple(runs[:-1]), (runs[-1],), False, steps, held, held)
    only = runs[0]
    cut = round((1.0 - HELD_OUT_SHARE) * _moving_samples(only))
    return Problem(
        system,
        tuple(infos),
        (_slice(only, 0, cut, "first part"),),
        (_slice(only, cut, len(only.time), "last part"),),
        True,
        steps,
        held,
        held,
    )


def _affordable_rate(system: System, recordings: Sequence[Measured]) -> float:
    """Rate [Hz] at which recordings come to ``MOST_SAMPLES`` together, but never too few samples a swing.

    Averaging in blocks loses nothing of what is slow.
    """
    seconds = sum(float(np.nanmax(r.time) - np.nanmin(r.time)) for r in recordings)
    swing = max(swings(system)) / (2.0 * np.pi)
    if system.flexible:
        return np.inf
    return max(MOST_SAMPLES / max(seconds, 1e-9), SAMPLES_A_SWING * swing)


def _is_derived(joint: str, recordings: Sequence[Measured]) -> bool:
    """Whether a joint's velocity was computed from its position, so that it tells nothing of its own.

    The noise of two sensors is independent; that of a quantity and its filtered derivative is coherent. Judged beyond a tenth
    of the sampling rate, where motion has no power.
    """
    shares = []
    for recording in recordings:
        by_name = {c.name: np.asarray(c.values, dtype=np.float64) for c in recording.channels}
        q, v = by_name.get(f"{joint}.position"), by_name.get(f"{joint}.velocity")
        if q is None or v is None:
            return False
        good = np.isfinite(q) & np.isfinite(v)
        if good.sum() < 8 * COHERENCE_SEGMENT:
            continue
        frequency, found = coherence(np.diff(q[good], 2), np.diff(v[good], 2), nperseg=COHERENCE_SEGMENT)
        averages = 2.0 * good.sum() / COHERENCE_SEGMENT - 1.0
        level = 1.0 - COHERENT_CHANCE ** (1.0 / max(9.0 / 11.0 * averages - 1.0, 1.0))
        shares.append(float(np.mean(found[frequency > 0.1] > level)))
    return bool(shares) and float(np.median(shares)) > COHERENT_SHARE


def _moving_samples(run: Run) -> int:
    """Number of samples until a free recording has come to rest; all of them if it has not, or if it is driven.

    What stands still predicts itself, so it is no data to be judged on.
    """
    if run.effort is not None:
        return len(run.time)
    last = 0
    for values in run.values:
        finite = np.isfinite(values)
        extent = float(np.ptp(values[finite])) if finite.any() else 0.0
        if extent > 0.0:
            end = float(np.median(values[finite][-max(1, finite.sum() // 20) :]))
            last = max(last, int(np.flatnonzero(finite & (np.abs(values - end) > AT_REST_SHARE * extent))[-1]) + 1)
    return last if last >= FEWEST_MOVING_SAMPLES else len(run.time)


def _run(system: System, infos: tuple[ChannelInfo, ...], recording: Measured, index: int) -> Run:
    time = np.asarray(recording.time, dtype=np.float64)
    by_name = {c.name: np.asarray(c.values, dtype=np.float64) for c in recording.channels}
    values = np.array([by_name[info.name] for info in infos])
    keep = np.isfinite(time)
    effort = None
    if recording.efforts:
        effort = np.zeros((len(time), len(system.joint_names)))
        for channel in recording.efforts:
            if channel.site not in system.joint_names:
                raise InputError(
                    f"the recording drives {channel.site!r}, which the model does not have",
                    mend=f"map the column to one of {', '.join(system.joint_names)}",
                    column=channel.name,
                )
            column = np.asarray(channel.values, dtype=np.float64)
            finite = np.isfinite(column)
            effort[:, system.joint_names.index(channel.site)] = np.interp(time, time[finite], column[finite])
        if not np.any(effort):
            effort = None
    time, values = time[keep], values[:, keep]
    effort = None if effort is None else effort[keep]
    if len(time) < FEWEST_USABLE_SAMPLES:
        raise InputError(
            f"the recording has {len(time)} usable sample{'' if len(time) == 1 else 's'}",
            mend=f"at least {FEWEST_USABLE_SAMPLES} are needed to tell motion from noise",
        )
    name = str(getattr(recording, "name", "") or getattr(recording, "source", "") or f"recording {index + 1}")
    since = sum(note.size for note in getattr(recording, "quality", ()) if note.kind == "carried_start")
    return Run(name, time, values, effort, float(np.median(np.diff(time))), since=since)


def _slice(run: Run, first: int, last: int, note: str) -> Run:
    effort = None if run.effort is None else run.effort[first:last]
    return replace(
        run,
        name=f"{run.name}, {note}",
        time=run.time[first:last],
        values=run.values[:, first:last],
        effort=effort,
        since=run.date(first),
    )


def _thin(run: Run, finest_rate: float) -> Run:
    """Average blocks of samples until the rate is about ``finest_rate``; blocks never span a gap."""
    step = int(np.floor(1.0 / (run.interval * finest_rate) + BLOCK_SHORTNESS))
    if step < 2:
        return run
    gaps = np.flatnonzero(np.diff(run.time) > 3.0 * run.interval) + 1
    starts: list[int] = []
    for lo, hi in zip([0, *gaps], [*gaps, len(run.time)], strict=True):
        starts += range(lo, hi - step + 1, step)
    index = np.array(starts)[:, None] + np.arange(step)
    time = run.time[index].mean(axis=1)
    values = run.values[:, index].mean(axis=2)
    recorded, kept = np.isfinite(run.values).sum(axis=1), step * np.isfinite(values).sum(axis=1)
    if np.any(kept < 0.5 * recorded):
        return _picked(run, step)
    effort = None if run.effort is None else run.effort[index].mean(axis=1)
    return replace(
        run, time=time, values=values, effort=effort, interval=run.interval * step, averaged=run.averaged * step
    )


def _picked(run: Run, step: int) -> Run:
    """Every ``step``-th sample, and those of channels that are read too seldom to be averaged in blocks; all where it is driven,
    since efforts act between samples too."""
    if run.effort is not None:
        return run
    seldom = np.isfinite(run.values).sum(axis=1) * step < 2 * len(run.time)
    keep = np.any(np.isfinite(run.values[seldom]), axis=0)
    keep[::step] = True
    time = run.time[keep]
    return replace(run, time=time, values=run.values[:, keep], interval=float(np.median(np.diff(time))))


def _resolution(columns: list[Array]) -> float:
    """Quantisation step of a channel [channel unit], 0 if its values are not on a grid.

    On a grid the distinct values are few and their distances multiples of the smallest one.
    """
    pooled = np.concatenate([c[np.isfinite(c)] for c in columns])
    distinct = np.unique(np.round(pooled, 12))
    if len(distinct) < 2 or len(distinct) > 0.5 * len(pooled):
        return 0.0
    gaps = np.diff(distinct)
    gaps = gaps[gaps > 1e-9 * max(1.0, float(np.abs(pooled).max()))]
    step = float(np.median(gaps))
    # Rounding in the file blurs the grid a little; most neighbours must still be one step or a few apart.
    off = np.abs(gaps / step - np.round(gaps / step))
    return step if np.mean(off < 0.1) > 0.9 else 0.0
