"""From what was concluded to the answer: findings with intervals, fits before and after, ranking, remainder, next experiment."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from harness.diagnose.answer.augmented import augmented
from harness.diagnose.answer.correlations import correlations
from harness.diagnose.answer.curves import curves
from harness.diagnose.answer.diagnosis import MODIFIED_BY, Diagnosis
from harness.diagnose.answer.explain import NO_FINDING, finding_words, foretelling, plainest, summary, untried
from harness.diagnose.answer.findings import in_words, rivals_of
from harness.diagnose.answer.formula import form_text, formula
from harness.diagnose.answer.left_out import LeftOut, explained_share, left_out
from harness.diagnose.answer.predictive import Predictive, predictive
from harness.diagnose.answer.replay import LONGEST, Opening
from harness.diagnose.answer.significant_digits import estimate
from harness.diagnose.answer.zeros import Zero, zeros_of
from harness.diagnose.claims.averaged import averaged
from harness.diagnose.claims.conclude import Claim, Conclusion
from harness.diagnose.claims.grades import POSSIBLE, foretells, grade, loosened, repeatability, repeated
from harness.diagnose.claims.held_out_only import held_names
from harness.diagnose.claims.model_comparison import why_lost
from harness.diagnose.claims.rivals import ranking as likeliest
from harness.diagnose.claims.rivals import with_the_same
from harness.diagnose.criticism.check import Form
from harness.diagnose.criticism.locate import Mismatch, locate, rmse
from harness.diagnose.criticism.remainder import Remains
from harness.diagnose.estimation.intervals import Estimate, across, estimates, no_more_exact_than_the_law
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.experiment.design import propose
from harness.diagnose.levels.differing_levels import Differing
from harness.diagnose.problem.deadline import Stage
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.investigation import Outcome, as_read, judge, trained
from harness.diagnose.selection.profile_likelihood import as_likely, profiled, spanning
from harness.diagnose.selection.state_evidence import Evidence
from harness.diagnose.selection.study import Study
from harness.parallel import meanwhile
from harness.recording import Recording
from harness.recording.units import written
from harness.system import System

SHOWN = 8  # hypotheses in the ranking
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
PREDICTING = ("the model that predicts best", NO_FINDING)
PROPOSED = ("the next experiment", NO_FINDING)


def answer(
    outcome: Outcome, conclusion: Conclusion, recordings: Sequence[Recording], levels: Differing | None = None
) -> Diagnosis:
    """The answer; recordings: all of them, the one held out too, for what was found of their quality."""
    problem, deadline = outcome.problem, outcome.predictor.deadline
    deadline.begin(Stage.TELLING)
    # Nearly all of it in compiled code: on another thread, if there is one, beside all that follows.
    next_experiment = meanwhile(outcome.predictor.threads, _next, outcome, conclusion)
    noise = [
        {"channel": c.name, "std": std * np.sqrt(problem.train[0].averaged), "unit": c.unit}
        for c, std in zip(problem.channels, outcome.noise, strict=True)
    ]
    places: Sequence[Mismatch] = ()
    if conclusion.verdict != "consistent":
        places = deadline.attempt(*LOCATED, lambda: locate(outcome, *_side_and_site(outcome, conclusion)), lambda: ())
    how = repeated(outcome, conclusion)
    told = deadline.attempt(
        *PROFILED, lambda: _intervals(outcome, conclusion), lambda: _curvatures(outcome, conclusion)
    )
    values = {key: loosened(outcome, how, key, own) for key, own in told.items()}
    claims = {claim.candidate.key: claim for claim in conclusion.claims}
    again = {key: repeatability(outcome, how, key) for key in claims}
    foretold = deadline.attempt(*FORETOLD, lambda: foretells(outcome, conclusion), lambda: False, spared=True)
    grades = {k: grade(outcome, conclusion, claim, values[k], again[k], foretold) for k, claim in claims.items()}
    left = deadline.attempt(*LEFT, lambda: left_out(outcome, conclusion), lambda: None, spared=True)
    form = deadline.attempt(*FORMULA, lambda: formula(outcome, conclusion), lambda: None)
    best = deadline.attempt(*PREDICTING, lambda: predictive(outcome, conclusion), lambda: None)
    zeros: dict[str, list[Zero]] = {key: [] for key in values}
    rows, drawn = deadline.attempt(
        *ERRORS,
        lambda: (
            _fit_rows(outcome, conclusion, best),
            curves(outcome, as_read(outcome, conclusion.own), as_read(outcome, conclusion.held)),
        ),
        lambda: ([], None),
        spared=True,
    )
    if rows:
        zeros = {claim.candidate.key: zeros_of(outcome, conclusion.best, claim.index) for claim in conclusion.claims}
    ranked = deadline.attempt(*RANKED, lambda: _ranking(outcome, conclusion), lambda: _likeliest(outcome, conclusion))
    proposed = next_experiment()
    text = [_summary(outcome, conclusion, values, zeros, rows, grades, left), *([levels.sentence] if levels else [])]
    text += [form.sentence] if form is not None else []
    text += [foretelling(best.fitted.hypothesis.keys, rows)] if best is not None and rows else []
    return Diagnosis(
        verdict=conclusion.verdict,
        summary=" ".join(filter(None, [*text, untried(deadline.not_tried)])),
        noise=noise,
        mismatch=[_mismatch(place) for place in places],
        findings=_findings(outcome, conclusion, values, zeros, grades, again),
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
        correlations=correlations(outcome.predictor, conclusion.own, [c.candidate.key for c in conclusion.claims]),
        not_tried=deadline.not_tried,
    )


def _side_and_site(outcome: Outcome, conclusion: Conclusion) -> tuple[str, str]:
    """What the mismatch is attributed to: the weightiest claim, a reading that nothing named moves, or else the best score test."""
    if conclusion.claims:
        claim = max(conclusion.claims, key=lambda c: c.gain)
        return claim.candidate.effect.side, claim.candidate.site
    if conclusion.remains.significant:
        left = plainest(conclusion)
        if left.exact:
            return "sensor", left.where[0]
    ranked = outcome.study.ranked(outcome.empty)
    if ranked:
        return ranked[0].candidate.effect.side, ranked[0].candidate.site
    system = outcome.problem.system
    return "dynamics", (*system.joint_names, system.links[0].name)[0]


def _units(outcome: Outcome, claim: Claim) -> dict[str, str]:
    member = claim.candidate
    system = outcome.problem.system
    joints = {j.name: j.prismatic for j in system.joints} | {g.name: g.slides for g in system.gimbals}
    unit = next((c.unit for c in outcome.problem.channels if c.name == member.site), "")
    units = member.effect.units(prismatic=joints.get(member.site, False), channel_unit=unit)
    return dict(zip(member.effect.parameter_names, units, strict=True))


def _findings(
    outcome: Outcome, conclusion: Conclusion, values: dict[str, dict[str, Estimate]], zeros: dict[str, list[Zero]],
    grades: dict[str, str], again: dict[str, list[dict[str, Any]]],
) -> list[dict[str, Any]]:  # fmt: skip
    """What is claimed; effects that modify another one at their site are told with it."""
    own = [
        (
            c.candidate,
            {
                **_finding(outcome, c, values[c.candidate.key], zeros[c.candidate.key], conclusion.only_held),
                "grade": grades[c.candidate.key],
                **({"repeatability": again[c.candidate.key]} if again[c.candidate.key] else {}),
            },
        )
        for c in conclusion.claims
    ]
    whole = []
    for member, finding in own:
        kept = (f for c, f in own if c.site == member.site and c.effect.name in member.effect.modifies)
        modified = next(kept, None)
        if modified is None:
            whole.append(finding)
        else:
            modified.setdefault(MODIFIED_BY, []).append(finding)
    return whole


def _finding(
    outcome: Outcome, claim: Claim, values: dict[str, Estimate], zeros: list[Zero], only_held: Sequence[str]
) -> dict[str, Any]:
    units = _units(outcome, claim)
    return {
        "effect": claim.candidate.effect.name,
        "site": claim.candidate.site,
        "parameters": {
            name: {"value": e.value, "std": e.std, "ci95": [e.low, e.high], "unit": units[name]}
            for name, e in values.items()
        },
        "evidence": {
            "delta_bic": claim.delta_bic,
            "probability": claim.probability,
            "class_probability": claim.of_class,
            "heldout_sigma": claim.heldout_z,
        },
        **_rivals(claim),
        **({"zeros": zeros} if zeros else {}),
        **({"shows_only_in": held_names(outcome)} if claim.candidate.key in only_held else {}),
    }


def _rivals(claim: Claim) -> dict[str, Any]:
    """What a claim cannot be told from, as it stands in its finding."""
    site = claim.candidate.site
    beside = {_short(key, site): list(partners) for key, partners in claim.beside.items()}
    told = [_short(rival.key, site) for rival in _plainest_first(claim)]
    return {"indistinguishable_from": told, **({"only_beside": beside} if beside else {})}


def _plainest_first(claim: Claim) -> list[Candidate]:
    """What a claim cannot be told from; where laws act alike, the plain one is met more often than its fit says."""
    return sorted(claim.rival_candidates, key=lambda rival: rival.effect.plainness)


def _plainer(claim: Claim) -> list[Candidate]:
    """Rivals at the same place that are plainer than what is claimed, and could stand there by themselves."""
    own = claim.candidate
    return [
        rival
        for rival in _plainest_first(claim)
        if rival.site == own.site
        and rival.effect.side == own.effect.side
        and rival.key not in claim.beside
        and rival.effect.plainness < own.effect.plainness
    ]


def _short(key: str, site: str) -> str:
    """The effect's name alone where it sits at the same site, else with its own."""
    name, _, at = key.partition("@")
    return name if at == site else key


