"""From what was concluded to the answer: findings with intervals, fits before and after, ranking, remainder, next experiment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from harness.diagnose.answer.against_nominal import astray, beside_findings, nothing_added, within_tolerances
from harness.diagnose.answer.augmented import augmented
from harness.diagnose.answer.claims_as_data import finding_rows, plainer_rivals, rivals_as_data, units_of
from harness.diagnose.answer.constants import (
    INTERVALS_SHARE,
    POSSIBLY_EXPLAINED_SHARE,
    PREDICTING_SHARE,
    REPLAY_TIME,
)
from harness.diagnose.answer.correlations import correlations
from harness.diagnose.answer.curves import curves
from harness.diagnose.answer.diagnosis import Diagnosis
from harness.diagnose.answer.disagreement_words import disagreement_words
from harness.diagnose.answer.errors_told import fit_rows, likeliest_sets, ranking
from harness.diagnose.answer.explain import (
    NO_FINDING,
    Foretold,
    finding_words,
    foretelling,
    plainest,
    summary,
    untold,
    untried,
)
from harness.diagnose.answer.findings import in_words, rivals_of
from harness.diagnose.answer.formula import form_text, formula
from harness.diagnose.answer.intervals_told import curvatures, intervals
from harness.diagnose.answer.kinds_told import certain_dissipation
from harness.diagnose.answer.left_out import LeftOut, explained_share, left_out
from harness.diagnose.answer.next_experiment import next_experiment
from harness.diagnose.answer.predictive import predictive
from harness.diagnose.answer.replay import Opening
from harness.diagnose.answer.significant_digits import estimate
from harness.diagnose.answer.zeros import Zero, zeros_of
from harness.diagnose.claims.conclude import Conclusion
from harness.diagnose.claims.grades import (
    POSSIBLE,
    foretells,
    grade,
    loosened,
    may_be_absent,
    no_firmer_than_its_law,
    repeatability,
    repeated,
    verdict_of,
)
from harness.diagnose.criticism.check import Form
from harness.diagnose.criticism.locate import Mismatch, locate
from harness.diagnose.criticism.remainder import Remains
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.levels.between_recordings import Between, between_recordings
from harness.diagnose.levels.differing_levels import Differing
from harness.diagnose.levels.disagreement import Disagreement
from harness.diagnose.problem.deadline import Stage
from harness.diagnose.selection.outcome import Outcome, as_read
from harness.effects.effect import Family
from harness.parallel import meanwhile
from harness.recording import Recording
from harness.recording.units import written
from harness.system import System

# What may be left if the time is up, and what that may change.
LOCATED = ("where the mismatch lies", NO_FINDING)
FORETOLD = (
    "whether what was found foretells the data held out better than the nominal model",
    "what was found may be firmer than it is told",
)
PROFILED = ("other valleys and other sets in which a parameter may lie", "intervals may be too narrow")
RANKED = ("the errors of other sets on data held out", NO_FINDING)
ERRORS = ("errors before and after", NO_FINDING)
LEFT = ("where the force that is left out lies", NO_FINDING)
FORMULA = ("what the force that is left out looks like", NO_FINDING)
BETWEEN = ("by how much friction and efforts differ between recordings", NO_FINDING)
REPEATED = ("how numbers spread over the recordings", "intervals may be too narrow")
PREDICTING = ("the model that predicts best", NO_FINDING)


def answer(
    outcome: Outcome, conclusion: Conclusion, recordings: Sequence[Recording], levels: Differing | None = None,
    apart: Disagreement | None = None,
) -> Diagnosis:  # fmt: skip
    """The answer; recordings: all of them, the one held out too, for what was found of their quality. apart: what each of them
    says by itself, where they disagree."""
    problem, deadline = outcome.problem, outcome.predictor.deadline
    deadline.begin(Stage.TELLING)
    # Nearly all of it in compiled code: on another thread, if there is one, beside all that follows.
    proposal = meanwhile(outcome.predictor.threads, next_experiment, outcome, conclusion)
    noise = [
        {"channel": c.name, "std": std * np.sqrt(problem.train[0].averaged), "unit": c.unit}
        for c, std in zip(problem.channels, outcome.noise, strict=True)
    ]
    places: Sequence[Mismatch] = ()
    if conclusion.verdict != "consistent":
        places = deadline.attempt(*LOCATED, lambda: locate(outcome, *_side_and_site(outcome, conclusion)), lambda: ())
    how = deadline.attempt(*REPEATED, lambda: repeated(outcome, conclusion), lambda: None)
    told = deadline.attempt(
        *PROFILED,
        lambda: intervals(outcome, conclusion),
        lambda: curvatures(outcome, conclusion),
        share=INTERVALS_SHARE,
    )
    values = {key: loosened(outcome, how, key, own) for key, own in told.items()}
    claims = {claim.candidate.key: claim for claim in conclusion.claims}
    again = {key: repeatability(outcome, how, key) for key in claims}
    foretold = deadline.attempt(*FORETOLD, lambda: foretells(outcome, conclusion), lambda: False, spared=True)
    each = {k: grade(outcome, conclusion, claim, values[k], again[k], foretold) for k, claim in claims.items()}
    grades = no_firmer_than_its_law(claims, each)
    # Beside laws that were not searched to the end, what each recording lacks of these would be friction of its own.
    between = (
        Between()
        if conclusion.hurried
        else deadline.attempt(*BETWEEN, lambda: between_recordings(outcome, conclusion.best), Between)
    )
    left = deadline.attempt(*LEFT, lambda: left_out(outcome, conclusion, between), lambda: None, spared=True)
    form = deadline.attempt(*FORMULA, lambda: formula(outcome, conclusion), lambda: None)
    best = deadline.attempt(*PREDICTING, lambda: predictive(outcome, conclusion), lambda: None, share=PREDICTING_SHARE)
    zeros: dict[str, list[Zero]] = {key: [] for key in values}
    rows, drawn = deadline.attempt(
        *ERRORS,
        lambda: (
            fit_rows(outcome, conclusion, best),
            curves(outcome, as_read(outcome, conclusion.own), as_read(outcome, conclusion.held)),
        ),
        lambda: ([], None),
        spared=True,
    )
    if rows:
        zeros = {claim.candidate.key: zeros_of(outcome, conclusion.best, claim.index) for claim in conclusion.claims}
    ranked = deadline.attempt(
        *RANKED, lambda: ranking(outcome, conclusion), lambda: likeliest_sets(outcome, conclusion)
    )
    proposed = proposal()
    text = [_summary(outcome, conclusion, values, zeros, rows, grades, left), *([levels.sentence] if levels else [])]
    firm = [c.candidate for c in conclusion.claims if grades[c.candidate.key] != POSSIBLE]
    removed = explained_share(rows)
    if not conclusion.hurried and removed is not None and removed > POSSIBLY_EXPLAINED_SHARE:
        braked = [member.site for member in firm if member.effect.family is Family.DISSIPATION]
        text += [certain_dissipation(outcome, braked)]
    text += [disagreement_words(apart, problem)]
    text += [form.sentence] if form is not None else []
    own = conclusion.own
    if conclusion.claims:
        text += beside_findings(outcome.predictor.nominal, own.x, rows)
    else:
        text.append(nothing_added(outcome.predictor.nominal, own.x, rows, beside=bool(own.hypothesis.members)))
    text += [foretelling(best.fitted.hypothesis.keys, rows)] if best is not None and rows else []
    return Diagnosis(
        verdict=verdict_of(conclusion.verdict, grades.values()),
        summary=" ".join(filter(None, [*text, untried(deadline.not_tried)])),
        noise=noise,
        mismatch=[_mismatch(place) for place in places],
        findings=finding_rows(outcome, conclusion, values, zeros, grades, again),
        ranking=ranked,
        fit=rows,
        remainder=_remainder(
            problem.system,
            conclusion.remains,
            conclusion.doubted,
            outcome.force is not None,
            form.form if form is not None else conclusion.remains.form,
        ),
        explained_share=explained_share(rows),
        discrepancy=left.document() if left is not None else [],
        predicting=best.fitted.hypothesis.keys if best is not None else (),
        predictive=best.system if best is not None else None,
        unnamed_force=best.table if best is not None else None,
        next_experiment=proposed,
        quality=[
            {"recording": r.name, "kind": n.kind, "channel": n.channel, "what": n.what, "done": n.done}
            for r in recordings
            for n in getattr(r, "quality", ())
        ],
        augmented=augmented(
            problem.system,
            outcome.predictor.nominal,
            conclusion.own.x,
            ((claim.candidate, values[claim.candidate.key]) for claim in conclusion.claims),
        ),
        curves=drawn,
        opening=_opening(outcome, conclusion, {str(item["channel"]): float(item["std"]) for item in noise}),
        levels=levels.document if levels else None,
        levelled=levels.system if levels else None,
        disagreement=apart.document([units_of(problem, m) for m in apart.members]) if apart else None,
        correlations=correlations(outcome.predictor, conclusion.own, [c.candidate.key for c in conclusion.claims]),
        not_tried=deadline.not_tried,
    )


def _side_and_site(outcome: Outcome, conclusion: Conclusion) -> tuple[str, str]:
    """What the mismatch is attributed to: the weightiest claim, a reading that nothing named moves, or else the best score test."""
    if conclusion.claims:
        claim = max(conclusion.claims, key=lambda c: c.gain)
        return claim.candidate.effect.side, claim.candidate.site
    if conclusion.remains.significant and conclusion.remains.tests:
        left = plainest(conclusion)
        if left.exact:
            return "sensor", left.where[0]
    ranked = outcome.study.ranked(outcome.empty)
    if ranked:
        return ranked[0].candidate.effect.side, ranked[0].candidate.site
    system = outcome.problem.system
    return "dynamics", (*system.joint_names, system.links[0].name)[0]


def _summary(
    outcome: Outcome, conclusion: Conclusion, values: dict[str, dict[str, Estimate]], zeros: dict[str, list[Zero]],
    rows: Sequence[dict[str, Any]], grades: dict[str, str], left: LeftOut | None,
) -> str:  # fmt: skip
    """The answer in plain words; rows: of every channel, how well it is fitted and foretold."""
    severity, refitted = (
        max((row[model]["train_rmse"] / row["noise_floor"] for row in rows), default=np.nan)
        for model in ("nominal", "refitted")
    )
    titles = [
        (
            c.candidate,
            finding_words(
                c.candidate.effect.title,
                c.candidate.site,
                values[c.candidate.key],
                units_of(outcome.problem, c.candidate),
                [
                    f"{z['recording']} {estimate(z['zero'], None, None, written(z['unit']))}"
                    for z in zeros[c.candidate.key]
                ],
                [rival.effect.title for rival in plainer_rivals(c)],
            ),
        )
        for c in sorted(conclusion.claims, key=lambda c: bool(c.candidate.effect.modifies))
    ]
    firm = [words for member, words in titles if grades[member.key] != POSSIBLE]
    # What can be bent to many shapes is told in the table alone, and so is what may as well be absent.
    there = [(m, words) for m, words in titles if not may_be_absent(m, values[m.key])]
    possible = [words for _, words in there] if all(member.effect.usual for member, _ in there) else []
    if possible and len(there) < len(titles):
        possible[-1] += ", with what else the table has"
    rivals = [
        untold(c.candidate.effect.title, c.candidate.site, rivals_of(rivals_as_data(c), in_words))
        for c in conclusion.claims
        if c.rivals and grades[c.candidate.key] != POSSIBLE
    ]
    return summary(
        conclusion, severity, firm, rivals, Foretold.worst(rows), explained_share(rows), left, possible,
        beside=len(firm) < len(titles), within=refitted if rows and within_tolerances(outcome) else None,
        astray=astray(outcome, rows),
    )  # fmt: skip


def _mismatch(place: Mismatch) -> dict[str, Any]:
    return {
        "channel": place.channel, "side": place.side, "site": place.site, "time": [list(t) for t in place.time],
        "frequency_hz": list(place.frequency_hz), "region": {k: list(v) for k, v in place.region.items()},
        "severity": place.severity, "what": place.what,
    }  # fmt: skip


def _remainder(
    system: System, remains: Remains, doubted: Sequence[str], force: bool, form: Form | None
) -> dict[str, Any]:
    """What is left: its tests, its sparsest form and its map; force: whether one is left out that has no shape."""
    found: dict[str, Any] = {
        "significant": remains.significant or force,
        "tests": [{"what": t.name, "gain": t.gain, "chance": t.chance, "where": list(t.where)} for t in remains.tests],
        "doubted": list(doubted),
    }
    if form is not None:
        found["residual_torque"] = form_text(form, system)
    if remains.force_map is not None:
        m = remains.force_map
        found["map"] = {"joint": m.joint, "position": m.position, "velocity": m.velocity, "torque": m.force}
    return found


def _opening(outcome: Outcome, conclusion: Conclusion, noise: dict[str, float]) -> Opening:
    """The start of the recording held out, as the model that is told was fitted to it."""
    window = outcome.held_windows[0]
    run = outcome.problem.runs[window.run]
    names = outcome.predictor.mechanism(conclusion.own.hypothesis).names
    state = conclusion.held.states[window]
    if outcome.problem.system.loops:
        own = conclusion.own
        model = outcome.predictor.mechanism(own.hypothesis).model
        state = model.closed(outcome.predictor.row(own.hypothesis, own.x)[None], state[None])[0]
    count = int(min(REPLAY_TIME, run.time[window.last - 1] - run.time[window.first]) / run.interval)
    time = np.arange(count + 1, dtype=np.float64) * run.interval
    tau = None
    if run.effort is not None:
        coordinates = outcome.problem.system.coordinate_names
        tau = np.zeros((len(time), len(coordinates)))
        stamps = run.time - run.time[window.first]
        for column, joint in enumerate(outcome.problem.system.joint_names):
            tau[:, coordinates.index(joint)] = np.interp(time, stamps, run.effort[:, column])
    position, velocity = (dict(zip(names, part.tolist(), strict=True)) for part in np.split(state, 2))
    return Opening(run.name, position, velocity, time, tau, noise, outcome.predictor.hold, run.payload)
