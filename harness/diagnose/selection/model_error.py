"""The search once more under a likelihood that knows that every hypothesis leaves something out.

Where the best set still leaves more than the sensors' noise, that noise is no measure of what a further law is worth: thousands
of samples call any of them significant. Sets are then weighed by the likelihood with an unknown force at every joint beside the
sensors' noise (``estimation.discrepancy``), its size and memory estimated, and fitted and compared with residuals as loud and as
few as that leaves them (``estimation.misfit``): a law pays by making what is left smaller, in steps that hundreds of samples which
err together cannot make look large.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import LOST
from harness.diagnose.estimation.discrepancy import (
    Discrepancy,
    Responses,
    estimate,
    responses,
)
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.misfit import Misfit, misfit, squares
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.constants import DRAWN_SHARE
from harness.diagnose.problem.hypothesis import Hypothesis, compatible
from harness.diagnose.selection.beam_search import Effort, grow, polish
from harness.diagnose.selection.constants.search import HOPELESS_COST_RATIO, RETAINED_SETS
from harness.diagnose.selection.constants.starts import ON_COURSE_SHARE
from harness.diagnose.selection.constants.weighing import (
    COMPARED_SETS,
    LINEAR_VIEW_ERROR,
    LOUD_RATIO,
    PLAINLY_MORE_LEFT,
    SETS_ABREAST,
    SETTLED_CHANGE,
    SHRUNK_FORCE_SHARE,
    SOUGHT_FORCE_SHARE,
    WEIGHING_ROUNDS,
)
from harness.diagnose.selection.dissipation_starts import everywhere, with_one_change
from harness.diagnose.selection.rewrites.special_case import specialized
from harness.diagnose.selection.search_beside_force import likeliest_beside, plain_instead
from harness.diagnose.selection.state_evidence import Evidence, evidence_over_the_state
from harness.diagnose.selection.study import Study
from harness.diagnose.selection.wald_test import rise_without
from harness.effects.scale import pull

Array = NDArray[np.float64]

DRAWN = "ordinary dissipation beside each thing that may not be as drawn", "another set may be likelier, or as likely"
SHAPES = "whether one error of a known shape explains what is left", "what was found may only stand in for that"


@dataclass(frozen=True, eq=False)
class Weighed:
    """A set under the likelihood with a force of its own, if there is one: its criterion, noise of the sensors, and the force."""

    fitted: Fit
    value: float
    sensors: Likelihood
    force: Discrepancy | None


def weighed(study: Study, ways: Sequence[Responses], fitted: Fit) -> Weighed:
    """The criterion of a set, size and memory of the force that it leaves out its own, under the likeliest noise of the sensors.

    ways: how channels answer to forces, under several takes on the sensors' noise. A slow error of the model looks like coloured
    noise of a sensor, and only the whole likelihood tells which it is: noise that the channels' own scatter does not show, or a
    force that moves the joints. Comparable under any of them: −2 log L with the determinant in it.
    """
    rows = []
    for found in ways:
        sensors = found.probe.likelihood
        free = study.profiled_under(sensors, fitted)
        cost = sum(float(own.residual @ own.residual) for own in free)
        force = estimate(found, fitted.windows, free, found.joints)
        gain = 0.0 if force is None else force.gain - 2.0 * (len(found.joints) + 1)
        colours = 2.0 * sum(1.0 for colour in sensors.colours if colour.coloured > 0.0)
        rows.append((cost - gain + sensors.spread(fitted.windows) + 2.0 * colours, sensors, force))
    value, sensors, force = min(rows, key=lambda row: row[0])
    return Weighed(fitted, study.criterion(fitted) - fitted.cost + value, sensors, force)


def answers(study: Study, fitted: Fit, period: float) -> list[Responses]:
    """How the channels answer to forces along a fit, whitened by the noise as estimated and by the channels' own scatter alone.

    None where they do not answer linearly.
    """
    system = study.problem.system
    torque = pull(system)
    takes = [study.likelihood.of_sensors]
    if any(colour.coloured > 0.0 for colour in study.likelihood.colours):
        takes.append(study.likelihood.as_scattered)
    found = (responses(study.predictor, sensors, fitted, torque, period) for sensors in takes)
    return [one for one in found if one is not None]


Laws = Callable[[], Mapping[str, Mapping[str, float]]]
"""Numbers of effects by their keys and parameters, by another look at the same recordings than free runs are."""

Structure = Callable[[Study, Fit, bool], float]
"""What the likeliest error of one known shape (a jump, a leak, …) gains beyond its price beside a set; whether forces over the
state are among those shapes."""


def begun_ordinary(
    study: Study,
    short: Fit,
    period: float,
    effort: Effort,
    progress: Callable[[str], None],
    structure: Structure,
    reached: list[Study],
    few_suffice: Callable[[], Fit | None],
    laws: Laws = dict,
) -> tuple[Study, list[Fit]] | None:
    """The same at once where ordinary dissipation is part of the answer, and still leaves far more than noise; None elsewhere.

    The noise would there have a search among ever stranger sets, each of them far more than significant. As laws are found the
    force shrinks, and more of them show beside it (a graduated search; Blake and Zisserman, Visual Reconstruction (1987)).
    short: the fit of ordinary dissipation on short windows, where it has no wrong valleys. few_suffice: few effects that leave
    nothing but noise there, if there are; then noise is the measure of whole runs too, unless a force is left out of these.
    """
    usual = everywhere(study, short)
    if usual is None:
        return None
    progress("friction and drag at every joint")
    # Noise that was estimated beside a nominal model that is far off has the colour of what it lacks.
    rough = study.likelihood.as_scattered
    begun, noise = [usual, study.empty()], rough.samples(study.windows)
    above = study.residuals_under(rough, usual)[0] - noise
    if above < (LOUD_RATIO**2 - 1.0) * noise:
        return None
    few = few_suffice()
    if few is not None:
        there = study.fit(few.hypothesis, [few.x], few.beginning(study.windows))
        # Few effects that are the truth leave noise on whole runs as well, or far less than ordinary dissipation does.
        if study.residuals_under(rough, there)[0] - noise < ON_COURSE_SHARE * above:
            return None
        # A force that nobody has named, or noise of recorded efforts, has no time to lead far on a short window. The likelihood
        # with a force in it tells it from noise that has its colour.
        ways = answers(study, there, period)
        if not ways or weighed(study, ways, there).force is None:
            return None
        begun.append(there)
    return under_model_error(study, begun, period, effort, progress, structure, reached, laws=laws, early=True)


def under_model_error(
    study: Study,
    ordered: Sequence[Fit],
    period: float,
    effort: Effort,
    progress: Callable[[str], None],
    structure: Structure = lambda study, fitted, of_state: 0.0,
    reached: list[Study] | None = None,
    *,
    laws: Laws = dict,
    early: bool = False,
) -> tuple[Study, list[Fit]] | None:
    """The study with the force that is left out in its likelihood, and its sets, best first; None where there is no such force.

    Where the search under such a force finds sets that leave nothing but noise, theirs is a study without. period: of the slowest
    swing [s]. structure: a force of no shape has to be likelier than one error of a shape that is known.
    reached: told of every study that is begun. laws: what another look at the recordings finds, and a set begins with. early:
    nothing was searched for before.
    """
    alone = study.only_noise(ordered[0]) and not any(colour.coloured > 0.0 for colour in study.likelihood.colours)
    instead = plain_instead(study, ordered[0], progress) if alone else None
    if alone and instead is None:
        return None
    ways = answers(study, ordered[0], period)
    if not ways:
        return None
    near = [instead] if instead is not None else sorted(study.fits.values(), key=study.criterion)[:COMPARED_SETS]
    rows = sorted((weighed(study, ways, fitted) for fitted in near), key=lambda row: row.value)
    asked = not early and instead is None
    if rows[0].force is None or (asked and not _shapeless(study, rows[0].value, structure, False)):
        return None
    rough = study.likelihood.as_scattered
    # Noise that was estimated with a jump in it has the jump's colour, and under that a jump is worth nothing.
    coloured = any(colour.coloured > 0.0 for colour in study.likelihood.colours)
    if asked and coloured and not _of_no_known_shape(study.unfitted(rough), rows[0].fitted, period, structure, False):
        return None
    progress("a force that is left out")
    taken, ranked = _left(rough, study, rows[0].fitted, rows[0].force), [row.fitted for row in rows]
    search = True
    for _ in range(WEIGHING_ROUNDS):
        wider = study.unfitted((taken.fainter(SOUGHT_FORCE_SHARE) if early and search else taken).likelihood)
        fits = [wider.fit(f.hypothesis, [f.x], f) for f in ranked[: 2 * effort.beam]]
        drawn: list[Fit] = []
        if search:
            empty = wider.fit(Hypothesis(), [study.empty().x], study.empty())
            if reached is not None:
                reached.append(wider)
            progress("one thing that is not as drawn")
            drawn = _drawn(wider, empty, fits)
            every = [empty, *fits, *drawn, *_as_found(wider, laws(), empty)]
            nearest = min(every, key=lambda f: f.score)
            evidence = evidence_over_the_state(wider, rough, nearest, drawn[0]) if drawn else None
            if evidence is not None:
                best = likeliest_beside(wider, evidence, every, progress)
                with study.predictor.deadline.spared():
                    # What the time was up for has been noted; no answer should do without the rest.
                    best = _out_of_its_valley(wider, evidence, best)
                    replaced = [] if instead is None else [ordered[0]]
                    return _beside_the_state(
                        study, wider, ways, evidence, best, replaced, period, structure, reached, early=early
                    )
            fits = grow(wider, every, effort, progress)
            fits = fits if early else polish(wider, fits, effort, progress)
        members = [*sorted(fits, key=wider.criterion)[:COMPARED_SETS], *drawn]
        best = least(wider, rough, taken.together, members, progress)
        ranked = [best, *(f for f in fits if f is not best)]
        found = weighed(wider, ways, best)
        if found.force is None:
            return _noise_after_all(study, found, ranked[: 2 * effort.beam])
        after = _left(rough, wider, best, found.force)
        settled, search, taken = _alike(taken, after), _shrunk(taken, after), after
        if settled:
            break
    if early and not _of_no_known_shape(study.unfitted(rough), ranked[0], period, structure, True):
        return None
    wider = study.unfitted(taken.likelihood)
    wider.fit(Hypothesis(), [study.empty().x], study.empty())
    if reached is not None:
        reached.append(wider)
    fits = [wider.fit(f.hypothesis, [f.x], f) for f in ranked[: 2 * effort.beam]]
    return wider, polish(wider, sorted(fits, key=wider.criterion), effort, progress)


def _as_found(study: Study, laws: Mapping[str, Mapping[str, float]], near: Fit) -> list[Fit]:
    """The set of laws that another look at the recordings found, from its numbers, as far as they stand together."""
    hypothesis, start = Hypothesis(), [np.zeros(len(study.predictor.nominal))]
    for candidate in study.candidates:
        values = laws.get(candidate.key)
        if values is not None and compatible(hypothesis, candidate):
            hypothesis = hypothesis.with_(candidate)
            start.append(to_internal(candidate, np.array([values[name] for name in candidate.effect.parameter_names])))
    return [study.fit(hypothesis, [np.concatenate(start)], near)] if hypothesis.members else []


def _drawn(study: Study, empty: Fit, fits: Sequence[Fit]) -> list[Fit]:
    """Ordinary dissipation beside one thing that is not as drawn, as far as the time allows; without, what there is."""
    near = min([empty, *fits], key=study.criterion)

    def so_far() -> list[Fit]:
        return sorted((f for f in study.fits.values() if f.hypothesis.members), key=study.criterion)

    return study.predictor.deadline.within(DRAWN_SHARE, *DRAWN, lambda: with_one_change(study, near), so_far)


def _beside_the_state(
    study: Study,
    wider: Study,
    ways: Sequence[Responses],
    evidence: Evidence,
    best: Fit,
    replaced: Sequence[Fit],
    period: float,
    structure: Structure,
    reached: list[Study] | None,
    *,
    early: bool,
) -> tuple[Study, list[Fit]] | None:
    """The study under what the best set leaves, sets of ``wider`` having been weighed beside a force over the state.

    These do not depend on how large what is left was taken to be, so that once is enough. replaced: sets in whose place they are,
    which are kept to be told of.
    """
    found = weighed(wider, ways, best)
    # Once the time is up, what has not been weighed stays so.
    hurried = study.predictor.deadline.over
    others = [f for f in wider.fits.values() if f is not best and (evidence.has(f) or not hurried)]
    others.sort(key=lambda f: evidence.criterion(wider, f))
    ranked = [best, *others[:RETAINED_SETS]]
    if found.force is None:
        return _noise_after_all(study, found, ranked)
    alone = study.unfitted(evidence.rough)
    if early and not study.predictor.deadline.attempt(
        *SHAPES, lambda: _of_no_known_shape(alone, best, period, structure, False), lambda: True
    ):
        return None
    final = study.unfitted(_left(evidence.rough, wider, best, found.force, evidence).likelihood)
    final.fit(Hypothesis(), [study.empty().x], study.empty())
    if reached is not None:
        reached.append(final)
    return final, [final.fit(f.hypothesis, [f.x], f) for f in [*ranked, *replaced]]


def _out_of_its_valley(study: Study, evidence: Evidence, fitted: Fit) -> Fit:
    """A set fitted again from where it is likeliest beside its force, if that is elsewhere and leaves less.

    Free runs without the force may have ended in a wrong valley.
    """
    there = evidence.beside(study, fitted)
    if np.all(np.abs(there.x - fitted.x) <= there.spread):
        return fitted
    return study.fit(fitted.hypothesis, [there.x], replace(fitted, x=there.x, states=there.states))


def _noise_after_all(study: Study, found: Weighed, ranked: Sequence[Fit]) -> tuple[Study, list[Fit]]:
    """What was found on the way leaves nothing but noise: no force is left out."""
    plain = study.unfitted(found.sensors)
    return plain, sorted((plain.fit(f.hypothesis, [f.x], f) for f in ranked), key=plain.criterion)


def _of_no_known_shape(alone: Study, best: Fit, period: float, structure: Structure, of_state: bool) -> bool:
    """Whether what is left beside a set, as it stands under the sensors' noise alone, is no error of a shape that is known.

    The colour of noise that was estimated beside a nominal model that is far off could explain anything.
    """
    part = alone.fit(best.hypothesis, [best.x], best)
    while part.hypothesis.members:
        part = min((alone.below(part, k) for k in range(len(part.hypothesis.members))), key=alone.criterion)
    own = weighed(alone, answers(alone, best, period), best)
    return _shapeless(alone, own.value, structure, of_state)


def reweighed(study: Study, fitted: Fit) -> Study | None:
    """A study under what this set leaves, where its own likelihood has another size of that; None where it has not.

    What has been left out of a set again is the model's own error from then on.
    """
    before = study.likelihood.discrepancy
    if not isinstance(before, Misfit):
        return None
    after = replace(_left(before.sensors, study, fitted, before.force), state=before.state)
    if _alike(before, after):
        return None
    ways = answers(study, fitted, study.swing)
    force = weighed(study, ways, fitted).force if ways else None
    return study.unfitted(replace(after, force=force or before.force).likelihood, before=study)


def _left(rough: Likelihood, study: Study, fitted: Fit, force: Discrepancy, evidence: Evidence | None = None) -> Misfit:
    """What a set leaves of what the sensors read."""
    _, residuals = study.residuals_under(rough, fitted)
    state = None if evidence is None else evidence.force
    return replace(misfit(rough, fitted.windows, residuals, force), state=state)


def _shapeless(study: Study, value: float, structure: Structure, of_state: bool) -> bool:
    """Whether a force of no shape, beside which the best set has this criterion, is likelier than any error of a known shape.

    A law of one shape may have been pieced together from several of the catalogue: it is asked for beside fewer of them, too. Such
    an error is one that leaves little more than noise; of what a whole rig leaves, some part has any shape. Or one that leaves as
    little beside some laws, held against what any set leaves, as a linear view of it may be wrong by: it may then leave nothing,
    and the others only stand in for it. of_state: whether a force over the state counts as one; it does not where sets are weighed
    beside such a force, whatever its shape.
    """
    lowest = min(fitted.score for fitted in study.fits.values())
    for fitted in _best_of_each_size(study):
        if fitted.score >= LOST:
            continue
        worth = structure(study, fitted, of_state)
        if fitted.score - worth < LINEAR_VIEW_ERROR**2 * lowest:
            return False
        explained = fitted.score - worth < HOPELESS_COST_RATIO * study.samples
        if explained and study.criterion(fitted) - worth + study.likelihood.spread(study.windows) < value:
            return False
    return True


def _shrunk(before: Misfit, after: Misfit) -> bool:
    """Whether what is left has become so much smaller that further laws may show beside it."""
    return any(b < SHRUNK_FORCE_SHARE**2 * a for a, b in zip(before.louder, after.louder, strict=True))


def _best_of_each_size(study: Study) -> list[Fit]:
    """The best set of every number of members."""
    best: dict[int, Fit] = {}
    for fitted in study.fits.values():
        size = len(fitted.hypothesis.members)
        if size not in best or study.criterion(fitted) < study.criterion(best[size]):
            best[size] = fitted
    return list(best.values())


def _alike(one: Misfit, other: Misfit) -> bool:
    """Whether two likelihoods weigh alike."""
    pairs = [*zip(one.louder, other.louder, strict=True), *zip(one.together, other.together, strict=True)]
    return all(abs(a - b) <= SETTLED_CHANGE * max(a, b) for a, b in pairs)


def _needed(study: Study, fitted: Fit, k: int) -> bool:
    """Whether a set plainly leaves far more without member ``k``: the linear view tells, and nothing has to be fitted."""
    rise = rise_without(fitted, len(study.predictor.nominal), k)
    return bool(np.isfinite(rise)) and rise > PLAINLY_MORE_LEFT * fitted.score


def least(
    study: Study,
    sensors: Likelihood,
    together: Sequence[float],
    ordered: Sequence[Fit],
    progress: Callable[[str], None],
) -> Fit:
    """The likeliest set, what it leaves as loud as it is, of those found and the best ones' parts, member after member left out.

    together: samples of every channel that err together.
    """

    def value(fitted: Fit) -> float:
        _, residuals = study.residuals_under(sensors, fitted)
        left, sizes = squares(sensors, fitted.windows, residuals)
        # −2 log L with the variance of every channel at its likeliest, one of the sensors' at least.
        variance = np.maximum(left / sizes, 1.0)
        own = np.sum(sizes / np.array(together) * (np.log(variance) + left / sizes / variance))
        return float(own) + study.criterion(fitted) - fitted.cost

    front = sorted(((value(fitted), fitted) for fitted in ordered), key=lambda pair: pair[0])[:SETS_ABREAST]
    lowest, best = front[0]
    while front:
        # Without a law that is too general nothing may be likelier, and yet something with a special case of it.
        shorter: dict[frozenset[str], tuple[float, Fit]] = {}
        for above, fitted in front:
            members = range(len(fitted.hypothesis.members))
            smaller = [study.below(fitted, k) for k in members if not _needed(study, fitted, k)]
            for plainer in smaller + specialized(study, fitted):
                if (own := value(plainer)) < above:
                    shorter[plainer.hypothesis.identity] = own, plainer
        front = sorted(shorter.values(), key=lambda pair: pair[0])[:SETS_ABREAST]
        if front and front[0][0] < lowest:
            lowest, best = front[0]
            progress(" + ".join(best.hypothesis.keys) or "nothing")
    return best