def _intervals(outcome: Outcome, conclusion: Conclusion) -> dict[str, dict[str, Estimate]]:
    """Estimates of what is claimed, by the effect's key: as far as other valleys and other sets that are as likely let them be."""
    study, predictor, best = outcome.study, outcome.predictor, conclusion.best
    if outcome.evidence is not None and not conclusion.by_free_runs:
        return _beside_the_force(outcome, conclusion, outcome.evidence)
    # What shows in the data held out alone can only be told by them.
    source = outcome.study if conclusion.only_held else outcome.training
    own = source.sharpened(best if conclusion.only_held else conclusion.own)
    same = conclusion.own.hypothesis.keys == best.hypothesis.keys
    sharp: dict[frozenset[str], Fit] = {}
    values = {}
    for claim in conclusion.claims:
        k, key = claim.index, claim.candidate.key
        likely = with_the_same(outcome, best, key)
        sharp |= {f.hypothesis.identity: study.sharpened(f) for f in likely if f.hypothesis.identity not in sharp}
        others = (sharp[f.hypothesis.identity] for f in likely)
        alone = profiled(source, own, k, estimates(predictor, own, k))
        reached = across(
            claim.candidate,
            spanning(claim.candidate, alone, as_likely(study, best, k) if same else []),
            [estimates(predictor, f, f.hypothesis.keys.index(key)) for f in others],
        )
        values[key] = no_more_exact_than_the_law(claim.candidate, reached)
    return values


