"""What a member is related to, or known for being taken for, in its place; and the member itself at a better place.

Where all else has gone astray without a member, its relative finds its size with everything else held, on the beginnings of the
windows, which then grow: another period has not slipped there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import islice, product

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import FEWEST_WINDOW_SAMPLES, RANKING_GAIN
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis, compatible, dear
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.constants.search import (
    HOPELESS_COST_RATIO,
    NEAR_EVIDENCE,
    NOTICEABLE_GAIN,
    RELATIVE_BEGUN_SIZES,
    RELATIVE_PROMISE,
    RELATIVE_SIZE_STEPS,
    RELATIVE_SIZES,
    SAME_WORK_RATIO,
    SLIPPED_COST_RATIO,
    WINDOW_BEGINNINGS,
)
from harness.diagnose.selection.exchange import related
from harness.diagnose.selection.resonant_starts import in_tune
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.study import Study

Array = NDArray[np.float64]


def _same_units(member: Candidate, other: Candidate) -> bool:
    """Whether the numbers of two candidates may be compared one by one."""
    return [p.unit for p in member.effect.parameters] == [p.unit for p in other.effect.parameters]


def relatives(study: Study, best: Fit, k: int, most_fits: int, *, quick: bool = False) -> list[Fit]:
    """Fits with member ``k`` replaced by what it is related to, as long as the study has fewer than ``most_fits``.

    quick: only by what is quick to fit.

    A law that acts alike may be far from linear, so that a score test says little of it. The member itself is among them where the
    score test sees a better place for it than it has: another number of periods, another frequency, found beside other company.
    """
    without = study.reduce(best, k)
    member = best.hypothesis.members[k]
    own = without.score - best.score
    found = []
    kin = [c for c in study.candidates if c.key == member.key or related(member, c)]
    if quick:
        kin = [c for c in kin if not dear(c)]
    if without.score > SLIPPED_COST_RATIO * max(study.samples, best.score) and not dear(member):
        kin = [c for c in kin if c.key == member.key or _rings(member, c)]
    for scored in study.among(without, kin):
        if scored.candidate.key == member.key:
            found.append(study.extend(without, scored))
            continue
        if len(study.fits) >= most_fits:
            break
        if _same_units(member, scored.candidate):
            # What is measured in the same units is likely to be as large, with everything else as it stands.
            hypothesis = without.hypothesis.with_(scored.candidate)
            known = study.known(hypothesis) if study.was_exchanged(best, scored.candidate) else None
            if known is None:
                alike = study.predictor.effect_values(best.hypothesis, k, best.x)
                law = scored.candidate.effect
                start = to_internal(scored.candidate, np.clip(alike, law.lower, law.upper))
                known = study.fit(hypothesis, [np.concatenate([study.without(best, k), start])], best)
            found.append(known)
        elif _rings(member, scored.candidate):
            found.append(_rung(study, best, k, scored.candidate))
        elif scored.gain > RELATIVE_PROMISE * own:
            extended = study.extend(without, scored)
            found.append(
                _tuned(study, best, k, without, extended) if _both_give(member, scored.candidate) else extended
            )
    if study.stretched(without) or without.score > HOPELESS_COST_RATIO * study.samples:
        # All others have gone far to do without the member, so that tests there say little, and fits from there end elsewhere.
        found += _in_its_place(study, best, k, most_fits)
    return found


def _rings(member: Candidate, other: Candidate) -> bool:
    """Whether the other's own vibration may be the wave that a member is."""
    wave = any(p.search == "line" for p in member.effect.parameters)
    return wave and other.effect.adds_coordinates and "frequency" in other.effect.parameter_names


def _rung(study: Study, best: Fit, k: int, other: Candidate) -> Fit:
    """The fit with something that vibrates in the place of a wave, begun at its frequency and hardly damped."""
    hypothesis = best.hypothesis.without(k).with_(other)
    known = study.known(hypothesis)
    if known is not None:
        return known
    wave = best.hypothesis.members[k].effect.named(study.predictor.effect_values(best.hypothesis, k, best.x))
    values = [
        wave["frequency"] if p.name == "frequency" else scale * p.starts[0]
        for p, scale in zip(other.effect.parameters, other.scales, strict=True)
    ]
    return _begun_ringing(
        study, best, hypothesis, np.concatenate([study.without(best, k), to_internal(other, np.array(values))])
    )


def _begun_ringing(study: Study, near: Fit, hypothesis: Hypothesis, start: Array) -> Fit:
    """The fit of a set whose last member vibrates, from a start near a known fit.

    Nothing rings in what a score test starts from. Nor does anything until the initial states have taken up what rings, so that
    the frequency is held until they have.
    """
    held = study.whole(hypothesis)
    held[len(start) - hypothesis.members[-1].size :] = True
    ringing = fit(
        study.objective(hypothesis), start, study.states_for(hypothesis, near), fixed=held, enough=RANKING_GAIN
    )
    return study.fit(hypothesis, [ringing.x], ringing)


