"""Sets with one member exchanged: for a more general law, a special case, a relative, another candidate, or nothing.

A set may be right in all but one member, and no growing repairs that. A general law acts like its special case to first order, so
it is begun from where that ended; one that has lost what makes it general is begun again from other shapes. Where all else has
gone astray without a member, its relative finds its size with everything else held, on the beginnings of the windows, which then
grow: another period has not slipped there. Two wrong members may make up for one another, so that either exchange alone leaves
nearly as good a set; pairs are tried then. A larger set that can do without a member by its own linear view, where the smaller
set was fitted far worse, shows that the smaller one ended in a wrong valley: it is begun anew from there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, islice, product

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.vibration_windows import FEWEST_SAMPLES
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis, compatible, contains, dear
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.resonant_starts import in_tune
from harness.diagnose.selection.starts import like
from harness.diagnose.selection.study import FAR, HOPELESS, NOTICEABLE, Study

Array = NDArray[np.float64]

FLOOR = 1.15  # times the cost of noise alone, below which a set counts as complete
LEAST_SHARE = 0.05  # of a member's gain that a relative's score test must promise
HALFWAY = 0.3  # of what a member brings that another candidate's score test must promise
NEARLY = 0.6  # the same for candidates that are dear to fit
# Sizes of a candidate looked at in a member's place, those it is begun at, and steps in which it finds its own.
MOST_SIZES, MOST_SIZED, SIZING = 4, 2, 10
BEGINNINGS = (0.0625, 0.25, 1.0)  # of every window
SAME_WORK = 10.0  # times what the best set leaves on any beginnings, that a relative leaves there at most
MOST_SECOND = 2  # nearly as good sets whose other members' relatives are tried
MOST_EMPTIED = 8  # sets tried without a member that has come to nothing, likeliest first
MOST_REDUCED, NEARLY_BEST = 6, 20.0  # sets, in the criterion
NEAR = 60.0  # in the score
BEYOND = 30.0  # times the cost of noise alone; what is left there is phases that have slipped, and tests say nothing
MOST_TOGETHER, MOST_SLOW = 6, 1  # pairs of exchanges fitted, and those of them that are dear beside a set that is not
NOTHING = 1e-3  # of an effect's typical size, below which it is absent


def generalized(study: Study, base: Fit) -> list[Fit]:
    """Fits with a member replaced by a law of which it is a special case, begun from what the member was fitted to.

    A score test from absence cannot see such a law behind its special case: they act alike to first order.
    """
    found = []
    for k, member in enumerate(base.hypothesis.members):
        values = study.predictor.effect_values(base.hypothesis, k, base.x)
        for wider in study.candidates:
            if not contains(wider, member):
                continue
            rest = base.hypothesis.without(k)
            if not compatible(rest, wider):
                continue
            hypothesis = rest.with_(wider)
            known = study.known(hypothesis) if study.was_exchanged(base, wider) else None
            if known is None:
                others = study.without(base, k)
                starts = [
                    np.concatenate([others, to_internal(wider, p)]) for p in like(wider, float(values[0]), by_way=True)
                ]
                # Neither better than the special case nor near the best set, it would be of no use.
                within = min(base.score, min(f.score for f in study.fits.values()) + NEAR)
                known = study.fit(hypothesis, starts, base, target=within)
            found.append(known)
    return found


def specialized(study: Study, base: Fit) -> list[Fit]:
    """Fits with a member replaced by a special case of it, begun from what the member was fitted to.

    A fit of the special case that was begun elsewhere may have ended in a wrong valley.
    """
    found = []
    for k, member in enumerate(base.hypothesis.members):
        values = study.predictor.effect_values(base.hypothesis, k, base.x)
        rest = base.hypothesis.without(k)
        for simpler in study.candidates:
            if not contains(member, simpler):
                continue
            if not compatible(rest, simpler):
                continue
            hypothesis = rest.with_(simpler)
            known = study.known(hypothesis) if study.was_exchanged(base, simpler) else None
            if known is None:
                own = to_internal(simpler, values[: len(simpler.effect.parameters)])
                # Out of reach of this, it would be of no use, however few its parameters are.
                within = base.score + NEAR * study.loudness(base)
                known = study.fit(hypothesis, [np.concatenate([study.without(base, k), own])], base, target=within)
            found.append(known)
    return found


def related(member: Candidate, other: Candidate) -> bool:
    """Whether two candidates are forms of one thing, or known for being taken for one another."""
    a, b = member.effect, other.effect
    if a.name in b.simpler or b.name in a.simpler:
        return member.site == other.site
    return a.name in b.confusable_with or b.name in a.confusable_with


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
    if without.score > BEYOND * max(study.samples, best.score) and not dear(member):
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
        elif scored.gain > LEAST_SHARE * own:
            extended = study.extend(without, scored)
            found.append(
                _tuned(study, best, k, without, extended) if _both_give(member, scored.candidate) else extended
            )
    if study.stretched(without) or without.score > HOPELESS * study.samples:
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
    ringing = fit(study.objective(hypothesis), start, study.states_for(hypothesis, near), fixed=held, enough=0.2)
    return study.fit(hypothesis, [ringing.x], ringing)


def _both_give(member: Candidate, other: Candidate) -> bool:
    """Whether two candidates each let something give that was taken to be rigid."""
    return member.effect.adds_coordinates and other.effect.adds_coordinates


def _tuned(study: Study, best: Fit, k: int, without: Fit, known: Fit) -> Fit:
    """The fit with something else that gives in the place of member ``k``, begun in tune with it too where that may help.

    A vibration has a valley at every phase, and the best set knows the right one.
    """
    other = known.hypothesis.members[-1]
    if known.score < best.score + NOTICEABLE or study.was_exchanged(best, other, "in tune"):
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
        if known is not None and known.score < best.score + NOTICEABLE:
            continue
        if study.was_exchanged(best, candidate, "in its place"):
            continue
        points = product(*(p.start_values(candidate.references) for p in candidate.effect.parameters))
        starts = [np.concatenate([others, to_internal(candidate, np.array(p))]) for p in islice(points, MOST_SIZES)]
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
    for share in BEGINNINGS:
        parts = {
            w: w._replace(last=w.first + max(round(share * w.size), min(FEWEST_SAMPLES, w.size))) for w in study.windows
        }
        on, begun = objective.on(list(parts.values())), {part: states[w] for w, part in parts.items()}
        if found is None:
            costs = [cost for cost, _ in on.residuals([(x, begun) for x in starts])]
            likeliest = [starts[k] for k in np.argsort(costs)[:MOST_SIZED]]
            sized = [fit(on, x, begun, fixed=alone, enough=0.2, most_steps=SIZING) for x in likeliest]
            found = min(sized, key=lambda f: f.score)
        else:
            found = fit(on, found.x, begun, fixed=study.whole(hypothesis), enough=0.2, most_steps=SIZING)
            own = _on_parts(study, best, parts)
            if found.score > SAME_WORK * own or (only_noise and found.converged and found.score > own + NEAR):
                return None
        states = {w: found.states[part] for w, part in parts.items()}
    assert found is not None
    return replace(found, states=states)


def _on_parts(study: Study, fitted: Fit, parts: Mapping[Window, Window]) -> float:
    """What a fit leaves on parts of its windows, prior included."""
    states = {part: fitted.states[w] for w, part in parts.items()}
    ((cost, _),) = study.objective(fitted.hypothesis).on(list(parts.values())).residuals([(fitted.x, states)])
    return cost + fitted.prior


def alternatives(study: Study, best: Fit, k: int, count: int, most_fits: int) -> list[Fit]:
    """Fits with member ``k`` of the best set replaced by another candidate, the ``count`` most promising ones, best first.

    Nothing further is fitted once the study has ``most_fits``.
    """
    without = study.reduce(best, k)
    member = best.hypothesis.members[k]
    needed = study.criterion(without) - study.criterion(best)
    found = []
    tried = slow = 0
    # Where the set leaves more than noise, of what is dear to fit only the likeliest is worth it.
    most_slow = count if best.score < FLOOR * study.samples and not study.left_out else MOST_SLOW
    for scored in study.ranked(without):
        if scored.candidate.key == member.key or tried >= count:
            continue
        if len(study.fits) >= most_fits:
            break
        share = scored.gain / max(min(needed, without.score - best.score), 1e-300)
        if share < HALFWAY:
            break
        if dear(scored.candidate) and (share < NEARLY or slow >= most_slow):
            continue
        slow += dear(scored.candidate)
        tried += 1
        found.append(study.extend(without, scored))
    return sorted(found, key=study.criterion)


def known_in_place_of(study: Study, best: Fit, k: int) -> list[tuple[Candidate, Fit]]:
    """All known fits that differ from a set by another candidate in the place of member ``k``, with that candidate."""
    member, kept = best.hypothesis.members[k], best.hypothesis.without(k).identity
    return [
        (next(m for m in other.hypothesis.members if m.key not in kept), other)
        for key, other in study.fits.items()
        if kept < key and member.key not in key and len(key) == len(kept) + 1
    ]


@dataclass(frozen=True, eq=False)
class Swap:
    """A fit that differs from the best one by ``candidate`` in the place of member ``k``, and by how much it is worse."""

    worse: float
    k: int
    candidate: Candidate
    fit: Fit


def swaps(study: Study, best: Fit) -> list[Swap]:
    """All known fits that differ from the best one by one member, likeliest first."""
    own = study.criterion(best)
    found = [
        Swap(study.criterion(other) - own, k, new, other)
        for k in range(len(best.hypothesis.members))
        for new, other in known_in_place_of(study, best, k)
    ]
    return sorted(found, key=lambda s: s.worse)


def together(study: Study, best: Fit, most_fits: int) -> list[Fit]:
    """Fits with two members exchanged at once, for what either exchange alone leaves nearly as good.

    Two wrong members may make up for one another, so that putting one of them right looks like a step back.
    """
    pairs = [(a, b) for a, b in combinations(swaps(study, best), 2) if a.k != b.k and a.worse + b.worse < NEAR]
    found = []
    slow = 0
    for one, two in sorted(pairs, key=lambda p: p[0].worse + p[1].worse)[:MOST_TOGETHER]:
        if any(dear(swap.candidate) and not any(map(dear, best.hypothesis.members)) for swap in (one, two)):
            slow += 1
            if slow > MOST_SLOW:
                continue
        if len(study.fits) >= most_fits:
            break
        both = exchanged(study, best, one, two)
        found += [] if both is None else [both]
    return found


def exchanged(study: Study, best: Fit, one: Swap, two: Swap, target: float = -np.inf) -> Fit | None:
    """A fit with both swaps of a set made at once, begun from the first one's; None if that is known, or no set."""
    place = one.fit.hypothesis.keys.index(best.hypothesis.keys[two.k])
    rest = one.fit.hypothesis.without(place)
    if not compatible(rest, two.candidate) or study.known(rest.with_(two.candidate)) is not None:
        return None
    span = two.fit.hypothesis.span(two.fit.hypothesis.keys.index(two.candidate.key))
    own = two.fit.x[len(study.predictor.nominal) :][span]
    start = np.concatenate([study.without(one.fit, place), own])
    return study.fit(rest.with_(two.candidate), [start], one.fit, target=target)


