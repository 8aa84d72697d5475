"""``diagnose``: from recordings and a nominal model to what the model left out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.diagnose.candidates import candidates
from harness.diagnose.conclude import Claim, Conclusion, conclude
from harness.diagnose.curves import curves
from harness.diagnose.diagnosis import Diagnosis
from harness.diagnose.differing_levels import Differing, differing_levels
from harness.diagnose.effort import diagnose_effort
from harness.diagnose.experiment import propose
from harness.diagnose.explain import finding_words, summary
from harness.diagnose.fit import Fit
from harness.diagnose.free_motion import free_part
from harness.diagnose.hypothesis import Hypothesis, scaled
from harness.diagnose.investigate import Outcome, investigate, judge, trained
from harness.diagnose.locate import locate, rmse
from harness.diagnose.lost import why_lost
from harness.diagnose.problem import pose
from harness.diagnose.profile_likelihood import as_likely, profiled, spanning
from harness.diagnose.replay import LONGEST, Opening
from harness.diagnose.rivals import ranking as likeliest
from harness.diagnose.rivals import with_the_same
from harness.diagnose.search import Effort
from harness.diagnose.study import BEGUN
from harness.diagnose.uncertainty import Estimate, across, estimates
from harness.effects.effect import Effect
from harness.effects.scale import references
from harness.effects.user import load_user_effects
from harness.errors import InputError
from harness.parallel import one_blas_thread
from harness.recording import Recording, read_recordings
from harness.system import Attachment, System, load

Progress = Callable[[int, int, str], None]
# Dissipation that a model states itself: parameter of the effect, and field of the joint.
STATED = {"viscous_damping": ("coefficient", "damping"), "coulomb_friction": ("torque", "friction")}
SHOWN = 8  # hypotheses in the ranking


@one_blas_thread()
def diagnose(
    recordings: Sequence[str | Path | Recording],
    model: str | Path | System,
    *,
    holdout: str | Path | Recording | None = None,
    mapping: Sequence[str] = (),
    tolerance: float | None = None,
    fit_effort: bool = False,
    effects: Sequence[str | Path | Effect] = (),
    only: Sequence[str] = (),
    effort: Effort | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Locate where a model leaves recordings, name the physics it left out, and judge the improvement on data held out.

    recordings: files or ``Recording``; the last of several is held out, or the last 30 % of a single one. model: file or System.
    holdout: recording to judge on instead. mapping: rules for foreign columns. tolerance: relative 1σ of the nominal masses,
    lengths, inertias and stiffnesses, overriding the model's. fit_effort: efforts are measurements to fit, not known inputs (see
    ``diagnose_effort``). effects: effects of the user's own. only: restricts the catalogue
    to these names. progress: called with (done, total, what).
    Raises InputError for recordings or models that cannot be used.
    """
    if isinstance(recordings, (str, Path, Recording)):
        recordings = [recordings]
    system = model if isinstance(model, System) else load(model, physical=False)
    if tolerance is not None:
        if not 0.0 < tolerance < 1.0:
            raise InputError(f"tolerance {tolerance:g} is not between 0 and 1", mend="give a relative 1σ such as 0.01")
        system = replace(system, tolerance=tolerance)
    read = [free_part(system, recording) for recording in _read(recordings, holdout, mapping, system)]
    held = read.pop() if holdout is not None else None
    steps = 0

    def tell(what: str) -> None:
        nonlocal steps
        steps += 1
        if progress is not None:
            progress(steps, max(40, steps + 5), what)

    tell("reading")
    further = [e for item in effects for e in ([item] if isinstance(item, Effect) else load_user_effects(item))]
    if fit_effort:
        return diagnose_effort(system, read, held, only=only, further=further, tell=tell)
    problem = pose(system, read, heldout=held)
    every = [*read, *([held] if held is not None else [])]
    known = candidates(system, every, only=only, further=further)
    frequency = references(system, system.joint_names[0], read[0]).frequency / (2.0 * np.pi)
    outcome = investigate(problem, known, frequency, effort=effort, progress=tell)
    conclusion = conclude(outcome)
    train, judged = (read, [held]) if held is not None else (read[:-1], read[-1:])
    levels = differing_levels(outcome, conclusion, train, judged)
    tell("telling")
    return _tell(outcome, conclusion, every, levels)


def _read(
    recordings: Sequence[str | Path | Recording],
    holdout: str | Path | Recording | None,
    mapping: Sequence[str],
    system: System,
) -> list[Recording]:
    items = [*recordings, *([holdout] if holdout is not None else [])]
    paths = [item for item in items if not isinstance(item, Recording)]
    from_files = iter(read_recordings(paths, mapping=mapping, system=system)) if paths else iter(())
    found = [item if isinstance(item, Recording) else next(from_files) for item in items]
    if not found:
        raise InputError("no recording given", mend="name at least one recording file")
    return found