def _beside_the_force(
    outcome: Outcome, conclusion: Conclusion, evidence: Evidence, *, at_hand: bool = False
) -> dict[str, dict[str, Estimate]]:
    """Estimates of what is claimed beside a force over the state."""
    members = {claim.candidate.key: claim.candidate for claim in conclusion.claims}
    found = averaged(outcome, evidence, conclusion.own, at_hand=at_hand)
    return {key: no_more_exact_than_the_law(member, found[key]) for key, member in members.items()}


def _curvatures(outcome: Outcome, conclusion: Conclusion) -> dict[str, dict[str, Estimate]]:
    """The same by what is at hand: the curvature of the one fit alone, or sets that have been looked at beside a force."""
    if outcome.evidence is not None and not conclusion.by_free_runs:
        return _beside_the_force(outcome, conclusion, outcome.evidence, at_hand=True)
    return {
        claim.candidate.key: estimates(
            outcome.predictor, conclusion.own, conclusion.own.hypothesis.keys.index(claim.candidate.key)
        )
        for claim in conclusion.claims
    }


def _summary(
    outcome: Outcome, conclusion: Conclusion, values: dict[str, dict[str, Estimate]], zeros: dict[str, list[Zero]],
    rows: Sequence[dict[str, Any]], grades: dict[str, str], left: LeftOut | None,
) -> str:  # fmt: skip
    """The answer in plain words; rows: of every channel, how well it is fitted and foretold."""
    severity = max((row["nominal"]["train_rmse"] / row["noise_floor"] for row in rows), default=np.nan)
    foretold = max((row["augmented"]["heldout_rmse"] / row["noise_floor"] for row in rows), default=0.0)
    titles = [
        (
            c.candidate,
            finding_words(
                c.candidate.effect.title,
                c.candidate.site,
                values[c.candidate.key],
                _units(outcome, c),
                [
                    f"{z['recording']} {estimate(z['zero'], None, None, written(z['unit']))}"
                    for z in zeros[c.candidate.key]
                ],
                [rival.effect.title for rival in _plainer(c)],
            ),
        )
        for c in sorted(conclusion.claims, key=lambda c: bool(c.candidate.effect.modifies))
    ]
    firm = [words for member, words in titles if grades[member.key] != POSSIBLE]
    # Laws that can be bent to many shapes are told in the table alone.
    possible = [words for _, words in titles] if all(member.effect.plain for member, _ in titles) else []
    rivals = [
        f"{c.candidate.effect.title.capitalize()} cannot be told here from "
        + ", ".join(rivals_of(_rivals(c), in_words))
        + "."
        for c in conclusion.claims
        if c.rivals and grades[c.candidate.key] != POSSIBLE
    ]
    return summary(conclusion, severity, firm, rivals, foretold, explained_share(rows), left, possible)


