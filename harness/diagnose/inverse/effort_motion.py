"""Smoothed motion and efforts of a recording, from which inverse dynamics can be read.

Accelerations of a recorded angle are mostly noise: its second derivative weighs noise by the square of the frequency. Used as
they come they make any regression of effort on acceleration too small ("attenuation", Fuller, Measurement Error Models, 1987).
So every torque and the effort are taken through one zero-phase low-pass, as high as the noise of the angle allows and no higher.
Torques are computed along a motion that is smoothed less, so that what is not linear in it is not rounded off first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, make_interp_spline
from scipy.ndimage import binary_dilation, maximum_filter1d
from scipy.signal import butter, savgol_filter, sosfilt, sosfilt_zi, sosfiltfilt

from harness.diagnose.inverse.constants import (
    EDGE_PERIODS,
    LOWPASS_ORDER,
    MOTION_CUTOFF_RATIO,
    OVERSAMPLING,
    RESTING_PERIODS,
    STILL_SHARE,
    STILL_SIGMAS,
    WIDEST_NYQUIST_SHARE,
)
from harness.errors import InputError
from harness.recording.noise import estimate_noise
from harness.recording.recording import Channel, Recording
from harness.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class EffortRun:
    """One recording on an even, fine grid.

    time: [s], shape (T,). q, qd, qdd: motion through a wider low-pass, shape (T, n).
    raw, effort: efforts as recorded and smoothed, shape (T, n).
    sharp: velocity over short stretches of the reading, which does not ring where a joint comes to rest, shape (T, n).
    short: how long those stretches are, for each joint [s], shape (n,).
    driven: joints with a recorded effort, shape (n,). still: such a velocity below which a joint may rest, shape (n,).
    usable: samples that can be compared, shape (T,). bandwidth: cutoff [Hz].
    foretold: efforts that ordinary torques along the motion foretell, before smoothing, shape (T, n); None where that is not known.
    """

    name: str
    time: Array
    q: Array
    qd: Array
    qdd: Array
    sharp: Array
    short: Array
    raw: Array
    effort: Array
    driven: NDArray[np.bool_]
    still: Array
    usable: NDArray[np.bool_]
    bandwidth: float
    foretold: Array | None = None

    @property
    def inner(self) -> NDArray[np.bool_]:
        """Samples that the low-pass knows both sides of, shape (T,)."""
        reach = EDGE_PERIODS / self.bandwidth
        return np.asarray((self.time >= reach) & (self.time <= self.time[-1] - reach))

    @cached_property
    def unsure(self) -> Array:
        """Share of a joint's dry friction by which its smoothed effort may be off either way, (T, n).

        A joint that turns about sticks for a while, or creeps, and which way it is pushed meanwhile is not in its position. A
        direction of ±1 whose mean is m = tanh(v / still) has a standard deviation of √(1 − m²), throughout one turn alike.
        """
        return np.abs(self.smooth(self._doubt))

    @cached_property
    def late(self) -> Array:
        """The same where friction turns before the joint does in every turn, or after, as sticking makes it, (T, n)."""
        return self.smooth(self._doubt * np.sign(np.gradient(self.smooth(self.direction), axis=0)))

    @cached_property
    def _doubt(self) -> Array:
        # A stretch that reaches into motion does not show the rest in it.
        step = float(self.time[1] - self.time[0])
        plain = np.sqrt(1.0 - self.direction**2)
        wide = [maximum_filter1d(d, 1 + round(s / step)) for d, s in zip(plain.T, self.short, strict=True)]
        return np.stack(wide, axis=1)

    @cached_property
    def direction(self) -> Array:
        """Which way each joint moves, as dry friction knows it: -1 to 1, (T, n)."""
        return np.asarray(np.tanh(self.sharp / self.still))

    @cached_property
    def _filter(self) -> ZeroPhase:
        return ZeroPhase(low_pass(self.bandwidth, float(self.time[1] - self.time[0])))

    def smooth(self, values: Array) -> Array:
        """The low-pass along the first axis."""
        return self._filter(values)

    def smooth_at(self, samples: NDArray[np.intp]) -> Array:
        """What the low-pass takes of every sample at some of them, (len(samples), T)."""
        return self._filter.at(samples, len(self.time))

    def without(self, samples: NDArray[np.bool_]) -> EffortRun:
        """The run with further samples not usable."""
        return replace(self, usable=self.usable & ~samples)

    def moved(self, q: Array, changed: Sequence[int] | None = None) -> EffortRun:
        """The run with another motion in place of the measured one; changed: the joints whose motion is another, all for None."""
        which = list(range(q.shape[1])) if changed is None else list(changed)
        spline = make_interp_spline(self.time, q[:, which], k=5)
        qd, qdd = self.qd.copy(), self.qdd.copy()
        qd[:, which], qdd[:, which] = spline.derivative(1)(self.time), spline.derivative(2)(self.time)
        return replace(self, q=q, qd=qd, qdd=qdd, sharp=self.sharp + qd - self.qd)


class ZeroPhase:
    """Second-order sections passed forwards and backwards along the first axis, as SciPy's ``sosfiltfilt`` does.

    SciPy finds anew at every call the state that a filter is in before a constant signal, which takes longer than to filter.
    """

    def __init__(self, sections: Array) -> None:
        self._sections = sections
        self._state = sosfilt_zi(sections)
        # SciPy's length of what is put before and after, turned about the ends.
        plain = min(np.count_nonzero(sections[:, 2] == 0.0), np.count_nonzero(sections[:, 5] == 0.0))
        self._pad = 3 * (2 * len(sections) + 1 - int(plain))

    def __call__(self, values: Array) -> Array:
        # Samples of a signal beside each other, which is how the filter walks.
        rows = np.ascontiguousarray(values.T, dtype=np.float64)
        if rows.shape[-1] <= self._pad:
            raise ValueError(
                f"{rows.shape[-1]} samples are too few for this filter, which takes {self._pad} at the ends"
            )
        pad = self._pad
        before = 2.0 * rows[..., :1] - rows[..., pad:0:-1]
        after = 2.0 * rows[..., -1:] - rows[..., -2 : -pad - 2 : -1]
        there = self._pass(np.concatenate([before, rows, after], axis=-1))
        back = self._pass(there[..., ::-1])[..., ::-1]
        return np.ascontiguousarray(back[..., pad:-pad].T)

    def at(self, samples: NDArray[np.intp], count: int) -> Array:
        """What the low-pass takes of each of ``count`` samples at a few of them, (len(samples), count): it is linear.

        A filter's transpose is the filter backwards; what its state takes of the first sample, and what is put before and after the
        signal, is added up in turn.
        """
        pad, length = self._pad, count + 2 * self._pad
        taken = np.zeros((len(samples), length))
        taken[np.arange(len(samples)), samples + pad] = 1.0
        first = np.zeros((1, length))
        first[0, 0] = 1.0
        # What a first sample of one adds by the state that it is begun in.
        begun = self._pass(first)[0] - sosfilt(self._sections, first[0])
        for _ in range(2):
            # From the last pass to the first: turned about, and passed the other way.
            turned = taken[:, ::-1]
            taken = np.asarray(sosfilt(self._sections, turned[:, ::-1], axis=-1))[:, ::-1]
            taken[:, 0] += turned @ begun
        out = taken[:, pad:-pad].copy()
        before, after = taken[:, :pad], taken[:, -pad:]
        out[:, 0] += 2.0 * before.sum(axis=1)
        out[:, 1 : pad + 1] -= before[:, ::-1]
        out[:, -1] += 2.0 * after.sum(axis=1)
        out[:, -pad - 1 : -1] -= after[:, ::-1]
        return out

    def _pass(self, rows: Array) -> Array:
        state = self._state.reshape(len(self._sections), *[1] * (rows.ndim - 1), 2)
        return np.asarray(sosfilt(self._sections, rows, axis=-1, zi=state * rows[..., :1])[0])


def low_pass(cutoff: float, step: float) -> Array:
    """Second-order sections of the low-pass at ``cutoff`` [Hz] on a grid of ``step`` seconds."""
    return np.asarray(butter(LOWPASS_ORDER, cutoff, fs=1.0 / step, output="sos"))


def effort_run(system: System, recording: Recording, cutoff: float) -> EffortRun:
    """The recording through a low-pass at ``cutoff`` [Hz].

    Raises InputError if a joint has no measured position, or nothing is driven.
    """
    names = system.joint_names
    step = 1.0 / (OVERSAMPLING * cutoff)
    time = np.arange(0.0, recording.duration, step)
    sections = low_pass(cutoff, step)
    widest = min(MOTION_CUTOFF_RATIO * cutoff, max(WIDEST_NYQUIST_SHARE * 0.5 / recording.interval, cutoff))
    wide = low_pass(widest, step)
    columns = []
    for name in names:
        channel = next((c for c in recording.channels if c.site == name and c.quantity == "position"), None)
        if channel is None:
            raise InputError(
                f"{name}.position is not measured, so the effort at {name} cannot be predicted",
                mend="record the position of every joint, or leave --fit-effort out",
                source=recording.source,
            )
        good = np.isfinite(channel.values)
        columns.append(sosfiltfilt(wide, CubicSpline(recording.time[good], channel.values[good])(time)))
    raw = recorded_efforts(system, recording, time)
    driven = np.zeros(len(names), dtype=bool)
    for channel in recording.efforts:
        driven[names.index(channel.site)] = bool(np.any(channel.values[np.isfinite(channel.values)] != 0.0))
    if not driven.any():
        raise InputError("the recording has no effort to fit", mend="leave --fit-effort out", source=recording.source)
    blank = np.zeros_like(raw)
    run = EffortRun(
        recording.name, time, blank, blank, blank, blank, np.zeros(len(names)), raw,
        np.asarray(sosfiltfilt(sections, raw, axis=0)), driven, np.full(len(names), 1e-12), np.ones(len(time), dtype=bool), cutoff,
    ).moved(np.stack(columns, axis=1))  # fmt: skip
    sharp, still, short = zip(
        *(_short_slopes(recording, name, time, v, 1.0 / widest) for name, v in zip(names, run.qd.T, strict=True)),
        strict=True,
    )
    edge = round(EDGE_PERIODS / (cutoff * step))
    usable = np.ones(len(time), dtype=bool)
    usable[:edge] = usable[-edge:] = False
    for gap in recording.quality:
        if gap.kind == "gap":
            for first, last in gap.where:
                usable &= (time < first - 1.0 / cutoff) | (time > last + 1.0 / cutoff)
    run = replace(run, sharp=np.stack(sharp, axis=1), still=np.array(still), short=np.array(short), usable=usable)
    return run.without(_resting(run))


def recorded_efforts(system: System, recording: Recording, time: Array) -> Array:
    """Recorded efforts of all joints, straight between their samples, at times (T,) [s]; (T, n), zero where none is recorded."""
    raw = np.zeros((len(time), len(system.joint_names)))
    for channel in recording.efforts:
        good = np.isfinite(channel.values)
        raw[:, system.joint_names.index(channel.site)] = np.interp(time, recording.time[good], channel.values[good])
    return raw


def _short_slopes(
    recording: Recording, joint: str, time: Array, smooth: Array, longest: float
) -> tuple[Array, float, float]:
    """Slopes of a joint's reading over stretches no longer than its noise asks for, (T,), the least told from rest, the length [s].

    The noise of a straight line's slope through n samples Δt apart is σ/Δt √(12/(n (n² − 1))). smooth: the smoothed velocity, (T,).
    """
    channel = recording.channel(f"{joint}.position")
    good = np.isfinite(channel.values)
    even = np.arange(0.0, recording.time[-1] + 0.5 * recording.interval, recording.interval)
    noise, fastest = reading_noise(recording, channel), float(np.abs(smooth).max())

    def unsure(count: int) -> float:
        return STILL_SIGMAS * noise / recording.interval * float(np.sqrt(12.0 / (count * (count**2 - 1.0))))

    count, most = 3, min(longest / recording.interval, len(even) - 1.0)
    while count + 2 <= most and unsure(count) > STILL_SHARE * fastest:
        count += 2
    slopes = savgol_filter(
        np.interp(even, recording.time[good], channel.values[good]), count, 1, deriv=1, delta=recording.interval
    )
    return np.interp(time, even, slopes), max(unsure(count), STILL_SHARE * fastest, 1e-12), count * recording.interval


# Every cutoff that is tried asks for the same noise again.
_KNOWN: WeakKeyDictionary[Channel, float] = WeakKeyDictionary()


def reading_noise(recording: Recording, channel: Channel) -> float:
    """Standard deviation of the noise of what one of a recording's sensors reads."""
    if channel not in _KNOWN:
        found = estimate_noise(recording.time, channel.values, unit=channel.unit, channel=channel.name)
        _KNOWN[channel] = found.std
    return _KNOWN[channel]


def _resting(run: EffortRun) -> NDArray[np.bool_]:
    """Samples at which a driven joint stands still for long, so that its friction is whatever holds it."""
    step = float(run.time[1] - run.time[0])
    reach = max(1, round(0.5 * RESTING_PERIODS / (run.bandwidth * step)))
    out = np.zeros(len(run.time), dtype=bool)
    for j in np.flatnonzero(run.driven):
        slow = np.abs(run.sharp[:, j]) < run.still[j]
        # Long stretches only: erosion by half a period and dilation by one and a half.
        core = ~binary_dilation(~slow, iterations=reach)
        out |= binary_dilation(core, iterations=3 * reach)
    return out
