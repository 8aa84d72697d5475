"""The working bench of one diagnosis: fits, kept by hypothesis and windows, and everything that they need.

Sets are compared by the extended Bayesian information criterion. What vibrates has initial states of its own in every window, which
would fit noise free of charge: each costs 2, as Akaike's criterion asks, as far as the data tell it (the effective number of
parameters beside a prior of 0.1 rad). Beside a misfit of more than twice the noise's cost, tolerances are weighed against residuals
as loud as they are: otherwise a nominal quantity would leave its tolerance by a hundred deviations to smooth what something else
makes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import lgamma

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.estimation.constants import RANKING_GAIN, STATE_READING_TIME
from harness.diagnose.estimation.discrepancy import Profiled, profiled
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.linearisation import linearise, sharply
from harness.diagnose.estimation.objective import Objective, Residuals
from harness.diagnose.estimation.window_states import measured_state
from harness.diagnose.prediction.coordinates import is_logarithmic
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis, compatible, dear, whole_numbers
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.beginning import Addition
from harness.diagnose.selection.beginnings.catalogue import beginnings
from harness.diagnose.selection.constants.search import (
    ALIKE_SCORES,
    BENT_BACK_STEPS,
    CLEARLY_NOISE_SIGMAS,
    EXTENDING_STEPS,
    FAR_COST_RATIO,
    HOPELESS_COST_RATIO,
    NOTICEABLE_GAIN,
    PATIENT_STEPS,
    PLAINLY_MORE_THAN_NOISE,
    PRIOR_WIDTH,
    SEARCH_STEPS,
    STATE_READING_PARTS,
    STRETCHED_CHANCE,
    SUFFICIENT_SHARE,
    UNDER_WAY_GAIN,
    VIBRATION_PRICE,
    WORTH_COUNTING_RATIO,
)
from harness.diagnose.selection.multi_start import bent_back, brought_back, in_shape, made_to_ring
from harness.diagnose.selection.score_tests import Score, carry_state, nuisance, score
from harness.diagnose.selection.wald_test import rise_without

Array = NDArray[np.float64]


@dataclass(eq=False)
class Study:
    """Fits of hypotheses on one set of training windows under one likelihood.

    tests: of candidates by their keys; None for what changes nothing that could be seen. substitutes: by set, member and score,
    what the rest leaves where it stands without the member, and tests of candidates there.
    exchanged: sets in which a candidate of this key took a member's place, with the score from where it did. extended: sets that
    a candidate was added to; reduced: that were looked at without a member. carried: sets whose fit was carried on to its end;
    rung: whose dead vibrations were begun anew; anew: that did not come to an end and were begun anew from the nominal quantities.
    swing: length of the slowest swing [s], if known.
    hints: score tests on shorter windows of the same recordings, where what had to be bent far is nearer to what it stands for.
    before: the study of the same windows under an earlier estimate of the noise. ends: where fits of a set have ended, by score,
    the best one among them. spent: whether sets have stopped to leave less by growing.
    """

    problem: Problem
    predictor: Predictor
    likelihood: Likelihood
    candidates: tuple[Candidate, ...]
    windows: tuple[Window, ...]
    fits: dict[frozenset[str], Fit] = field(default_factory=dict)
    tests: dict[frozenset[str], dict[str, Score | None]] = field(default_factory=dict)
    substitutes: dict[tuple[frozenset[str], str, float], tuple[float, list[Score]]] = field(default_factory=dict)
    first_states: Mapping[Window, Array] = field(default_factory=dict)
    exchanged: dict[tuple[frozenset[str], str], float] = field(default_factory=dict)
    extended: set[tuple[frozenset[str], str]] = field(default_factory=set)
    reduced: set[tuple[frozenset[str], str]] = field(default_factory=set)
    carried: set[frozenset[str]] = field(default_factory=set)
    rung: set[frozenset[str]] = field(default_factory=set)
    anew: set[frozenset[str]] = field(default_factory=set)
    swing: float = 0.0
    spent: bool = False
    hints: Mapping[frozenset[str], Mapping[str, Score | None]] = field(default_factory=dict)
    before: Study | None = None
    ends: dict[tuple[str, ...], list[tuple[float, Array]]] = field(default_factory=dict)
    _read: dict[tuple[Window, float], Array] = field(default_factory=dict)

    def unfitted(
        self, likelihood: Likelihood, windows: tuple[Window, ...] | None = None, before: Study | None = None
    ) -> Study:
        """The same with nothing fitted yet, under another likelihood or on part of the windows."""
        return Study(
            self.problem, self.predictor, likelihood, self.candidates, self.windows if windows is None else windows,
            first_states=self.first_states, swing=self.swing, before=before,
        )  # fmt: skip

    @property
    def samples(self) -> float:
        """Independent readings in the training windows."""
        return self.likelihood.samples(self.windows)

    def objective(self, hypothesis: Hypothesis) -> Objective:
        """What a fit of a hypothesis makes small here."""
        return Objective(self.predictor, self.likelihood, hypothesis, self.windows)

    def objective_under(self, likelihood: Likelihood, fitted: Fit) -> Objective:
        """What a fit makes small in its own windows, under another likelihood."""
        return replace(self.objective(fitted.hypothesis).on(fitted.windows), likelihood=likelihood)

    def residuals_under(self, likelihood: Likelihood, fitted: Fit) -> Residuals:
        """What a fit leaves as it stands, under another likelihood."""
        return self.objective_under(likelihood, fitted).residuals([(fitted.x, fitted.states)])[0]

    def profiled_under(self, likelihood: Likelihood, fitted: Fit) -> list[Profiled]:
        """Residuals of a fit under another likelihood, initial states, which were fitted under this one, profiled out."""
        frozen = np.ones(len(fitted.x), dtype=bool)
        return profiled(linearise(self.objective_under(likelihood, fitted), fitted.x, fitted.states, fixed=frozen))

    def criterion(self, fitted: Fit) -> float:
        """Extended Bayesian information criterion: cost, prior, parameters, and the number of sets to choose among.

        Chen and Chen, Biometrika 95 (2008) 759, with γ = 1; effects that are seldom met pay for that as prior odds, and those that
        vibrate for how every window's vibration began.
        """
        count = len(fitted.hypothesis.members)
        sets = log_choose(len(self.candidates), count)
        rare = sum(member.effect.rarity for member in fitted.hypothesis.members)
        return fitted.score + self.paid(fitted) + 2.0 * (sets + rare) + self.surprise(fitted)

    def paid(self, fitted: Fit) -> float:
        """What the Bayesian criterion asks for a fit's numbers, those that are every window's own among them."""
        own = fitted.hypothesis.own_numbers(fitted.windows, self.predictor.runs)
        return (fitted.hypothesis.size + own) * float(np.log(self.samples)) + VIBRATION_PRICE * fitted.vibrating

    def surprise(self, fitted: Fit) -> float:
        """−2 log of how plausible the sizes of a fit's effects are: of what recordings cannot part, the usual comes first.

        It chooses which one is named; what else it could be is told by the recordings alone (``evidence``).
        """
        return sum(
            member.surprise(self.predictor.effect_values(fitted.hypothesis, k, fitted.x))
            for k, member in enumerate(fitted.hypothesis.members)
        )

    def evidence(self, fitted: Fit) -> float:
        """−2 log of the evidence (Laplace's method) up to a constant, to weigh rivals with equally many members.

        Smaller is better. What the recordings cannot pin costs nothing, so a law with more parameters is not ruled out for
        having them. Parameters count as spread over ``PRIOR_WIDTH`` of the fit's own coordinates; the price never exceeds that of
        the criterion.
        """
        k = len(self.predictor.nominal)
        free = np.flatnonzero(fitted.free)
        information = fitted.linear.matrix[:, free].T @ fitted.linear.matrix[:, free]
        information += np.diag((free < k).astype(np.float64))
        nominal, own = free < k, free >= k
        inner = information[np.ix_(own, own)]
        if nominal.any() and own.any():
            across = information[np.ix_(nominal, own)]
            inner = inner - across.T @ np.linalg.solve(information[np.ix_(nominal, nominal)], across)
        volume = (
            float(np.sum(np.log1p(np.maximum(np.linalg.eigvalsh(inner), 0.0) * PRIOR_WIDTH**2))) if own.any() else 0.0
        )
        rare = sum(member.effect.rarity for member in fitted.hypothesis.members)
        volume = min(volume, fitted.hypothesis.size * float(np.log(self.samples)))
        every = fitted.hypothesis.own_numbers(fitted.windows, self.predictor.runs) * float(np.log(self.samples))
        return fitted.score + volume + every + VIBRATION_PRICE * fitted.vibrating + 2.0 * rare

    def price(self, candidate: Candidate, members: int = 0) -> float:
        """What the criterion asks for one more effect beside ``members``."""
        n = len(self.candidates)
        sets = log_choose(n, members + 1) - log_choose(n, members)
        return self.numbers(candidate) * float(np.log(self.samples)) + 2.0 * (sets + candidate.effect.rarity)

    def numbers(self, candidate: Candidate) -> int:
        """How many numbers a candidate adds: its parameters, and what is every window's own."""
        return candidate.size + candidate.own_numbers(self.windows, self.predictor.runs)

    def states_for(self, hypothesis: Hypothesis, near: Fit | None = None) -> dict[Window, Array]:
        """Initial states to start a fit from: those of a fit nearby, or read off the recording."""
        states = {}
        for window in self.windows:
            if near is not None and window in near.states:
                states[window] = carry_state(self.predictor, near.hypothesis, hypothesis, near.states[window])
                continue
            found = self.first_states.get(window)
            if found is None:
                states[window] = self.read_off(hypothesis, window)
            else:
                states[window] = carry_state(self.predictor, Hypothesis(), hypothesis, found)
        return states

    def read_off(self, hypothesis: Hypothesis, window: Window, span: float = STATE_READING_TIME) -> Array:
        """The initial state of any window as it is read off the recording over a span [s]."""
        return carry_state(self.predictor, Hypothesis(), hypothesis, self._measured(window, span))

    def others(self, hypothesis: Hypothesis, windows: Sequence[Window] | None = None) -> list[dict[Window, Array]]:
        """Initial states as they are read off the recording, sharply and smoothly, for windows whose own have gone astray; of the
        study's windows, or of these.
        """
        windows = self.windows if windows is None else windows
        spans = sorted({STATE_READING_TIME, max(STATE_READING_TIME, self.swing / STATE_READING_PARTS)})
        return [{window: self.read_off(hypothesis, window, span) for window in windows} for span in spans]

    def _measured(self, window: Window, span: float) -> Array:
        key = (window, span)
        if key not in self._read:
            self._read[key] = measured_state(self.problem, self.predictor, window, span)
        return self._read[key]

    def fit(
        self,
        hypothesis: Hypothesis,
        starts: Sequence[Array],
        near: Fit | None,
        *,
        most_steps: int = SEARCH_STEPS,
        target: float = -np.inf,
    ) -> Fit:
        """The best fit of a hypothesis over several starting vectors; an earlier better one is kept."""
        best = self.fits.get(hypothesis.identity)
        whole = self.whole(hypothesis)
        objective, others = self.objective(hypothesis), self.others(hypothesis)
        for start in starts:
            found = fit(
                objective,
                start,
                self.states_for(hypothesis, near),
                most_steps=most_steps,
                enough=RANKING_GAIN,
                fixed=whole if whole.any() else None,
                target=target,
                others=others,
            )
            self.ends.setdefault(hypothesis.keys, []).append((found.score, found.x))
            if best is None or self.criterion(found) < self.criterion(best):
                best = found
        assert best is not None
        # Where a degree of freedom is added, every step is dear; whole numbers are then left as the scan found them.
        stiff = any(m.effect.adds_coordinates for m in hypothesis.members)
        if whole.any() and not stiff and best.score < WORTH_COUNTING_RATIO * self.samples:
            best = self._counted(best, whole, most_steps)
        # What leaves far more than the best set does is out of the question, bent or not.
        lowest = min((f.score for f in self.fits.values()), default=np.inf)
        near_enough = best.score < FAR_COST_RATIO * lowest or not hypothesis.members
        if best.linear.cost > HOPELESS_COST_RATIO * self.samples and near_enough and self.stretched(best):
            best = self._unbent(best, whole, most_steps)
        if near_enough:
            best = made_to_ring(self, best, most_steps)
        self.fits[hypothesis.identity] = best
        return best

    def sharpened(self, fitted: Fit) -> Fit:
        """The same fit with its linear view good to many more digits, for intervals."""
        objective = self.objective(fitted.hypothesis).on(fitted.windows)
        return replace(fitted, linear=sharply(objective, fitted.x, fitted.states, fitted.linear))

    def _unbent(self, best: Fit, whole: NDArray[np.bool_], most_steps: int) -> Fit:
        """The same fit with residuals taken to be as loud as they are.

        Beside a misfit far above the noise, tolerances that are weighed against the noise alone hold nothing back: a nominal
        quantity would leave them by a hundred deviations to smooth what something else makes.
        """
        louder = self.loudness(best)
        x = best.x.copy()
        x[: len(self.predictor.nominal)] = 0.0
        found = fit(
            self.objective(best.hypothesis), x, best.states,
            most_steps=most_steps, enough=RANKING_GAIN, fixed=whole if whole.any() else None, louder=louder,
        )  # fmt: skip
        # It begins far from where the first one ended, perhaps in a wrong valley.
        return min(found, best, key=lambda f: f.cost + louder * f.prior)

    def _counted(self, best: Fit, whole: NDArray[np.bool_], most_steps: int) -> Fit:
        """The same fit with whole numbers that the search by steepest gain may have missed by one or two put right."""
        parameters = [p for member in best.hypothesis.members for p in member.effect.parameters]
        for index in np.flatnonzero(whole):
            least = max(parameters[index - len(self.predictor.nominal)].lower, 1.0)
            for sense in (1.0, -1.0):
                while self.counted(best, int(index)) + sense >= least:
                    other = self.neighbour(best, int(index), sense, most_steps)
                    if other.score > best.score - 1e-6:
                        break
                    best = other
        return best

    def whole(self, hypothesis: Hypothesis) -> NDArray[np.bool_]:
        """Which places of the parameter vector hold whole numbers."""
        own = (whole_numbers(member) for member in hypothesis.members)
        return np.concatenate([np.zeros(len(self.predictor.nominal), bool), *own])

    def counted(self, fitted: Fit, index: int) -> float:
        """The value of a whole number in the parameter vector; its scale is one."""
        values = [
            self.predictor.effect_values(fitted.hypothesis, k, fitted.x) for k in range(len(fitted.hypothesis.members))
        ]
        return float(np.concatenate(values)[index - len(self.predictor.nominal)])

    def neighbour(self, best: Fit, index: int, by: float, most_steps: int = SEARCH_STEPS) -> Fit:
        """The fit with one whole number of the parameter vector changed, everything else fitted again."""
        x = best.x.copy()
        logarithmic = np.concatenate(
            [np.zeros(len(self.predictor.nominal), bool), *map(is_logarithmic, best.hypothesis.members)]
        )
        x[index] = np.log(self.counted(best, index) + by) if logarithmic[index] else x[index] + by
        held = self.whole(best.hypothesis)
        return fit(
            self.objective(best.hypothesis), x, best.states,
            most_steps=most_steps, enough=RANKING_GAIN, fixed=held, target=best.score,
        )  # fmt: skip

    def stretched(self, fitted: Fit, louder: float = 1.0) -> bool:
        """Whether the nominal quantities had to leave their stated tolerance to fit, beside residuals of variance ``louder``."""
        return bool(chi2.sf(fitted.prior / louder, max(len(self.predictor.nominal), 1)) < STRETCHED_CHANCE)

    def loudness(self, fitted: Fit) -> float:
        """Variance of what a fit leaves, in units of the noise's; one at least."""
        return max(fitted.cost / self.samples, 1.0)

    @property
    def left_out(self) -> bool:
        """Whether the likelihood knows of a force that every set leaves out: beside that no set is complete."""
        return self.likelihood.discrepancy is not None

    def only_noise(self, fitted: Fit) -> bool:
        """Whether a fit leaves no more than noise alone would at times."""
        return fitted.score <= self.samples + CLEARLY_NOISE_SIGMAS * float(np.sqrt(2.0 * self.samples))

    def known(self, hypothesis: Hypothesis) -> Fit | None:
        """The fit of a hypothesis if there is one; one under an earlier estimate of the noise is fitted again from its end."""
        found = self.fits.get(hypothesis.identity)
        if found is None and self.before is not None:
            earlier = self.before.fits.get(hypothesis.identity)
            if earlier is not None:
                found = self.fit(hypothesis, [earlier.x], earlier)
        return found

    def was_exchanged(self, base: Fit, candidate: Candidate, way: str = "") -> bool:
        """Whether a member of a set was exchanged for a candidate, from where the set stands or under an earlier estimate of the
        noise; it counts as exchanged from now on. way: of beginning it, if there is more than one."""
        key = (base.hypothesis.identity, candidate.key + way)
        tried = base.score > self.exchanged.get(key, np.inf) - NOTICEABLE_GAIN
        if key not in self.exchanged and self.before is not None:
            tried = key in self.before.exchanged
        self.exchanged[key] = base.score
        return tried

    def empty(self) -> Fit:
        """The fit of the hypothesis that nothing is missing."""
        key: frozenset[str] = frozenset()
        if key not in self.fits:
            hypothesis = Hypothesis()
            self.fit(hypothesis, [np.zeros(self.predictor.size(hypothesis))], None)
        return self.fits[key]

    def ranked(self, base: Fit) -> list[Score]:
        """Score tests of all candidates against a fit, best first."""
        return self.among(base, self.candidates)

    def among(self, base: Fit, candidates: Sequence[Candidate]) -> list[Score]:
        """Score tests of some candidates against a fit, best first."""
        key = base.hypothesis.identity
        known = self.tests.setdefault(key, {})
        if self.before is not None and key in self.before.tests and base.score > PLAINLY_MORE_THAN_NOISE * self.samples:
            earlier = self.before.fits[key].score
            if abs(earlier - base.score) < ALIKE_SCORES * base.score:
                # Beside what is left there, this other estimate of the noise changes little.
                known.update({k: s for k, s in self.before.tests[key].items() if k not in known})
        missing = [c for c in candidates if c.key not in known]
        if missing:
            known.update(dict.fromkeys((c.key for c in missing), None))
            known.update({s.candidate.key: s for s in self._tested(base, missing)})
        found = [known[c.key] for c in candidates]
        return sorted((s for s in found if s is not None), key=lambda s: -s.gain)

    @property
    def cheap(self) -> tuple[Candidate, ...]:
        """Candidates that are not dear to run."""
        return tuple(c for c in self.candidates if not dear(c))

    def likely(self, base: Fit) -> list[Score]:
        """The same without what is dear to fit where something else promises to explain nearly all that is left."""
        excess = base.score - self.samples
        if base.score < PLAINLY_MORE_THAN_NOISE * self.samples:
            return self.ranked(base)
        cheap = self.among(base, self.cheap)
        best = max((s.gain for s in cheap), default=0.0)
        return cheap if best > SUFFICIENT_SHARE * excess else self.ranked(base)

    def _tested(self, base: Fit, candidates: Sequence[Candidate]) -> list[Score]:
        open_ones = [c for c in candidates if compatible(base.hypothesis, c)]
        switched = [s for c in open_ones if c.effect.switch for s in self._switched_on(base, c)]
        open_ones = [c for c in open_ones if not c.effect.switch]
        spaces = [nuisance(base, self.predictor)]
        if not self.stretched(base):
            return switched + score(base, self.predictor, self.likelihood, open_ones, self.problem, spaces)
        spaces.append(nuisance(base, self.predictor, softened=True))
        found = score(base, self.predictor, self.likelihood, open_ones, self.problem, spaces)
        keys = {c.key for c in open_ones}
        hints = self.hints.get(base.hypothesis.identity, {})
        return switched + _larger(found, [s for k, s in hints.items() if s is not None and k in keys])

    def _switched_on(self, base: Fit, candidate: Candidate) -> list[Score]:
        """What is either there or not, held against a fit: it has no slope where it is absent, and so it is fitted outright.

        Without it the nominal quantities have been bent to do its work, and so it is begun with these as stated, too.
        """
        hypothesis = base.hypothesis.with_(candidate)
        known = self.known(hypothesis)
        if known is None:
            straight = base.x.copy()
            straight[: len(self.predictor.nominal)] = 0.0
            known = self.fit(hypothesis, [straight, base.x], base)
        gain = base.score - known.score
        return [Score(candidate, gain, np.empty(0), float(np.sqrt(gain)))] if gain > 0.0 else []

    def extend(self, base: Fit, found: Score, *, most_steps: int = EXTENDING_STEPS) -> Fit:
        """The fit of a hypothesis with one more effect, from the score test's starting point."""
        hypothesis = base.hypothesis.with_(found.candidate)
        known = self.known(hypothesis)
        # Worth going on with only as long as it may beat the best set known.
        best = min((f.score for f in self.fits.values()), default=np.inf)
        target = max(best, 0.0) + self.price(found.candidate)
        pair = (base.hypothesis.identity, found.candidate.key)
        promised = base.score - found.gain
        if known is not None:
            # What fits worse than a special case of itself, or than a linear view promises, was begun in a wrong valley or was
            # given up on the way.
            near = known.score < HOPELESS_COST_RATIO * self.samples and promised < known.score - NOTICEABLE_GAIN
            astray = near or (known.score > base.score and promised <= target)
            if pair in self.extended or (self.before is not None and pair in self.before.extended) or not astray:
                return known
        self.extended.add(pair)
        addition = Addition(self, base, found.candidate, found.start)
        begun = [(way, start) for way in beginnings().values() for start in way.starts(addition)]
        starts = [start for _, start in begun]
        nearer = brought_back(self, base, hypothesis, starts[0])
        if nearer is not None:
            reached = self.fit(hypothesis, [nearer.x], nearer, most_steps=most_steps, target=target)
            if reached.score < promised + NOTICEABLE_GAIN:
                del starts[0]
        fitted = in_shape(self, self.fit(hypothesis, starts, base, most_steps=most_steps, target=target), target)
        settled = fitted.score < HOPELESS_COST_RATIO * self.samples and not self.stretched(fitted)
        if settled or not self.stretched(base):
            return fitted
        likeliest = [start for way, start in begun if way.likeliest][-1]
        return bent_back(self, base, likeliest, hypothesis, most_steps, target)

    def below(self, base: Fit, k: int) -> Fit:
        """The best fit known without member ``k`` and without anything that ``base`` does not have.

        A smaller set is a special case of a larger one, so a fit of it that has ended in a wrong valley does not count.
        """
        self.reduce(base, k)
        allowed = base.hypothesis.without(k).identity
        found = min((f for key, f in self.fits.items() if key <= allowed), key=lambda f: f.score)
        near = found.score < base.score + UNDER_WAY_GAIN
        if found.converged or not near or found.hypothesis.identity in self.anew:
            return found
        # What crawls along a valley may be bent to a wrong one, and an effect be called for to lead out of it.
        self.anew.add(found.hypothesis.identity)
        unbent = found.x.copy()
        unbent[: len(self.predictor.nominal)] = 0.0
        return min(found, self.fit(found.hypothesis, [unbent], found, most_steps=PATIENT_STEPS), key=lambda f: f.score)

    def alone(self, base: Fit, k: int) -> Fit:
        """The fit of member ``k`` by itself, from where it stands in ``base``."""
        hypothesis = Hypothesis((base.hypothesis.members[k],))
        known = self.known(hypothesis)
        if known is not None:
            return known
        nominal, span = len(self.predictor.nominal), base.hypothesis.span(k)
        own = base.x[nominal + span.start : nominal + span.stop]
        return self.fit(hypothesis, [np.concatenate([base.x[:nominal], own])], base)

    def reduce(self, base: Fit, k: int) -> Fit:
        """The fit without member ``k``, from where the larger one stands."""
        hypothesis = base.hypothesis.without(k)
        known = self.known(hypothesis)
        others = self.without(base, k)
        if known is not None:
            # Where the larger set stands may be nearer to the best fit than where the smaller one has ended.
            nearer = self._at(hypothesis, others, base) < known.score or self._astray(known, base, k)
            return self.fit(hypothesis, [others], base) if nearer else known
        nested = min(
            (f for key, f in self.fits.items() if key < hypothesis.identity), key=lambda f: f.score, default=None
        )
        ways = [(others, base)]
        if nested is not None:
            # A special case cannot fit better, and where it does, the nominal quantities there know the way out of a wrong valley.
            count = len(self.predictor.nominal)
            ways.append((np.concatenate([nested.x[:count], others[count:]]), nested))
            ways.sort(key=lambda way: self._at(hypothesis, *way))
        for start, near in ways:
            found = self.fit(hypothesis, [start], near)
            if nested is None or found.score <= nested.score:
                break
        if hypothesis.members and self.stretched(found) and found.cost < HOPELESS_COST_RATIO * self.samples:
            found = bent_back(self, base, found.x, hypothesis, most_steps=BENT_BACK_STEPS)
        return found

    def _astray(self, known: Fit, base: Fit, k: int) -> bool:
        """Whether a fit without member ``k`` is far worse than the set with it, which can do without it; true once."""
        member = base.hypothesis.members[k]
        pair = (base.hypothesis.identity, member.key)
        price = self.price(member)
        if pair in self.reduced or known.score < base.score + price + NOTICEABLE_GAIN:
            return False
        self.reduced.add(pair)
        return rise_without(base, len(self.predictor.nominal), k) < price

    def _at(self, hypothesis: Hypothesis, x: Array, near: Fit) -> float:
        """Score of a point with the initial states of a fit nearby."""
        objective = self.objective(hypothesis)
        ((cost, _),) = objective.residuals([(x, self.states_for(hypothesis, near))])
        return cost + objective.prior(x)

    def standing_without(self, best: Fit, k: int) -> Fit:
        """What a set leaves without member ``k`` where all others, the nominal quantities among them, stand."""
        rest = best.hypothesis.without(k)
        states = self.states_for(rest, best)
        return fit(self.objective(rest), self.without(best, k), states, fixed=self.whole(rest), most_steps=0)

    def without(self, base: Fit, k: int) -> Array:
        """The parameter vector without those of member ``k``."""
        return self.predictor.without(base.hypothesis, k, base.x)


def _larger(own: Sequence[Score], other: Sequence[Score]) -> list[Score]:
    """Of two rankings the score of every candidate that promises more, best first."""
    best: dict[str, Score] = {}
    for found in [*own, *other]:
        known = best.get(found.candidate.key)
        if known is None or found.gain > known.gain:
            best[found.candidate.key] = found
    return sorted(best.values(), key=lambda s: -s.gain)


def log_choose(n: int, k: int) -> float:
    """Logarithm of the number of ways to choose k of n."""
    return lgamma(n + 1) - lgamma(k + 1) - lgamma(n - k + 1)
