"""Recorded efforts as a problem to search: runs without what pushes from outside, divided, their noise, and what may be missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.conditioning.constants import ROBUST_SIGMA
from harness.diagnose.inverse.constants import FAR_BELOW_NOISE, FEWEST_SAMPLES, NOISE_LAGS, REVERSING_SHARE
from harness.diagnose.inverse.effort_fit import EffortData, EffortFit
from harness.diagnose.inverse.effort_hold import held_runs
from harness.diagnose.inverse.effort_model import KNOWN, EffortModel
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.inverse.effort_noise import EffortNoise, Grid, effort_noise, grid_of
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.inverse.ordinary_torque import link_terms, ordinary_torque
from harness.diagnose.inverse.pushes import Push, mask_pushes
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.constants import HELD_OUT_SHARE
from harness.diagnose.problem.deadline import Deadline
from harness.diagnose.problem.hypothesis import Candidate
from harness.errors import InputError
from harness.recording.recording import Recording
from harness.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class EffortProblem:
    """runs: of every recording, those to learn from first. train: how many these are.

    smooth, turned: efforts taken as acting smoothly through their samples, and as held from each to the next.
    """

    runs: tuple[EffortRun, ...]
    train: int
    smooth: EffortStudy
    turned: EffortStudy


def posed(
    system: System,
    recordings: Sequence[Recording],
    runs: Sequence[EffortRun],
    pushes: Sequence[Push],
    *,
    given: bool,
    only: Sequence[str],
    deadline: Deadline,
) -> EffortProblem:
    """The problem of runs without what pushes. given: whether the last one is to be held out, however many there are.

    Raises InputError where too little is left to learn from or to judge on.
    """
    runs = [mask_pushes(run, k, pushes) for k, run in enumerate(runs)]
    train, test = _divided(runs, given)
    data, judged = _data(system, train, test, deadline)
    if data.samples < FEWEST_SAMPLES or judged.samples < FEWEST_SAMPLES // 4:
        raise InputError(
            f"{data.samples:.0f} independent samples of effort are left to learn from and {judged.samples:.0f} to judge on",
            mend="record more motion that nothing outside disturbs",
        )
    known = tuple(
        _as_driven(_resolvable(c, system, data.model.runs))
        for c in candidates(system, recordings, only=only or KNOWN)
        if c.effect.sensor is None or c.site.endswith(".position")
    )
    smooth = EffortStudy(data, judged, known)
    beside = _divided(held_runs(system, runs, recordings), given)
    turned = EffortStudy(data.recorded(beside[0]), judged.recorded(beside[1]), known, traces=smooth.traces)
    return EffortProblem(tuple(runs), len(train), smooth, turned)


def known_names(only: Sequence[str]) -> None:
    """Raises InputError for an effect that efforts do not tell."""
    for name in only:
        if name not in KNOWN:
            raise InputError(
                f"{name!r} cannot be weighed from efforts", mend=f"leave --fit-effort out, or one of {', '.join(KNOWN)}"
            )


def _resolvable(candidate: Candidate, system: System, runs: Sequence[EffortRun]) -> Candidate:
    """A Stribeck velocity no smaller than the speed that a reversal gains within the smoothing, which would else imitate it; a dead
    zone that lets half of the efforts through, since one that swallowed them all would explain whatever the motion foretells.
    """
    if candidate.effect.name == "actuator_deadzone":
        return _passing(candidate, system, runs)
    if candidate.effect.name == "actuator_saturation":
        return _limiting(candidate, system, runs)
    if candidate.effect.name != "stribeck_friction":
        return candidate
    joint = system.joint_names.index(candidate.site)
    least = 0.0
    for run in runs:
        slow = run.usable & (np.abs(run.qd[:, joint]) < REVERSING_SHARE * np.abs(run.qd[:, joint]).max())
        if slow.any():
            least = max(least, float(np.median(np.abs(run.qdd[slow, joint]))) / (2.0 * run.bandwidth))
    parameters = tuple(
        replace(p, lower=max(p.lower, least)) if p.name == "stribeck_velocity" else p
        for p in candidate.effect.parameters
    )
    return replace(candidate, effect=replace(candidate.effect, parameters=parameters))


def _passing(candidate: Candidate, system: System, runs: Sequence[EffortRun]) -> Candidate:
    """A dead zone no wider than the middle of the efforts that the motion asks for."""
    joint = system.joint_names.index(candidate.site)
    asked = [np.abs(run.foretold[run.usable, joint]) for run in runs if run.foretold is not None]
    widest = float(np.median(np.concatenate(asked))) if asked else np.inf
    parameters = tuple(replace(p, upper=min(p.upper, widest)) for p in candidate.effect.parameters)
    return replace(candidate, effect=replace(candidate.effect, parameters=parameters))


def _limiting(candidate: Candidate, system: System, runs: Sequence[EffortRun]) -> Candidate:
    """A limit that lets half of the efforts through, and is below the largest."""
    joint = system.joint_names.index(candidate.site)
    asked = np.concatenate([np.abs(run.raw[run.usable, joint]) for run in runs])
    low, high = (float(np.median(asked)), float(asked.max())) if len(asked) else (0.0, np.inf)
    parameters = tuple(
        replace(p, lower=max(p.lower, low), upper=min(p.upper, max(high, low))) for p in candidate.effect.parameters
    )
    return replace(candidate, effect=replace(candidate.effect, parameters=parameters))


def _as_driven(candidate: Candidate) -> Candidate:
    """The torque that sizes are counted in is no less than what drives the joint: its gear rubs by that, whatever hangs on it."""
    own = candidate.references
    return replace(candidate, references=replace(own, torque=max(own.torque, own.effort)))


def _divided(runs: list[EffortRun], given: bool) -> tuple[list[EffortRun], list[EffortRun]]:
    if given or len(runs) > 1:
        return runs[:-1], runs[-1:]
    run = runs[0]
    usable = np.flatnonzero(run.usable)
    cut = usable[int((1.0 - HELD_OUT_SHARE) * (len(usable) - 1))]
    later = np.arange(len(run.time)) >= cut
    return [run.without(later)], [run.without(~later)]


def _data(
    system: System, train: list[EffortRun], test: list[EffortRun], deadline: Deadline
) -> tuple[EffortData, EffortData]:
    grids = [grid_of(run) for run in train]
    every = [*train, *test]
    links = link_terms(system, every)
    foretold = [run.raw.copy() for run in every]
    noises = []
    for j in range(train[0].q.shape[1]):
        mine = [k for k, run in enumerate(train) if run.driven[j] and grids[k].samples]
        others = [k for k in range(len(every)) if k not in mine]
        pieces, dry = [], 0.0
        if mine:
            at = [*mine, *others]
            ordinary = ordinary_torque(
                system, [every[k] for k in mine], j, [links[k] for k in at], [every[k] for k in others]
            )
            dry = ordinary.dry
            pieces = _pieces([(train[k], grids[k], left) for k, left in zip(mine, ordinary.left, strict=True)], j, dry)
            for k, said in zip(at, ordinary.foretold, strict=True):
                foretold[k][:, j] = said
        noises.append(effort_noise(pieces or [np.zeros(1)], dry))
    every = [replace(run, foretold=said) for run, said in zip(every, foretold, strict=True)]
    known, unseen = every[: len(train)], every[len(train) :]
    data = EffortData(EffortModel(system, known, deadline), tuple(grids), tuple(noises))
    return data, EffortData(EffortModel(system, unseen, deadline), tuple(grid_of(run) for run in test), tuple(noises))


def noises_beside(system: System, data: EffortData, best: EffortFit) -> tuple[EffortNoise, ...] | None:
    """The noise of each joint by what ordinary torques leave of what a set leaves; None where that is not far less than the noise.

    Ordinary torques know no late or clipped drive, and what those make was taken for noise as long as nothing had named it.
    """
    residuals = data.model.residuals(best.hypothesis, best.x)

    def far_below(j: int) -> bool:
        left = data.plain(residuals, j)
        return bool(len(left)) and float(np.mean(left**2)) < (FAR_BELOW_NOISE * data.noises[j].std) ** 2

    quiet = [j for j in data.joints if far_below(j)]
    if not quiet:
        return None
    found, links = list(data.noises), link_terms(system, data.model.runs)
    for j in quiet:
        mine = [k for k, run in enumerate(data.model.runs) if run.driven[j] and data.grids[k].samples]
        runs = [replace(data.model.runs[k], effort=residuals[k]) for k in mine]
        rest = ordinary_torque(system, runs, j, [links[k] for k in mine]).left
        pieces = _pieces(
            [(run, data.grids[k], own) for run, k, own in zip(runs, mine, rest, strict=True)], j, data.noises[j].dry
        )
        found[j] = effort_noise(pieces, data.noises[j].dry)
    return tuple(found)


def _pieces(mine: Sequence[tuple[EffortRun, Grid, Array]], j: int, dry: float) -> list[Array]:
    """Consecutive samples of what is left that dry friction's direction has no part in, or all where there are too few of those."""
    every = [left[s] for _, grid, left in mine for s in grid.stretches]
    spread = ROBUST_SIGMA * float(np.median(np.abs(np.concatenate(every))))
    sure = []
    for run, grid, left in mine:
        for s in grid.stretches:
            clear = dry * run.unsure[s, j] <= spread
            cuts = np.flatnonzero(np.diff(clear.astype(int))) + 1
            parts = zip(np.split(s, cuts), np.split(clear, cuts), strict=True)
            sure += [left[part] for part, good in parts if good[0] and len(part) > NOISE_LAGS]
    return sure if sum(map(len, sure)) >= FEWEST_SAMPLES // 4 else every
