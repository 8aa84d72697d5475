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
from harness.diagnose.inverse.band import band
from harness.diagnose.inverse.effort_answer import EffortAnswer
from harness.diagnose.inverse.effort_fit import EffortFit
from harness.diagnose.inverse.effort_hold import search_either_way
from harness.diagnose.inverse.effort_motion import EffortRun, effort_run
from harness.diagnose.inverse.effort_problem import known_names, noises_beside, posed
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.inverse.effort_settle import settle, standing, surely_standing
from harness.diagnose.inverse.pushes import Push, find_pushes, still_pushing
from harness.diagnose.problem.deadline import Deadline, Stage, TimeUp
from harness.diagnose.problem.held_efforts import held_notes
from harness.diagnose.problem.hypothesis import Hypothesis
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
STILL_PUSHED = (
    "whether what was taken for pushes from outside is one beside what was found",
    "what was found may be what pushes",
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
    known_names(only)
    every = [*recordings, *([held] if held is not None else [])]
    tell("smoothing")
    cutoff = band(system, every)
    whole = [effort_run(system, recording, cutoff) for recording in every]
    for run, recording in zip(whole, every, strict=True):
        if not run.usable.any():
            raise InputError(
                f"nothing can be compared: smoothed below {cutoff:.2g} Hz, no sample of {recording.duration:.3g} s is left "
                "that is away from the ends and at which the joints move",
                mend="record longer or livelier motion, or leave --fit-effort out",
                source=recording.source,
            )
    pushes = find_pushes(system, whole)
    tell("noise of the efforts")
    problem = posed(system, every, whole, pushes, given=held is not None, only=only, deadline=deadline)
    study, turned = problem.smooth, problem.turned

    def told_of(other: EffortStudy) -> None:
        nonlocal study
        study = other

    def searched() -> EffortFit:
        smooth = study
        return deadline.attempt(
            *UNSEARCHED, lambda: search_either_way(smooth, turned, tell, told_of), lambda: study.best()
        )

    try:
        with deadline.spared():
            study.fit(Hypothesis(), [np.zeros(study.nominal)])
        best = searched()
        kept = deadline.attempt(*STILL_PUSHED, lambda: still_pushing(system, whole, pushes, best), lambda: pushes)
        if len(kept) < len(pushes):
            tell("what was taken for pushes from outside")
            pushes = kept
            with deadline.spared():
                problem = posed(system, every, whole, pushes, given=held is not None, only=only, deadline=deadline)
                study, turned = problem.smooth, problem.turned
                study.fit(Hypothesis(), [np.zeros(study.nominal)])
                study.fit(best.hypothesis, [best.x])
            best = searched()
        noises = deadline.attempt(*SMOOTHED_NOISE, lambda: noises_beside(system, study.data, best), lambda: None)
        if noises is not None:
            tell("noise of the efforts beside what was found")
            problem = replace(problem, smooth=problem.smooth.under(noises), turned=problem.turned.under(noises))
            study, turned = problem.smooth, problem.turned
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
        claimed, doubtful = settled or study.fits[frozenset()], frozenset[str]()
        if settled is not None and settled is sure:
            # Numbers lean on what was left out for want of time to judge it: it stays in the fit, and is told as possible.
            claimed, doubtful = best, frozenset(best.hypothesis.keys) - frozenset(sure.hypothesis.keys)
        with deadline.spared():
            if study is not problem.smooth:
                every = [replace(r, quality=(*r.quality, *held_notes(r))) for r in every]
            notes = [_note(system, whole[p.run], p) for p in pushes]
            told = EffortAnswer(
                system, every, problem.runs, study, claimed, pushes, notes, cutoff, problem.train, doubtful
            ).document()
    except TimeUp:
        noise = [
            {"channel": f"{name}.effort", "std": study.data.noises[j].std, "unit": system.joint(name).force_unit}
            for j, name in enumerate(system.joint_names)
            if j in study.data.joints
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