def _side_and_site(outcome: Outcome, conclusion: Conclusion) -> tuple[str, str]:
    """What the mismatch is attributed to: the weightiest claim, else the best score test of the empty hypothesis."""
    if conclusion.claims:
        claim = max(conclusion.claims, key=lambda c: c.gain)
        return claim.candidate.effect.side, claim.candidate.site
    ranked = outcome.study.ranked(outcome.empty)
    if ranked:
        return ranked[0].candidate.effect.side, ranked[0].candidate.site
    return "dynamics", outcome.problem.system.joint_names[0]


def _units(outcome: Outcome, claim: Claim) -> dict[str, str]:
    member = claim.candidate
    joints = {j.name: j.prismatic for j in outcome.problem.system.joints}
    unit = next((c.unit for c in outcome.problem.channels if c.name == member.site), "")
    units = member.effect.units(prismatic=joints.get(member.site, False), channel_unit=unit)
    return dict(zip(member.effect.parameter_names, units, strict=True))


def _finding(outcome: Outcome, claim: Claim, values: dict[str, Estimate]) -> dict[str, Any]:
    units = _units(outcome, claim)
    return {
        "effect": claim.candidate.effect.name,
        "site": claim.candidate.site,
        "parameters": {
            name: {"value": e.value, "std": e.std, "ci95": [e.low, e.high], "unit": units[name]}
            for name, e in values.items()
        },
        "evidence": {"delta_bic": claim.delta_bic, "probability": claim.probability, "heldout_sigma": claim.heldout_z},
        "indistinguishable_from": [_short(key, claim.candidate.site) for key in claim.rivals],
    }


def _short(key: str, site: str) -> str:
    """The effect's name alone where it sits at the same site, else with its own."""
    name, _, at = key.partition("@")
    return name if at == site else key


def _intervals(outcome: Outcome, conclusion: Conclusion) -> dict[str, dict[str, Estimate]]:
    """Estimates of what is claimed, by the effect's key: as far as other valleys and other sets that are as likely let them be."""
    study, predictor, best = outcome.study, outcome.predictor, conclusion.best
    own = outcome.training.sharpened(conclusion.own)
    same = conclusion.own.hypothesis.keys == best.hypothesis.keys
    sharp: dict[frozenset[str], Fit] = {}
    values = {}
    for claim in conclusion.claims:
        k, key = claim.index, claim.candidate.key
        likely = with_the_same(outcome, best, key)
        sharp |= {f.hypothesis.identity: study.sharpened(f) for f in likely if f.hypothesis.identity not in sharp}
        others = (sharp[f.hypothesis.identity] for f in likely)
        alone = profiled(outcome.training, own, k, estimates(predictor, own, k))
        values[key] = across(
            spanning(own.hypothesis.members[k], alone, as_likely(study, best, k) if same else []),
            [estimates(predictor, f, f.hypothesis.keys.index(key)) for f in others],
        )
    return values


def _tell(
    outcome: Outcome, conclusion: Conclusion, recordings: Sequence[Recording], levels: Differing | None = None
) -> Diagnosis:
    problem, study = outcome.problem, outcome.study
    noise = [
        {"channel": c.name, "std": colour.std * np.sqrt(problem.train[0].averaged), "unit": c.unit}
        for c, colour in zip(problem.channels, study.likelihood.colours, strict=True)
    ]
    side, site = _side_and_site(outcome, conclusion)
    places = locate(outcome, side, site) if conclusion.verdict != "consistent" else ()
    values = _intervals(outcome, conclusion)
    findings = [_finding(outcome, claim, values[claim.candidate.key]) for claim in conclusion.claims]
    nominal_held = judge(outcome, outcome.nominal)
    empty_held = judge(outcome, outcome.empty)
    fits = []
    severity = 0.0
    for c, channel in enumerate(problem.channels):
        floor = study.likelihood.colours[c].std
        train = rmse(outcome, outcome.nominal, c)
        severity = max(severity, train / floor)
        fits.append(
            {
                "channel": channel.name,
                "unit": channel.unit,
                "nominal": {"train_rmse": train, "heldout_rmse": rmse(outcome, nominal_held, c)},
                "refitted": {
                    "train_rmse": rmse(outcome, trained(outcome, outcome.empty), c),
                    "heldout_rmse": rmse(outcome, empty_held, c),
                },
                "augmented": {
                    "train_rmse": rmse(outcome, conclusion.own, c),
                    "heldout_rmse": rmse(outcome, conclusion.held, c),
                },
                "noise_floor": floor,
            }
        )
    ranking = []
    log_n = float(np.log(study.samples))
    for fitted in likeliest(outcome, conclusion.best, SHOWN):
        error = rmse(outcome, judge(outcome, fitted), 0)
        ranking.append(
            {
                "effects": list(fitted.hypothesis.keys),
                "bic": fitted.score + fitted.hypothesis.size * log_n + BEGUN * fitted.vibrating,
                "heldout_rmse": error,
                "lost": why_lost(
                    study, conclusion.best, fitted, error, rmse(outcome, conclusion.held, 0), conclusion.doubted
                ),
            }
        )
    titles = [
        finding_words(c.candidate.effect.title, c.candidate.site, values[c.candidate.key], _units(outcome, c))
        for c in conclusion.claims
    ]
    rivals = [
        f"{c.candidate.effect.title.capitalize()} cannot be told here from "
        + ", ".join(_short(k, c.candidate.site) for k in c.rivals)
        + "."
        for c in conclusion.claims
        if c.rivals
    ]
    remainder: dict[str, Any] = {
        "significant": conclusion.remains.significant,
        "tests": [
            {"what": t.name, "gain": t.gain, "chance": t.chance, "where": list(t.where)}
            for t in conclusion.remains.tests
        ],
        "doubted": list(conclusion.doubted),
    }
    if conclusion.remains.form is not None:
        remainder["residual_torque"] = f"at {conclusion.remains.form.joint}: {conclusion.remains.form} N·m"
    if conclusion.remains.force_map is not None:
        m = conclusion.remains.force_map
        remainder["map"] = {"joint": m.joint, "position": m.position, "velocity": m.velocity, "torque": m.force}
    quality = [
        {"recording": r.name, "kind": n.kind, "channel": n.channel, "what": n.what, "done": n.done}
        for r in recordings
        for n in getattr(r, "quality", ())
    ]
    return Diagnosis(
        verdict=conclusion.verdict,
        summary=" ".join(
            [summary(conclusion, severity, titles, rivals, conclusion.doubted), *([levels.sentence] if levels else [])]
        ),
        noise=noise,
        mismatch=[
            {
                "channel": m.channel, "side": m.side, "site": m.site, "time": [list(t) for t in m.time],
                "frequency_hz": list(m.frequency_hz), "region": {k: list(v) for k, v in m.region.items()},
                "severity": m.severity, "what": m.what,
            }
            for m in places
        ],
        findings=findings,
        ranking=ranking,
        fit=fits,
        remainder=remainder,
        next_experiment=_next(outcome, conclusion),
        quality=quality,
        augmented=augmented(outcome, conclusion, values),
        curves=curves(outcome, conclusion.own, conclusion.held),
        opening=_opening(outcome, conclusion, {str(item["channel"]): float(item["std"]) for item in noise}),
        levels=levels.document if levels else None,
        levelled=levels.system if levels else None,
    )  # fmt: skip


