"""Where free motion begins in a recording: a hand that still carries the mechanism is no physics of it.

Recordings of released mechanisms are often started by hand, or by a trigger that the mechanism passes while the hand is
still on it. Such a stretch obeys no law of motion at all, and any effect fitted to it is an invention.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.signal import savgol_filter

from harness.denoc.model import Denoc
from harness.effects.scale import references
from harness.recording.recording import Channel, QualityNote, Recording
from harness.system import System

Array = NDArray[np.float64]

SAMPLES_A_SWING = 96  # of the slowest swing, at which accelerations are read off
SMOOTHING = 9  # such samples in the local cubic, about a tenth of a swing
WINDOW = 5  # such samples in a window whose mean force is judged
SHORTEST = 2  # such windows; a single one may be an outlier
SIGMAS = 5.0  # of the first windows' mean force beyond what the rest of the recording shows
GOES_ON = 2.5  # of a later window's
NEAR = 1.5  # swings after a carried stretch in which a knock still counts as part of it
SHARE = 0.12  # of the accelerations that gravity makes, below which a carrying hand is not claimed
MOST = 0.4  # of a recording that may be left out; beyond, it is the model that is wrong
# Of the greatest speed, and of the swing's extent; what stands still is held, and has an effect of its own (late release).
MOVING = 0.03


@dataclass(frozen=True)
class CarriedStart:
    """Time at which the motion becomes free [s from the first sample], the joint where it shows and how strong it was.

    share: mean force in the carried stretch over the largest one that the model itself has there.
    """

    time: float
    joint: str
    share: float


def carried_start(system: System, recording: Recording) -> CarriedStart | None:
    """The stretch at the beginning of a free recording in which something carries the mechanism, or None.

    Accelerations read off the recording are held against those of the model; what is left is regressed, robustly, on
    gravity, friction and drag over the whole recording. A stretch that begins with the first sample and lies
    beyond that in every window is carried. Not judged (None): driven recordings, systems with flexible links, joints
    without a measured position, recordings of less than three swings.
    """
    if system.flexible or any(np.any(effort.values != 0.0) for effort in recording.efforts):
        return None
    channels = _positions(system, recording)
    if channels is None:
        return None
    period = 2.0 * np.pi / min(references(system, name, recording).frequency for name in system.joint_names)
    step = max(period / SAMPLES_A_SWING, recording.interval)
    if recording.duration < 3.0 * period or period / step < 4 * SMOOTHING:
        return None
    grid = np.arange(0.0, recording.duration, step)
    q, qd, qdd = (np.stack(part, axis=1) for part in zip(*(_motion(recording, c, grid) for c in channels), strict=True))
    expected = Denoc(system).forward_dynamics_batch(q, qd, np.zeros_like(q))
    found: CarriedStart | None = None
    for j, name in enumerate(system.joint_names):
        end, share = _strange_beginning(q[:, j], qd[:, j], qdd[:, j], expected[:, j])
        if 0 < end <= MOST * len(grid) and (found is None or grid[end] > found.time):
            found = CarriedStart(float(grid[end]), name, share)
    return found


def free_part(system: System, recording: Recording) -> Recording:
    """The recording without a carried beginning; the same recording if there is none. A quality note tells."""
    start = carried_start(system, recording)
    if start is None:
        return recording
    note = QualityNote(
        "carried_start",
        start.joint,
        f"the first {start.time:.3g} s are not the free motion of the rest: something carries it, with about "
        f"{100.0 * start.share:.0f} % of the largest force that the model has there, or a slow sensor has yet to catch up",
        "left out",
        where=((0.0, start.time),),
        size=start.time,
    )
    return recording.without_beginning(recording.time >= start.time, note)


def _positions(system: System, recording: Recording) -> list[Channel] | None:
    by_site = {c.site: c for c in recording.channels if c.quantity == "position"}
    if any(name not in by_site for name in system.joint_names):
        return None
    return [by_site[name] for name in system.joint_names]


def _motion(recording: Recording, channel: Channel, grid: Array) -> tuple[Array, Array, Array]:
    """Position, velocity and acceleration on an even grid, from local cubics over the recording's own samples."""
    good = np.isfinite(channel.values)
    interval = recording.interval
    even = np.arange(0.0, recording.duration, interval)
    values = np.interp(even, recording.time[good], channel.values[good])
    length = max(SMOOTHING, round(SMOOTHING * float(grid[1] - grid[0]) / interval)) | 1
    parts = [savgol_filter(values, length, 3, deriv=order, delta=interval) for order in range(3)]
    return np.interp(grid, even, parts[0]), np.interp(grid, even, parts[1]), np.interp(grid, even, parts[2])


def _strange_beginning(q: Array, qd: Array, qdd: Array, expected: Array) -> tuple[int, float]:
    """Number of grid samples at the beginning that follow no law which the rest follows, and how far they are off."""
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
    # The robust loss lets it pull no more than its number of samples.
    spread = float(1.4826 * np.median(np.abs(left - np.median(left)))) or 1e-12
    start = np.zeros(basis.shape[1])
    fitted = least_squares(lambda x: basis @ x - left, start, jac=lambda x: basis, loss="soft_l1", f_scale=spread)
    rest = left - basis @ fitted.x
    rest = rest[SMOOTHING // 2 :]  # the local cubics at the very edge are noisier than elsewhere
    windows = len(rest) // WINDOW
    means = rest[: windows * WINDOW].reshape(windows, WINDOW).mean(axis=1)
    # What has come to rest shows no force at all and says nothing of how well forces can be read off.
    fast = np.abs(qd[SMOOTHING // 2 :][: windows * WINDOW]).reshape(windows, WINDOW).max(axis=1) > 0.1 * speed
    sigma = float(1.4826 * np.median(np.abs(means[fast])))
    first = float(np.mean(means[:SHORTEST]))
    if abs(first) < max(SIGMAS * sigma / np.sqrt(SHORTEST), SHARE):
        return 0, 0.0
    # It goes on until two windows in a row are ordinary; a force that turns round is no longer the same carrying.
    off = np.sign(first) * means > GOES_ON * sigma
    count = 0
    while count < windows and (off[count] or (0 < count < windows - 1 and off[count + 1])):
        count += 1
    moves = np.mean(np.abs(qd[: count * WINDOW]) > MOVING * speed) >= 0.5
    if count < SHORTEST or not moves or _held(q, count):
        return 0, 0.0
    # A hand just taken away is still near, and a knock in the first swings belongs to the letting go.
    near = count + round(NEAR * SAMPLES_A_SWING / WINDOW)
    knocks = np.flatnonzero(np.abs(means[:near]) > max(SIGMAS * sigma, SHARE))
    share = float(np.mean(np.abs(means[: max(count, 1)])))
    count = max(count, int(knocks[-1]) + 1) if len(knocks) else count
    return SMOOTHING // 2 + (count + 1) * WINDOW, share


def _held(q: Array, count: int) -> bool:
    """Whether what is carried for ``count`` windows stands still until the last of them; noise may look like speed there."""
    means = q[: max(count - 1, 2) * WINDOW].reshape(-1, WINDOW).mean(axis=1)
    return float(np.ptp(means)) < MOVING * 0.5 * float(np.ptp(q))
