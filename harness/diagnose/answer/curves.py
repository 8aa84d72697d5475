"""What the plots of a diagnosis show: residuals over time, residual force over the motion, energy by half-swing, spectra."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter, welch

from harness.denoc.model import Denoc
from harness.diagnose.answer.constants import SMOOTHING_PERIODS
from harness.diagnose.criticism.locate import raw_residuals
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.acting import feedback
from harness.diagnose.problem.drive import Drive
from harness.diagnose.selection.outcome import Outcome, judge
from harness.effects.scale import references, swings

Array = NDArray[np.float64]

MOST_POINTS = 4000  # a plot, per curve


@dataclass(frozen=True, eq=False)
class Residuals:
    """One channel of one recording: measured values and what nominal and augmented model leave of them, channel unit."""

    channel: str
    unit: str
    recording: str
    held_out: bool
    noise: float
    time: Array
    measured: Array
    nominal: Array
    augmented: Array


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Density of a channel's residual [unit²/Hz] over frequency [Hz], and of its noise if that were white."""

    channel: str
    unit: str
    frequency: Array
    nominal: Array
    augmented: Array
    noise: float


@dataclass(frozen=True, eq=False)
class ForceMap:
    """Generalized force that the nominal model lacks along the smoothed motion of one joint; units: of position and of force."""

    joint: str
    units: tuple[str, str]
    position: Array
    velocity: Array
    force: Array


@dataclass(frozen=True, eq=False)
class Energy:
    """Energy lost per half-swing [J] against its amplitude, recorded and by each model; one moving joint only."""

    joint: str
    unit: str
    recorded: tuple[Array, Array]
    nominal: tuple[Array, Array]
    augmented: tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Curves:
    """All that the pictures of a diagnosis are drawn from."""

    residuals: tuple[Residuals, ...] = ()
    spectra: tuple[Spectrum, ...] = ()
    forces: tuple[ForceMap, ...] = ()
    energy: tuple[Energy, ...] = ()


def curves(outcome: Outcome, best: Fit, held: Fit) -> Curves:
    """Gather the curves. best, held: the augmented model on training windows and on the data held out."""
    problem = outcome.problem
    before = _by_run(outcome, (outcome.nominal, judge(outcome, outcome.nominal)))
    after = _by_run(outcome, (best, held))
    residuals = []
    for run in sorted(before):
        time, left = before[run]
        recorded = problem.runs[run]
        for c, channel in enumerate(problem.channels):
            noise = outcome.noise[c]
            # Where there is no sample there is none to show either.
            measured = recorded.values[c][np.minimum(np.searchsorted(recorded.time, time), len(recorded.time) - 1)]
            other = np.interp(time, after[run][0], after[run][1][c]) if run in after else np.full(len(time), np.nan)
            residuals.append(
                Residuals(
                    channel.name, channel.unit, recorded.name, run >= len(problem.train), noise, time, measured, left[c], other
                )
            )  # fmt: skip
    return Curves(tuple(residuals), tuple(_spectra(outcome, residuals)), _forces(outcome), _energy(outcome, residuals))


def _by_run(outcome: Outcome, fits: Sequence[Fit]) -> dict[int, tuple[Array, Array]]:
    """Times and residuals (C, T) of every run, its windows joined."""
    parts: dict[int, list[tuple[Array, Array]]] = {}
    for fitted in fits:
        for window, piece in zip(fitted.windows, raw_residuals(outcome, fitted), strict=True):
            parts.setdefault(window.run, []).append(piece)
    return {
        run: (np.concatenate([t for t, _ in pieces]), np.concatenate([r for _, r in pieces], axis=1))
        for run, pieces in parts.items()
    }


def _spectra(outcome: Outcome, residuals: Sequence[Residuals]) -> list[Spectrum]:
    """Welch's spectrum of the first training recording's residuals."""
    out: list[Spectrum] = []
    for r in residuals:
        if r.held_out or any(s.channel == r.channel for s in out):
            continue
        step = float(np.median(np.diff(r.time)))
        grid = np.arange(r.time[0], r.time[-1], step)
        size = max(16, min(len(grid), int(2.0 ** np.ceil(np.log2(len(grid) / 3.0)))))
        if len(grid) < 16:
            continue
        densities = []
        for values in (r.nominal, r.augmented):
            frequency, density = welch(np.interp(grid, r.time, np.nan_to_num(values)), 1.0 / step, nperseg=size)
            densities.append(density[1:])
        out.append(Spectrum(r.channel, r.unit, frequency[1:], densities[0], densities[1], 2.0 * r.noise**2 * step))
    return out


