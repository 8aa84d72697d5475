"""Where free motion begins and ends in a recording: a hand that carries or stops the mechanism is no physics of it.

Recordings of released mechanisms are often started by hand, or by a trigger that the mechanism passes while the hand is
still on it, and end with somebody who stops it. Such a stretch obeys no law of motion at all, and any effect fitted to it is an
invention.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.signal import savgol_filter

from harness.denoc.model import Denoc
from harness.diagnose.conditioning.constants import (
    BEYOND_STOP_EXTENT,
    BLOW_SHARE,
    CARRIED_ON_SIGMAS,
    CARRIED_SHARE,
    CARRIED_SIGMAS,
    FAST_SHARE,
    FEWEST_CARRIED_WINDOWS,
    FORCE_WINDOW_SAMPLES,
    KNOCK_SWINGS,
    MOST_LEFT_OUT_SHARE,
    MOVING_SHARE,
    ROBUST_SIGMA,
    SAMPLES_A_SWING,
    SMOOTHING_SAMPLES,
    STATIC_FRICTION_RATIO,
)
from harness.effects.scale import swings
from harness.recording.recording import Channel, QualityNote, Recording
from harness.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Carried:
    """Time at which the motion becomes free, or is no longer [s from the first sample], the joint where it shows and how strongly.

    share: mean force in the carried stretch over the largest one that the model itself has there. rested: how long it hangs at
    rest before somebody takes it up [s].
    """

    time: float
    joint: str
    share: float
    rested: float = 0.0


def carried_start(system: System, recording: Recording) -> Carried | None:
    """The stretch at the beginning of a free recording in which something carries the mechanism, or None.

    Accelerations read off the recording are held against those of the model; what is left is regressed, robustly, on
    gravity, friction and drag over the whole recording. A stretch that begins with the first sample and lies
    beyond that in every window is carried. So is what follows a rest in balance, from which nothing moves by itself: a hand
    that takes the mechanism up while the recording runs. Not judged (None): driven recordings, systems with flexible links, joints
    without a measured position, recordings of less than three swings.
    """
    return _carried(system, recording, backwards=False)


def carried_end(system: System, recording: Recording, others: Sequence[Recording] = ()) -> Carried | None:
    """The same at the end, from where something catches the mechanism on; it may hold it still.

    Friction holds a joint as well, but with no more than it brakes it by; and a stop does, but nothing goes beyond it. others:
    recordings of the same mechanism, which may go there.
    """
    found = _carried(system, recording, backwards=True)
    if found is None:
        return None
    (channel,) = (c for c in recording.channels if c.quantity == "position" and c.site == found.joint)
    held = float(np.nanmedian(channel.values[recording.time > found.time]))
    every = [c.values for r in (recording, *others) for c in r.channels if c.name == channel.name]
    low, high = min(map(np.nanmin, every)), max(map(np.nanmax, every))
    margin = BEYOND_STOP_EXTENT * (high - low)
    return found if low + margin < held < high - margin else None


def _carried(system: System, recording: Recording, *, backwards: bool) -> Carried | None:
    if (
        system.flexible
        or system.loops
        or system.gimbals
        or any(np.any(effort.values != 0.0) for effort in recording.efforts)
    ):
        return None
    channels = _positions(system, recording)
    if channels is None:
        return None
    period = 2.0 * np.pi / min(swings(system, recording))
    step = max(period / SAMPLES_A_SWING, recording.interval)
    if recording.duration < 3.0 * period or period / step < 4 * SMOOTHING_SAMPLES:
        return None
    grid = np.arange(0.0, recording.duration, step)
    q, qd, qdd = (np.stack(part, axis=1) for part in zip(*(motion(recording, c, grid) for c in channels), strict=True))
    expected = Denoc(system).forward_dynamics_batch(q, qd, np.zeros_like(q))
    found: Carried | None = None
    rested = 0 if backwards else _still(q)
    for j, name in enumerate(system.joint_names):
        course = (q[:, j], qd[:, j], qdd[:, j], expected[:, j])
        # A film run backwards obeys the same laws but for friction and drag, whose size and sense are open here anyhow.
        course = (q[::-1, j], -qd[::-1, j], qdd[::-1, j], expected[::-1, j]) if backwards else course
        count, share = _strange_beginning(*course, stopped=backwards)
        hung = 0
        if count == 0 and rested:
            count, share = _taken_up(*course[1:], rested)
            hung = rested if count else 0
        if 0 < count - hung <= MOST_LEFT_OUT_SHARE * (len(grid) - hung):
            time = float(grid[len(grid) - 1 - count] if backwards else grid[count])
            if found is None or (time < found.time) == backwards:
                found = Carried(time, name, share, float(grid[hung]))
    return found


def free_parts(system: System, recordings: Sequence[Recording]) -> list[Recording]:
    """Recordings without what is carried at their beginnings and ends; the same ones if nothing is. Quality notes tell."""
    return [
        _free_part(recording, carried_start(system, recording), carried_end(system, recording, recordings))
        for recording in recordings
    ]


def _free_part(recording: Recording, start: Carried | None, end: Carried | None) -> Recording:
    if end is not None:
        note = QualityNote(
            "carried_end",
            end.joint,
            f"from {end.time:.3g} s on it is not the free motion of the rest: something stops or carries it, with about "
            f"{100.0 * end.share:.0f} % of the largest force that the model has there",
            "left out",
            where=((end.time, recording.duration),),
            size=end.time,
        )
        recording = recording.only(recording.time <= end.time, note)
    if start is not None:
        keep = recording.time >= start.time
        note = QualityNote(
            "carried_start",
            start.joint,
            f"the first {start.time:.3g} s are not the free motion of the rest: "
            + (f"it hangs at rest for {start.rested:.3g} s, then " if start.rested else "")
            + f"something carries it, with about {100.0 * start.share:.0f} % of the largest force that the model has there"
            + ("" if start.rested else ", or a slow sensor has yet to catch up"),
            "left out",
            where=((0.0, start.time),),
            size=float(recording.time[keep][0]),
        )
        recording = recording.only(keep, note)
    return recording


def _positions(system: System, recording: Recording) -> list[Channel] | None:
    by_site = {c.site: c for c in recording.channels if c.quantity == "position"}
    if any(name not in by_site for name in system.joint_names):
        return None
    return [by_site[name] for name in system.joint_names]


def motion(recording: Recording, channel: Channel, grid: Array) -> tuple[Array, Array, Array]:
    """Position, velocity and acceleration on an even grid, from local cubics over the recording's own samples."""
    good = np.isfinite(channel.values)
    interval = recording.interval
    even = np.arange(0.0, recording.duration, interval)
    values = np.interp(even, recording.time[good], channel.values[good])
    length = max(SMOOTHING_SAMPLES, round(SMOOTHING_SAMPLES * float(grid[1] - grid[0]) / interval)) | 1
    parts = [savgol_filter(values, length, 3, deriv=order, delta=interval) for order in range(3)]
    return np.interp(grid, even, parts[0]), np.interp(grid, even, parts[1]), np.interp(grid, even, parts[2])