def second(study: Study, best: Fit, most_fits: int) -> list[Fit]:
    """Fits of nearly as good sets with another one of their members exchanged for a relative too.

    What looks like a step back may open the way to a relative of what the best set does not even need.
    """
    found = []
    for swap in swaps(study, best)[:MOST_SECOND]:
        keys = swap.fit.hypothesis.keys
        if swap.worse > NEAR or any(map(dear, swap.fit.hypothesis.members)):
            continue
        for k, key in enumerate(keys):
            if key != swap.candidate.key and len(study.fits) < most_fits:
                found += relatives(study, swap.fit, k, most_fits)
    return found


def reduced(study: Study, best: Fit) -> list[Fit]:
    """Fits of nearly as good sets without one of the members that they share with the best one.

    What stands in a member's place may do without the others; none that the best set cannot do without are tried.
    """
    base, found = best.hypothesis, []
    for swap in swaps(study, best)[:MOST_REDUCED]:
        if swap.worse > NEARLY_BEST:
            break
        for k, key in enumerate(base.keys):
            if k != swap.k and study.reduce(best, k).score < FAR * best.score:
                found.append(study.reduce(swap.fit, swap.fit.hypothesis.keys.index(key)))
    return found


def emptied(study: Study, best: Fit) -> list[Fit]:
    """Fits of sets that would be better than the best one, were it not for a member that has come to nothing, without that one.

    What was found beside something that explained part of it by mistake may need nothing beside it.
    """
    own = study.criterion(best)
    promising: list[tuple[float, int, Fit, int]] = []
    for fitted in study.fits.values():
        for k, member in enumerate(fitted.hypothesis.members):
            without = study.criterion(fitted) - study.price(member, len(fitted.hypothesis.members) - 1)
            if without < own and _came_to_nothing(study, fitted, k):
                promising.append((without, len(promising), fitted, k))
                break
    # Beside a force that is left out sets are hardly worth more than one another, and most of them promise to win.
    return [study.reduce(fitted, k) for _, _, fitted, k in sorted(promising)[:MOST_EMPTIED]]


def _came_to_nothing(study: Study, fitted: Fit, k: int) -> bool:
    """Whether member ``k`` of a fit is absent to within a small part of its typical size."""
    member = fitted.hypothesis.members[k]
    if not member.effect.parameters:
        return False
    size = member.effect.parameters[0]
    value = study.predictor.effect_values(fitted.hypothesis, k, fitted.x)[0]
    return bool(np.isfinite(size.neutral) and abs(value - size.neutral) < NOTHING * size.scale(member.references))


def pruned(study: Study, fitted: Fit, louder: float = 1.0) -> Fit:
    """The set without members, and without generality, that do not pay for themselves beside the others.

    louder: variance of the noise, in units of what it is taken to be: what the set leaves, where that is no noise.
    """

    def criterion(of: Fit) -> float:
        return study.criterion(of) - of.score * (1.0 - 1.0 / louder)

    while fitted.hypothesis.members:
        fewer = [study.reduce(fitted, k) for k in range(len(fitted.hypothesis.members))]
        smaller = min([*fewer, *specialized(study, fitted)], key=criterion)
        if criterion(smaller) > criterion(fitted):
            break
        fitted = smaller
    return fitted
