"""Diagnosis with efforts as the measurement: what effort does the recorded motion need, and what was recorded?

The ordinary diagnosis takes efforts for known and predicts motion. Where the effort itself is in doubt (estimated from a current,
commanded and not measured, or joined by a hand that nobody recorded) the question is turned round: inverse dynamics along the
smoothed motion predicts the effort, and the same effects are weighed by what they leave of it. No initial state enters and errors
do not grow along the motion, so stretches in which something outside pushes can simply be left out; they are told.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.explain import untried
from harness.diagnose.answer.nothing_fitted import nothing_fitted
from harness.diagnose.conditioning.constants import ROBUST_SIGMA
from harness.diagnose.inverse.band import band
from harness.diagnose.inverse.constants import FAR_BELOW_NOISE, FEWEST_SAMPLES, NOISE_LAGS, REVERSING_SHARE
from harness.diagnose.inverse.effort_answer import EffortAnswer
from harness.diagnose.inverse.effort_fit import EffortData, EffortFit
from harness.diagnose.inverse.effort_hold import held_runs, search_either_way
from harness.diagnose.inverse.effort_model import KNOWN, EffortModel
from harness.diagnose.inverse.effort_motion import EffortRun, effort_run
from harness.diagnose.inverse.effort_noise import EffortNoise, Grid, effort_noise, grid_of
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.inverse.effort_settle import settle, standing, surely_standing
from harness.diagnose.inverse.ordinary_torque import link_terms, ordinary_torque
from harness.diagnose.inverse.pushes import Push, find_pushes, mask_pushes
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.constants import HELD_OUT_SHARE
from harness.diagnose.problem.deadline import Deadline, Stage, TimeUp
from harness.diagnose.problem.held_efforts import held_notes
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.effects.effect import Effect
from harness.errors import InputError, UnsupportedError
from harness.recording.recording import QualityNote, Recording
from harness.recording.units import written
from harness.system import System

Array = NDArray[np.float64]

SMOOTHED_NOISE = (
    "the noise of the efforts beside what was found",
    "intervals may be too wide, and faint effects unseen",
)
UNSEARCHED = ("further sets of effects", "another set of effects may explain the recordings better, or as well")
UNJUDGED = (
    "the judgement on data held out, and of what else it could be",
    "what was found may not hold up, so that nothing is claimed",
)
UNPRUNED = (
    "the judgement of all that was found but is not told",
    "more of it may hold up on data held out",
)
UNWEIGHED = (
    "other effects in the place of those that stand on data held out",
    "another effect may be as likely as one of those told",
)


def diagnose_effort(
    system: System,
    recordings: Sequence[Recording],
    held: Recording | None = None,
    *,
    only: Sequence[str] = (),
    further: Sequence[Effect] = (),
    tell: Callable[[str], None] = lambda _: None,
    deadline: Deadline | None = None,
) -> Diagnosis:
    """What a model leaves of recorded efforts, and which physics it left out, judged on data held out.

    recordings: with the position of every joint and at least one effort; the last is held out if ``held`` is None, or the last
    30 % of a single one. only: restricts the catalogue to these names. deadline: by which the best answer so far is given.
    Raises InputError for recordings that cannot be used so, UnsupportedError for systems with flexible links.
    """
    if system.flexible:
        raise UnsupportedError("efforts are fitted for rigid links only", mend="leave --fit-effort out")
    if further:
        raise InputError("effects of your own cannot act on fitted efforts", mend="leave --effects or --fit-effort out")
    if system.drives:
        # What such a drive gives depends on all that it is asked for, so that what the motion needs tells no effort by itself.
        raise UnsupportedError(
            f"actuator {system.drives[0].name!r} has a range of force, which fitted efforts do not hold",
            mend="leave --fit-effort out, or record the effort of its joint",
            source=system.source,
        )
    deadline = deadline or Deadline()
    _known(only)
    every = [*recordings, *([held] if held is not None else [])]
    tell("smoothing")
    cutoff = band(system, every)
    runs = [effort_run(system, recording, cutoff) for recording in every]
    for run, recording in zip(runs, every, strict=True):
        if not run.usable.any():
            raise InputError(
                f"nothing can be compared: smoothed below {cutoff:.2g} Hz, no sample of {recording.duration:.3g} s is left "
                "that is away from the ends and at which the joints move",
                mend="record longer or livelier motion, or leave --fit-effort out",
                source=recording.source,
            )
    pushes = find_pushes(system, runs)
    runs = [mask_pushes(run, k, pushes) for k, run in enumerate(runs)]
    train, test = _divided(runs, held is not None)
    data, judged = _data(system, train, test, deadline)
    beside = _divided(held_runs(system, runs, every), held is not None)
    if data.samples < FEWEST_SAMPLES or judged.samples < FEWEST_SAMPLES // 4:
        raise InputError(
            f"{data.samples:.0f} independent samples of effort are left to learn from and {judged.samples:.0f} to judge on",
            mend="record more motion that nothing outside disturbs",
        )
    tell("noise of the efforts")
    known = tuple(
        _as_driven(_resolvable(c, system, data.model.runs))
        for c in candidates(system, every, only=only or KNOWN)
        if c.effect.sensor is None or c.site.endswith(".position")
    )
    study = smooth = EffortStudy(data, judged, known)
    notes = [_note(system, runs[p.run], p) for p in pushes]

    def told_of(other: EffortStudy) -> None:
        nonlocal study
        study = other

    def searched() -> EffortFit:
        return deadline.attempt(
            *UNSEARCHED, lambda: search_either_way(smooth, turned, tell, told_of), lambda: study.best()
        )

    try:
        with deadline.spared():
            study.fit(Hypothesis(), [np.zeros(study.nominal)])
        turned = EffortStudy(data.recorded(beside[0]), judged.recorded(beside[1]), known, traces=smooth.traces)
        best = searched()
        noises = deadline.attempt(*SMOOTHED_NOISE, lambda: _noises_beside(system, study.data, best), lambda: None)
        if noises is not None:
            tell("noise of the efforts beside what was found")
            smooth, turned = smooth.under(noises), turned.under(noises)
            study = smooth
            with deadline.spared():
                study.fit(Hypothesis(), [np.zeros(study.nominal)])
                study.fit(best.hypothesis, [best.x])
            best = searched()
        deadline.begin(Stage.CRITICISM)
        # Where the time may be up before every member is judged by a fit without it, what stands without a doubt comes first.
        sure = (
            deadline.attempt(*UNJUDGED, lambda: surely_standing(study, best), lambda: None)
            if deadline.limited
            else None
        )
        left = UNPRUNED if sure else UNJUDGED
        stands = deadline.attempt(*left, lambda: standing(study, best), lambda: sure)
        settled = stands and deadline.attempt(*UNWEIGHED, lambda: settle(study, stands), lambda: stands)
        tell("telling")
        deadline.begin(Stage.TELLING)
        claimed = settled or study.fits[frozenset()]
        with deadline.spared():
            if study is not smooth:
                every = [replace(r, quality=(*r.quality, *held_notes(r))) for r in every]
            told = EffortAnswer(system, every, runs, study, claimed, pushes, notes, cutoff, len(train)).document()
    except TimeUp:
        noise = [
            {"channel": f"{name}.effort", "std": data.noises[j].std, "unit": system.joint(name).force_unit}
            for j, name in enumerate(system.joint_names)
            if j in data.joints
        ]
        return nothing_fitted(noise, every, deadline)
    if deadline.not_tried and (settled is None or told.verdict == "consistent"):
        # Nothing is claimed that was not judged, and nothing is called well where not all was tried.
        told = replace(told, verdict="unexplained")
    so_far = (
        "" if settled else f"The best set so far is {' + '.join(best.hypothesis.keys) or 'nothing'}; it is not claimed."
    )
    summary = " ".join(filter(None, [told.summary, so_far, untried(deadline.not_tried)]))
    return replace(told, summary=summary, not_tried=deadline.not_tried)


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


def _known(only: Sequence[str]) -> None:
    for name in only:
        if name not in KNOWN:
            raise InputError(
                f"{name!r} cannot be weighed from efforts", mend=f"leave --fit-effort out, or one of {', '.join(KNOWN)}"
            )


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


def _noises_beside(system: System, data: EffortData, best: EffortFit) -> tuple[EffortNoise, ...] | None:
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


def _note(system: System, run: EffortRun, push: Push) -> QualityNote:
    joint = system.joint_names[push.joint]
    unit = written(system.joint(joint).force_unit)
    return QualityNote(
        "outside_push",
        f"{joint}.effort",
        f"from {push.first:.2f} to {push.last:.2f} s something outside pushes {joint} with up to {-push.peak:+.2g} {unit}: the "
        "motion needs an effort that was not recorded, and no ordinary torque explains it",
        "left out",
        int(np.count_nonzero((run.time >= push.first) & (run.time <= push.last))),
        ((push.first, push.last),),
        abs(push.peak),
    )