def _strange_beginning(q: Array, qd: Array, qdd: Array, expected: Array, *, stopped: bool) -> tuple[int, float]:
    """Number of grid samples at the beginning that follow no law which the rest follows, and how far they are off.

    stopped: whether what is held still counts; else it has to move.
    """
    told = round(MOST_LEFT_OUT_SHARE * len(q)) if stopped else 0
    means, fast, sigma, grip = _forces(qd, qdd, expected, told)
    speed = float(np.abs(qd).max()) or 1.0
    windows = len(means)
    first = float(np.mean(means[:FEWEST_CARRIED_WINDOWS]))
    friction = STATIC_FRICTION_RATIO * grip
    if abs(first) < max(CARRIED_SIGMAS * sigma / np.sqrt(FEWEST_CARRIED_WINDOWS), CARRIED_SHARE):
        # It may have been stopped where nothing pulls it away.
        caught = _caught(means, fast, max(CARRIED_SIGMAS * sigma, BLOW_SHARE) + friction) if stopped else 0
        return (
            (SMOOTHING_SAMPLES // 2 + (caught + 1) * FORCE_WINDOW_SAMPLES, float(np.abs(means[:caught]).max()))
            if caught
            else (0, 0.0)
        )
    # It goes on until two windows in a row are ordinary; a force that turns round is no longer the same carrying.
    off = np.sign(first) * means > CARRIED_ON_SIGMAS * sigma
    count = 0
    while count < windows and (off[count] or (0 < count < windows - 1 and off[count + 1])):
        count += 1
    if count < FEWEST_CARRIED_WINDOWS:
        return 0, 0.0
    moves = np.mean(np.abs(qd[: count * FORCE_WINDOW_SAMPLES]) > MOVING_SHARE * speed) >= 0.5 and not _held(q, count)
    holds = stopped and abs(first) > CARRIED_SHARE + friction
    if not (moves or holds):
        return 0, 0.0
    # A hand just taken away is still near, and a knock in the first swings belongs to the letting go.
    near = count + round(KNOCK_SWINGS * SAMPLES_A_SWING / FORCE_WINDOW_SAMPLES)
    knocks = np.flatnonzero(np.abs(means[:near]) > max(CARRIED_SIGMAS * sigma, CARRIED_SHARE))
    share = float(np.mean(np.abs(means[: max(count, 1)])))
    count = max(count, int(knocks[-1]) + 1) if len(knocks) else count
    if not stopped and _recurs(q, means, count, max(CARRIED_SIGMAS * sigma, CARRIED_SHARE)):
        return 0, 0.0
    return SMOOTHING_SAMPLES // 2 + (count + 1) * FORCE_WINDOW_SAMPLES, share


def _recurs(q: Array, means: Array, count: int, least: float) -> bool:
    """Whether what acts in the first windows acts again wherever the motion is there again: a stop does, or a magnet, and no hand.

    means: forces that no law explains, of every window; least: from which on one counts.
    """
    places = q[SMOOTHING_SAMPLES // 2 :][: len(means) * FORCE_WINDOW_SAMPLES].reshape(len(means), -1).mean(axis=1)
    strange = np.abs(means) > least
    first, later = strange.copy(), strange.copy()
    first[count:] = later[:count] = False
    if not first.any():
        return False
    margin, way = BEYOND_STOP_EXTENT * float(np.ptp(q)), np.sign(means[first].mean())
    low, high = places[first].min() - margin, places[first].max() + margin
    return bool(np.any(later & (way * means > 0.0) & (places >= low) & (places <= high)))


def _forces(qd: Array, qdd: Array, expected: Array, told: int) -> tuple[Array, NDArray[np.bool_], float, float]:
    """What no law of the motion from sample ``told`` on explains: its mean over windows, whether those are fast, its scatter there,
    and the dry friction; all as shares of the model's accelerations."""
    scale = float(np.percentile(np.abs(expected), 95)) or 1.0
    speed = float(np.abs(qd).max()) or 1.0
    left = (qdd - expected) / scale
    basis = np.stack(
        [
            np.ones_like(qd), expected / scale, qd / speed, qd * np.abs(qd) / speed**2, np.tanh(qd / (0.02 * speed)),
        ],
        axis=1,
    )  # fmt: skip
    # Few terms, none of them of position alone: a carried stretch often lies where the free motion never comes again.
    # The robust loss lets it pull no more than its number of samples; what is held for long would still pull too much.
    design, target = basis[told:], left[told:]
    spread = float(ROBUST_SIGMA * np.median(np.abs(target - np.median(target)))) or 1e-12
    start = np.zeros(basis.shape[1])
    fitted = least_squares(lambda x: design @ x - target, start, jac=lambda x: design, loss="soft_l1", f_scale=spread)
    rest = left - basis @ fitted.x
    rest = rest[SMOOTHING_SAMPLES // 2 :]  # the local cubics at the very edge are noisier than elsewhere
    windows = len(rest) // FORCE_WINDOW_SAMPLES
    means = rest[: windows * FORCE_WINDOW_SAMPLES].reshape(windows, FORCE_WINDOW_SAMPLES).mean(axis=1)
    # What has come to rest shows no force at all and says nothing of how well forces can be read off.
    fast = (
        np.abs(qd[SMOOTHING_SAMPLES // 2 :][: windows * FORCE_WINDOW_SAMPLES])
        .reshape(windows, FORCE_WINDOW_SAMPLES)
        .max(axis=1)
        > FAST_SHARE * speed
    )
    sigma = float(ROBUST_SIGMA * np.median(np.abs(means[fast])))
    return means, fast, sigma, abs(float(fitted.x[-1]))


def _still(q: Array) -> int:
    """Number of grid samples at the beginning in which no joint moves."""
    moved = np.abs(q - q[0]) > 0.5 * MOVING_SHARE * np.ptp(q, axis=0)
    count = int(np.argmax(moved.any(axis=1)))
    return count


def _taken_up(qd: Array, qdd: Array, expected: Array, rested: int) -> tuple[int, float]:
    """Number of grid samples up to where what hung at rest for ``rested`` of them moves freely, and how far it is off; 0 if
    nothing seems to have moved it."""
    means, _, sigma, _ = _forces(qd, qdd, expected, rested)
    least = max(CARRIED_SIGMAS * sigma, CARRIED_SHARE)
    hung = max((rested - 2 * SMOOTHING_SAMPLES) // FORCE_WINDOW_SAMPLES, 0)
    if hung < FEWEST_CARRIED_WINDOWS or np.any(np.abs(means[:hung]) > least):
        return 0, 0.0  # what is held out of balance falls by itself once it is let go
    near = round(KNOCK_SWINGS * SAMPLES_A_SWING / FORCE_WINDOW_SAMPLES)
    pushed = np.flatnonzero(np.abs(means) > least)
    # Free motion begins with the first stretch, as long as a knock may take to come, in which nothing pushes any more.
    if not len(pushed) or pushed[0] > hung + near:
        return 0, 0.0
    apart = np.flatnonzero(np.diff(pushed) > near)
    last = int(pushed[apart[0]] if len(apart) else pushed[-1])
    share = float(np.mean(np.abs(means[pushed[0] : last + 1])))
    return SMOOTHING_SAMPLES // 2 + (last + 2) * FORCE_WINDOW_SAMPLES, share


def _caught(means: Array, fast: NDArray[np.bool_], least: float) -> int:
    """Number of windows, seen from the end, up to a blow of at least ``least`` that ended fast motion for good; 0 if none did."""
    moving = np.flatnonzero(fast)
    if not len(moving) or moving[0] < FEWEST_CARRIED_WINDOWS:
        return 0
    blow = np.flatnonzero(np.abs(means[moving[0] - 1 : moving[0] + FEWEST_CARRIED_WINDOWS]) > least)
    return int(moving[0] + blow[-1]) if len(blow) else 0


def _held(q: Array, count: int) -> bool:
    """Whether what is carried for ``count`` windows stands still until the last of them; noise may look like speed there."""
    means = q[: max(count - 1, 2) * FORCE_WINDOW_SAMPLES].reshape(-1, FORCE_WINDOW_SAMPLES).mean(axis=1)
    return float(np.ptp(means)) < MOVING_SHARE * 0.5 * float(np.ptp(q))