def _positions(outcome: Outcome) -> list[int] | None:
    """Channel of every joint's position, or None if one of them is not measured."""
    every = [outcome.problem.position_of(joint) for joint in outcome.problem.system.joint_names]
    found = [c for c in every if c is not None]
    return found if len(found) == len(every) else None


def _forces(outcome: Outcome) -> tuple[ForceMap, ...]:
    """Residual generalized force by inverse dynamics of the nominal model along the smoothed motion."""
    problem = outcome.problem
    channels = _positions(outcome)
    if problem.system.flexible or problem.system.loops or problem.system.gimbals or channels is None:
        return ()
    slowest = min(swings(problem.system))
    rows: list[tuple[Array, Array, Array]] = []
    for run in problem.train:
        step = run.interval
        grid = np.arange(run.time[0], run.time[-1], step)
        width = max(7, int(SMOOTHING_PERIODS * 2.0 * np.pi / slowest / step) | 1)
        if len(grid) <= 2 * width:
            continue
        values = np.stack([np.interp(grid, run.time, np.nan_to_num(run.values[c])) for c in channels], axis=1)
        q, qd, qdd = (savgol_filter(values, width, 3, deriv=d, delta=step, axis=0) for d in (0, 1, 2))
        torque = Denoc(problem.system_in(run)).inverse_dynamics_batch(q, qd, qdd)
        effort = None
        if run.effort is not None:
            drive = Drive(run, run.effort.T, held=problem.held)
            effort = np.stack([drive.at(grid - run.time[0], j) for j in range(run.effort.shape[1])], axis=1)
            torque -= effort
        torque -= feedback(problem.system, q, qd, effort)
        inner = slice(width, len(grid) - width, max(1, len(grid) * len(problem.train) // MOST_POINTS))
        rows.append((q[inner], qd[inner], torque[inner]))
    if not rows:
        return ()
    q, qd, torque = (np.concatenate(part) for part in zip(*rows, strict=True))
    joints = map(problem.system.joint, problem.system.joint_names)
    return tuple(
        ForceMap(joint.name, (joint.position_unit, joint.force_unit), q[:, j], qd[:, j], torque[:, j])
        for j, joint in enumerate(joints)
    )


def _energy(outcome: Outcome, residuals: Sequence[Residuals]) -> tuple[Energy, ...]:
    """Loss between successive rests, from the height of the turning points; free motion of a single joint only."""
    system = outcome.problem.system
    channels = _positions(outcome)
    if system.flexible or channels is None or len(channels) != 1 or outcome.problem.driven or system.drives:
        return ()
    models = {run.name: Denoc(outcome.problem.system_in(run)) for run in outcome.problem.runs}
    joint = system.joint_names[0]
    slowest = references(system, joint).frequency
    collected: dict[str, tuple[list[float], list[float]]] = {k: ([], []) for k in ("recorded", "nominal", "augmented")}
    for r in residuals:
        if r.channel != outcome.problem.channels[channels[0]].name:
            continue
        step = float(np.median(np.diff(r.time)))
        width = max(5, int(SMOOTHING_PERIODS * 2.0 * np.pi / slowest / step) | 1)
        if len(r.time) <= 2 * width:
            continue
        for kind, values in (
            ("recorded", r.measured), ("nominal", r.measured - r.nominal), ("augmented", r.measured - r.augmented),
        ):  # fmt: skip
            turns = _turning_points(np.nan_to_num(values), width)
            heights = [models[r.recording].energy(np.array([x]), np.zeros(1))[1] for x in turns]
            for (a, b), (ea, eb) in zip(pairwise(turns), pairwise(heights), strict=True):
                collected[kind][0].append(0.5 * abs(b - a))
                collected[kind][1].append(ea - eb)
    pairs = {k: (np.array(x), np.array(y)) for k, (x, y) in collected.items()}
    return (
        (Energy(joint, system.joint(joint).position_unit, pairs["recorded"], pairs["nominal"], pairs["augmented"]),)
        if len(pairs["recorded"][0]) > 2
        else ()
    )


def _turning_points(values: Array, width: int) -> list[float]:
    """Positions at which the motion turns, each the extremum of the local cubic."""
    smooth = savgol_filter(values, width, 3)
    slope = savgol_filter(values, width, 3, deriv=1)
    turns = np.flatnonzero(np.diff(np.sign(slope)) != 0)
    points: list[float] = []
    last = -width
    floor = 0.02 * float(np.ptp(smooth))
    for i in turns:
        if i - last < width or (points and abs(smooth[i] - points[-1]) < floor):
            continue
        points.append(float(smooth[i]))
        last = int(i)
    return points