def _mismatch(place: Mismatch) -> dict[str, Any]:
    return {
        "channel": place.channel, "side": place.side, "site": place.site, "time": [list(t) for t in place.time],
        "frequency_hz": list(place.frequency_hz), "region": {k: list(v) for k, v in place.region.items()},
        "severity": place.severity, "what": place.what,
    }  # fmt: skip


def _fit_rows(outcome: Outcome, conclusion: Conclusion, best: Predictive | None = None) -> list[dict[str, Any]]:
    """Errors of every channel before and after, on the data fitted and on those held out."""
    fits = {
        "nominal": (outcome.nominal, judge(outcome, outcome.nominal)),
        "refitted": (trained(outcome, outcome.empty), judge(outcome, outcome.empty)),
        "augmented": (conclusion.own, conclusion.held),
        **({"predictive": (best.fitted, best.held)} if best is not None else {}),
    }
    rows = []
    for c, channel in enumerate(outcome.problem.channels):
        row: dict[str, Any] = {"channel": channel.name, "unit": channel.unit}
        for name, (train, held) in fits.items():
            train, held = as_read(outcome, train), as_read(outcome, held)
            row[name] = {"train_rmse": rmse(outcome, train, c), "heldout_rmse": rmse(outcome, held, c)}
        rows.append({**row, "noise_floor": outcome.noise[c]})
    return rows


def _likeliest(outcome: Outcome, conclusion: Conclusion) -> list[dict[str, Any]]:
    """The same without their errors and why they lost."""
    study = outcome.study
    return [
        {"effects": list(f.hypothesis.keys), "bic": f.score + study.paid(f), "heldout_rmse": None, "lost": ""}
        for f in likeliest(outcome, conclusion.best, SHOWN)
    ]


def _ranking(outcome: Outcome, conclusion: Conclusion) -> list[dict[str, Any]]:
    """The likeliest hypotheses, the one claimed first, and why the others lost."""
    study, best = outcome.study, conclusion.best
    own = rmse(outcome, as_read(outcome, judge(outcome, best)), 0)
    rows: list[dict[str, Any]] = []
    for fitted in likeliest(outcome, best, SHOWN):
        error = rmse(outcome, as_read(outcome, judge(outcome, fitted)), 0)
        # A set that fits better and was not taken beside a force over the state is one whose work that force does as well.
        imitated = conclusion.imitated if outcome.evidence is None else fitted.hypothesis.keys
        rows.append(
            {
                "effects": list(fitted.hypothesis.keys),
                "bic": fitted.score + study.paid(fitted),
                "heldout_rmse": error,
                "lost": why_lost(study, best, fitted, error, own, imitated),
            }
        )
    return rows


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
    count = int(min(LONGEST, run.time[window.last - 1] - run.time[window.first]) / run.interval)
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


def _differing_in(study: Study, best: Fit, claim: Claim, rival: Candidate) -> tuple[Fit, Fit | None]:
    """Two fits that differ by a claim and its rival alone: of the best set, or of one with another effect beside both."""
    kept = best.hypothesis.identity - {claim.candidate.key}
    if rival.key not in claim.beside:
        return best, study.fits.get(kept | {rival.key})
    for key in kept:
        for partner in claim.beside[rival.key]:
            rest = (kept - {key}) | {partner}
            first, other = study.fits.get(rest | {claim.candidate.key}), study.fits.get(rest | {rival.key})
            if first is not None and other is not None:
                return first, other
    return best, None


def _next(outcome: Outcome, conclusion: Conclusion) -> dict[str, Any]:
    """The experiment that would part what these recordings cannot; none if there was no time to look for it."""
    return outcome.predictor.deadline.attempt(
        *PROPOSED, lambda: _proposed(outcome, conclusion), lambda: {"what": "", "separates": []}
    )


def _proposed(outcome: Outcome, conclusion: Conclusion) -> dict[str, Any]:
    study = outcome.study
    pairs: list[tuple[Fit, Fit, tuple[str, ...]]] = []
    for claim in conclusion.claims:
        for rival in claim.rival_candidates:
            first, other = _differing_in(study, conclusion.best, claim, rival)
            if other is not None:
                pairs.append((first, other, (claim.candidate.effect.name, rival.effect.name)))
    if not pairs and conclusion.best.hypothesis.members:
        # Nothing is left open; the runner-up would still be the first to doubt.
        for other in outcome.ordered:
            names = {m.effect.name for m in other.hypothesis.members} ^ {
                m.effect.name for m in conclusion.best.hypothesis.members
            }
            if names and len(other.hypothesis.members) == len(conclusion.best.hypothesis.members):
                pairs.append((conclusion.best, other, tuple(sorted(names))))
                break
    proposal = propose(study, pairs[:3])
    if proposal is None:
        return {"what": "", "separates": []}
    return {"what": proposal.what, "separates": list(proposal.separates), "expected_sigma": proposal.separation}