def _opening(outcome: Outcome, conclusion: Conclusion, noise: dict[str, float]) -> Opening:
    """The start of the recording held out, as the model that is told was fitted to it."""
    window = outcome.held_windows[0]
    run = outcome.problem.runs[window.run]
    names = outcome.predictor.mechanism(conclusion.own.hypothesis).names
    state = conclusion.held.states[window]
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
    return Opening(run.name, position, velocity, time, tau, noise)


def _next(outcome: Outcome, conclusion: Conclusion) -> dict[str, Any]:
    """The experiment that would part what these recordings cannot."""
    study = outcome.study
    pairs: list[tuple[Fit, Fit, tuple[str, ...]]] = []
    for claim in conclusion.claims:
        smaller = study.reduce(conclusion.best, claim.index)
        for rival in claim.rival_candidates:
            other = study.fits.get(smaller.hypothesis.with_(rival).identity)
            if other is not None:
                pairs.append((conclusion.best, other, (claim.candidate.effect.name, rival.effect.name)))
    if not pairs and conclusion.best.hypothesis.members:
        # Nothing is left open; the runner-up would still be the first to doubt.
        for other in outcome.ordered:
            names = {m.effect.name for m in other.hypothesis.members} ^ {
                m.effect.name for m in conclusion.best.hypothesis.members
            }
            if names and len(other.hypothesis.members) == len(conclusion.best.hypothesis.members):
                pairs.append((conclusion.best, other, tuple(sorted(names))))
                break
    proposal = propose(outcome, pairs[:3])
    if proposal is None:
        return {"what": "", "separates": []}
    return {"what": proposal.what, "separates": list(proposal.separates), "expected_sigma": proposal.separation}


def augmented(outcome: Outcome, conclusion: Conclusion, values: dict[str, dict[str, Estimate]]) -> System:
    """The nominal system with its quantities refitted within tolerance and the findings attached."""
    predictor = outcome.predictor
    factors = np.exp(outcome.problem.system.tolerance * conclusion.own.x[: len(predictor.nominal)])
    system = scaled(outcome.problem.system, predictor.nominal, list(factors))
    attachments = []
    for claim in conclusion.claims:
        name, site = claim.candidate.effect.name, claim.candidate.site
        found = {k: e.value for k, e in values[claim.candidate.key].items()}
        stated = STATED.get(name)
        if stated is not None and found[stated[0]] < 0.0:
            # Less than the model states is no effect to attach, but another number in the model.
            joint = system.joint(site)
            less = max(getattr(joint, stated[1]) + found[stated[0]], 0.0)
            system = system.replace_joint(replace(joint, **{stated[1]: less}))
            continue
        spread = {k: e.std for k, e in values[claim.candidate.key].items() if e.std is not None}
        attachments.append(Attachment(name, site, found, spread))
    return replace(system, attachments=(*system.attachments, *attachments))


__all__ = ["Hypothesis", "diagnose"]