def _both_give(member: Candidate, other: Candidate) -> bool:
    """Whether two candidates each let something give that was taken to be rigid."""
    return member.effect.adds_coordinates and other.effect.adds_coordinates


def _tuned(study: Study, best: Fit, k: int, without: Fit, known: Fit) -> Fit:
    """The fit with something else that gives in the place of member ``k``, begun in tune with it too where that may help.

    A vibration has a valley at every phase, and the best set knows the right one.
    """
    other = known.hypothesis.members[-1]
    if known.score < best.score + NOTICEABLE_GAIN or study.was_exchanged(best, other, "in tune"):
        return known
    for start in in_tune(study.predictor, best.hypothesis, best.x, k, without.x, other):
        known = _begun_ringing(study, without, known.hypothesis, start)
    return known


def _in_its_place(study: Study, best: Fit, k: int, most_fits: int) -> list[Fit]:
    """Fits with relatives in the place of member ``k``, each begun from what it takes to do that member's work.

    All others, the nominal quantities among them, stay where they stand in the set until the relative has found its size by itself.
    """
    member, rest, others = best.hypothesis.members[k], best.hypothesis.without(k), study.without(best, k)
    found: list[Fit] = []
    if any(dear(other) for other in rest.members):
        return found
    for candidate in study.candidates:
        if candidate.key == member.key or not related(member, candidate) or dear(candidate):
            continue
        if not compatible(rest, candidate) or len(study.fits) >= most_fits:
            continue
        hypothesis = rest.with_(candidate)
        known = study.known(hypothesis)
        if known is not None and known.score < best.score + NOTICEABLE_GAIN:
            continue
        if study.was_exchanged(best, candidate, "in its place"):
            continue
        points = product(*(p.start_values(candidate.references) for p in candidate.effect.parameters))
        starts = [np.concatenate([others, to_internal(candidate, np.array(p))]) for p in islice(points, RELATIVE_SIZES)]
        nearest = _grown(study, best, hypothesis, starts)
        if nearest is not None:
            found.append(study.fit(hypothesis, [nearest.x], nearest, target=best.score))
    return found


def _grown(study: Study, best: Fit, hypothesis: Hypothesis, starts: Sequence[Array]) -> Fit | None:
    """A fit of what differs from the best set by its last member, begun on the beginnings of the windows.

    There another period has not yet slipped by a cycle. On the shortest ones the last member finds its size by itself; then all
    follow, and the beginnings grow to whole windows. None if the best set leaves far less on beginnings, or nothing but noise, and
    the other one clearly more: the rest cannot make up for that.
    """
    objective, states = study.objective(hypothesis), study.states_for(hypothesis, best)
    size = hypothesis.members[-1].size
    alone = np.arange(len(starts[0])) < len(starts[0]) - size
    only_noise = study.only_noise(best)
    found: Fit | None = None
    for share in WINDOW_BEGINNINGS:
        parts = {
            w: w._replace(last=w.first + max(round(share * w.size), min(FEWEST_WINDOW_SAMPLES, w.size)))
            for w in study.windows
        }
        on, begun = objective.on(list(parts.values())), {part: states[w] for w, part in parts.items()}
        if found is None:
            costs = [cost for cost, _ in on.residuals([(x, begun) for x in starts])]
            likeliest = [starts[k] for k in np.argsort(costs)[:RELATIVE_BEGUN_SIZES]]
            sized = [
                fit(on, x, begun, fixed=alone, enough=RANKING_GAIN, most_steps=RELATIVE_SIZE_STEPS) for x in likeliest
            ]
            found = min(sized, key=lambda f: f.score)
        else:
            found = fit(
                on, found.x, begun, fixed=study.whole(hypothesis), enough=RANKING_GAIN, most_steps=RELATIVE_SIZE_STEPS
            )
            own = _on_parts(study, best, parts)
            if found.score > SAME_WORK_RATIO * own or (
                only_noise and found.converged and found.score > own + NEAR_EVIDENCE
            ):
                return None
        states = {w: found.states[part] for w, part in parts.items()}
    assert found is not None
    return replace(found, states=states)


def _on_parts(study: Study, fitted: Fit, parts: Mapping[Window, Window]) -> float:
    """What a fit leaves on parts of its windows, prior included."""
    states = {part: fitted.states[w] for w, part in parts.items()}
    ((cost, _),) = study.objective(fitted.hypothesis).on(list(parts.values())).residuals([(fitted.x, states)])
    return cost + fitted.prior


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    return relatives(study, best, room.member, room.most_fits, quick=room.quick)


REWRITE = Rewrite("a relative for a member", _fits, (Turn.KIN, Turn.IN_PLACE), every_member=True)
