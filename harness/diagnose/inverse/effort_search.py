"""Which set of effects explains recorded efforts: score tests, joint fits, judgement on data held out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.inverse.constants import (
    BEAM_WIDTH,
    EFFECTS_A_JOINT,
    GLANCE_EVALUATIONS,
    MOST_CANDIDATES,
    MOST_EFFECTS,
    MOST_RIVALS,
    MOST_STARTS,
    PARTED_SIGMAS,
    RIVAL_LACK,
    RIVAL_TRACE_RATIO,
    TRACE_RATIO,
)
from harness.diagnose.inverse.effort_fit import EffortData, EffortFit, fit_effort, spread, unfitted
from harness.diagnose.inverse.effort_model import LAWS
from harness.diagnose.inverse.effort_noise import EffortNoise
from harness.diagnose.inverse.heldout_gain import heldout_gain
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis, compatible
from harness.diagnose.selection.study import log_choose

Array = NDArray[np.float64]

TURNED = "sensor_gain"  # whose sign may be another one
Ranked = list[tuple[float, Candidate, Array]]  # by how much smaller the cost would be; with a start each


@dataclass(eq=False)
class EffortStudy:
    """Fits of hypotheses to the training data, kept; and their judgement on data held out."""

    data: EffortData
    held: EffortData
    candidates: tuple[Candidate, ...]
    fits: dict[frozenset[str], EffortFit] = field(default_factory=dict)
    traces: dict[str, tuple[list[Array], Array]] = field(default_factory=dict)

    @property
    def nothing(self) -> EffortFit:
        """The fit of the nominal model, its quantities within their tolerance."""
        return self.fits[frozenset()]

    @property
    def nominal(self) -> int:
        return len(self.data.model.nominal)

    def under(self, noises: tuple[EffortNoise, ...]) -> EffortStudy:
        """The same with nothing fitted yet, under another noise of each joint."""
        return EffortStudy(self.data.under(noises), self.held.under(noises), self.candidates)

    def criterion(self, fitted: EffortFit) -> float:
        """Extended Bayesian information criterion (Chen and Chen, Biometrika 95 (2008) 759, γ = 1), and how plausible sizes are."""
        return fitted.cost + self.price(fitted.hypothesis) + self.surprise(fitted)

    def surprise(self, fitted: EffortFit) -> float:
        """−2 log of how plausible the sizes of a fit's effects are: of what efforts cannot part, the usual comes first."""
        spans = self.data.model.spans(fitted.hypothesis)
        return sum(m.surprise(fitted.x[span]) for m, span in zip(fitted.hypothesis.members, spans, strict=True))

    def price(self, hypothesis: Hypothesis) -> float:
        """What a set of effects has to bring to be as good as none."""
        rare = sum(m.effect.rarity for m in hypothesis.members)
        sets = log_choose(len(self.candidates), len(hypothesis.members))
        return hypothesis.size * float(np.log(self.data.samples)) + 2.0 * (sets + rare)

    def fit(self, hypothesis: Hypothesis, starts: Sequence[Array]) -> EffortFit:
        best = self.fits.get(hypothesis.identity)
        for start in starts:
            found = fit_effort(self.data, hypothesis, start)
            if best is None or found.cost < best.cost:
                best = found
        assert best is not None
        self.fits[hypothesis.identity] = best
        return best

    def best(self) -> EffortFit:
        """The best fit so far by the criterion."""
        return min(self.fits.values(), key=self.criterion)

    def held_rows(self, fitted: EffortFit) -> Array:
        """Whitened residuals of the data held out, nothing fitted to them, in units of the noise that the fit left."""
        rows = self.held.rows(fitted.hypothesis, fitted.x)
        raw = self.data.rows(fitted.hypothesis, fitted.x)
        return np.asarray(rows / self.data.size_of_each(raw)[self.held.whitened.which])

    def heldout_z(self, smaller: EffortFit, larger: EffortFit) -> float:
        """How much better the larger hypothesis predicts data held out, in standard deviations."""
        rows = self.held.rows(smaller.hypothesis, smaller.x)
        other = self.held.rows(larger.hypothesis, larger.x)
        size = self.held.size(other)
        return heldout_gain(rows / size, other / size)

    def from_nothing(self, fitted: EffortFit, k: int) -> float:
        """Standard deviations that the first parameter of member ``k`` is away from where the effect is absent."""
        first = fitted.hypothesis.members[k].effect.parameters[0]
        at = self.nominal + fitted.hypothesis.span(k).start
        sigma = float(spread(fitted, self.nominal)[at])
        origin = first.neutral if np.isfinite(first.neutral) else 0.0
        return abs(float(fitted.x[at]) - origin) / sigma if sigma > 0.0 else float("inf")

    def weight(self, fitted: EffortFit) -> float:
        """Criterion of the training data, and the same of the data held out without a fit: smaller is better."""
        rows = self.held.rows(fitted.hypothesis, fitted.x)
        return self.criterion(fitted) + self.held.misfit(rows)

    def ranked(self, base: EffortFit) -> Ranked:
        """Candidates by how much smaller their trace would make the cost beside what is fitted, with a start each."""
        here = self.data.rows(base.hypothesis, base.x)
        size = self.data.size(here)
        # What the nominal quantities may still take is limited by their prior, so those columns carry it.
        prior = np.zeros((self.nominal, base.jacobian.shape[1]))
        prior[:, : self.nominal] = np.eye(self.nominal)
        basis, _ = np.linalg.qr(np.vstack([base.jacobian, prior]))
        rest = np.concatenate([here / size, base.x[: self.nominal]])
        rest = rest - basis @ (basis.T @ rest)
        seen = basis[: len(here)]
        out = []
        for candidate in self.candidates:
            if not compatible(base.hypothesis, candidate):
                continue
            starts, traces = self.traces_of(candidate)
            # Beside the basis, whose rows of the prior a trace has nothing in.
            traces = traces / size
            inside = traces @ seen
            along = traces @ rest[: len(here)] - inside @ (basis.T @ rest)
            plane = PLANES.get(candidate.effect.name)
            if plane is not None:
                gram = traces @ traces.T - inside @ inside.T
                gained, k, start = _in_plane(starts, along, gram, plane.values)
                out.append((self._told(gained, traces[k]), candidate, start))
                continue
            length = np.einsum("ij,ij->i", traces, traces) - np.einsum("ij,ij->i", inside, inside)
            there = length > 1e-12
            gain = np.where(there, along**2 / np.where(there, length, 1.0), 0.0)
            k = int(np.argmax(np.where(np.isfinite(gain), gain, -1.0)))
            times = -float(along[k] / length[k]) if there[k] else 1.0
            told = self._told(float(gain[k]), traces[k])
            out.append((told, candidate, _begun(candidate, starts[k], times)))
        return sorted(out, key=lambda item: -item[0])

    def _told(self, gain: float, trace: Array) -> float:
        """What a gain in squares takes off the cost where joints' sizes follow: N log(N / (N − gain)), N of the joints it is at."""
        at = self.data.of_each(trace)
        count = float(at @ self.data.counts) / max(float(at.sum()), 1e-300)
        return -count * float(np.log1p(-min(gain / max(count, 1e-300), 1.0 - 1e-9)))

    def traces_of(self, candidate: Candidate) -> tuple[list[Array], Array]:
        """Starts of a candidate and what each changes in the rows of the nominal model, (starts, rows).

        Beside other effects and other nominal quantities that is a little different, which matters little to an order.
        """
        if candidate.key not in self.traces:
            blank = np.zeros(self.nominal)
            hypothesis, starts = Hypothesis().with_(candidate), starts_of(candidate)
            acting = candidate.effect.input
            bent = candidate.effect.name == TURNED or (acting is not None and acting.nonlinear)
            if len(candidate.effect.parameters) == 1 and not bent:
                # Of a single number, what one size of it changes all others do as well, but for how much; a limit or a dead zone
                # acts on other samples at another size, and no small gain leads to a wrong sign.
                starts = starts[:1]
            here = self.data.rows(Hypothesis(), blank)
            rows = [self.data.rows(hypothesis, np.concatenate([blank, start])) - here for start in starts]
            self.traces[candidate.key] = starts, np.array(rows)
        return self.traces[candidate.key]

    def promising(self, base: EffortFit, ranked: Ranked) -> list[tuple[Candidate, Array]]:
        """The candidates that come first beside a fit, without those that would not pay if their trace brought twice as much."""
        first = ranked[:MOST_CANDIDATES]
        return [(c, start) for gain, c, start in first if TRACE_RATIO * gain >= self.asks(base, c)]

    def asks(self, base: EffortFit, candidate: Candidate) -> float:
        """What one more effect has to bring."""
        return self.price(base.hypothesis.with_(candidate)) - self.price(base.hypothesis)

    def at_every_joint(self, base: EffortFit, ranked: Ranked, most: int) -> EffortFit | None:
        """A fit with the law that pays most at each joint, of all joints at once; None where fewer than two have one.

        Laws of one joint say nothing of another's effort, so that who adds them one by one asks the same again and again.
        """
        hypothesis, starts, sites = base.hypothesis, [base.x], set[str]()
        for gain, candidate, start in ranked:
            if candidate.effect.name not in LAWS or candidate.site in sites or gain < self.asks(base, candidate):
                continue
            if len(hypothesis.members) < most:
                sites.add(candidate.site)
                hypothesis, starts = hypothesis.with_(candidate), [*starts, start]
        if len(sites) < 2:
            return None
        return self.fits.get(hypothesis.identity) or self.fit(hypothesis, [np.concatenate(starts)])

    def of_every_servo(self, base: EffortFit, ranked: Ranked, most: int) -> list[EffortFit]:
        """Fits with a servo's effect at every joint that can have it, of all joints at once; one for each such effect.

        Servos of an arm are mostly of one make, and off alike. With that of one joint alone, damping and loads are bent to make up
        for the others.
        """
        kinds: dict[str, list[tuple[Candidate, Array]]] = {}
        for _, candidate, start in ranked:
            if candidate.effect.of_servo:
                kinds.setdefault(candidate.effect.name, []).append((candidate, start))
        room = most - len(base.hypothesis.members)
        return [self.glance(base, *own) for own in kinds.values() if 1 < len(own) <= room]

    def extend(self, base: EffortFit, candidate: Candidate, start: Array) -> EffortFit:
        hypothesis = base.hypothesis.with_(candidate)
        known = self.fits.get(hypothesis.identity)
        return known or self.fit(hypothesis, [np.concatenate([base.x, start])])

    def glance(self, base: EffortFit, *added: tuple[Candidate, Array]) -> EffortFit:
        """Where a few evaluations take ``base`` with more effects, begun from a start each; the fit where it is known."""
        hypothesis = base.hypothesis
        for candidate, _ in added:
            hypothesis = hypothesis.with_(candidate)
        start = np.concatenate([base.x, *(own for _, own in added)])
        known = self.fits.get(hypothesis.identity)
        return known or fit_effort(self.data, hypothesis, start, calls=GLANCE_EVALUATIONS)

    def reduce(self, base: EffortFit, k: int) -> EffortFit:
        """The best fit known of anything within ``base`` less member ``k``."""
        hypothesis = base.hypothesis.without(k)
        if hypothesis.identity not in self.fits:
            others = base.x[self._others(base, k)]
            self.fit(hypothesis, [others] if hypothesis.members else [others, np.zeros(self.nominal)])
        return min((f for key, f in self.fits.items() if key <= hypothesis.identity), key=lambda f: f.cost)

    def seen_without(self, base: EffortFit, k: int) -> EffortFit:
        """Where ``base`` less member ``k`` would end were all linear, with its cost there: no less than that of its fit."""
        hypothesis, keep = base.hypothesis.without(k), self._others(base, k)
        if hypothesis.identity in self.fits:
            return self.reduce(base, k)
        others = base.x[keep]
        # What the member did in the rows has to be made up for by the others, whose prior pulls the nominal ones.
        size = self.data.size(self.data.rows(base.hypothesis, base.x))
        missing = base.rows - self.data.rows(hypothesis, others) / size
        held = np.vstack([base.jacobian[:, keep], np.eye(self.nominal, len(others))])
        step = np.linalg.lstsq(held, np.concatenate([missing, np.zeros(self.nominal)]), rcond=None)[0]
        return unfitted(self.data, hypothesis, others + step)

    def _others(self, base: EffortFit, k: int) -> NDArray[np.bool_]:
        """Which numbers of a fit are not member ``k``'s."""
        span, keep = base.hypothesis.span(k), np.ones(len(base.x), dtype=bool)
        keep[self.nominal + span.start : self.nominal + span.stop] = False
        return keep

    def plainer(self, base: EffortFit, k: int) -> EffortFit:
        """The better of ``base`` less member ``k`` and of what has a special case of it in its place."""
        without, member = self.reduce(base, k), base.hypothesis.members[k]
        special = [c for c in self.candidates if c.site == member.site and c.effect.name in member.effect.simpler]
        options = [
            without,
            *(self.extend(without, c, starts_of(c)[0]) for c in special if compatible(without.hypothesis, c)),
        ]
        return min(options, key=self.criterion)

    def rivals(self, best: EffortFit, k: int) -> list[tuple[Candidate, EffortFit]]:
        """Candidates that could stand in the place of member ``k``, likeliest first, with their fits.

        Those are about as likely, or do about as much and are less likely by what a few stretches say (``parting``).
        """
        without = self.reduce(best, k)
        limit = self.weight(best) + UNPARTED_EVIDENCE
        # A rival that does about as much may be so much less likely.
        lack = max(UNPARTED_EVIDENCE, RIVAL_LACK * (self.criterion(without) - self.criterion(best)))
        # What a few steps bring not half as near as the member came will not come near it.
        hopeless = max(3.0 * UNPARTED_EVIDENCE, 0.5 * (self.criterion(without) - self.criterion(best)))
        out = []
        for gain, candidate, start in self.ranked(without)[:MOST_RIVALS]:
            if candidate.key in best.hypothesis.keys or _elsewhere(candidate, best.hypothesis.members[k]):
                continue
            # Where what a trace explains is far off, so is the candidate. A law of a single number explains no more than its trace.
            most = gain if linear(candidate) else RIVAL_TRACE_RATIO * gain
            asks = self.criterion(without) + self.asks(without, candidate)
            if asks - most > self.criterion(best) + lack:
                continue
            hypothesis = without.hypothesis.with_(candidate)
            if hypothesis.identity not in self.fits:
                seen = self.glance(without, (candidate, start))
                if self.criterion(seen) > self.criterion(best) + hopeless:
                    continue
                start = seen.x[self.nominal + without.hypothesis.size :]
            found = self.extend(without, candidate, start)
            near = self.criterion(found) < self.criterion(best) + UNPARTED_EVIDENCE and self.weight(found) < limit
            if near or (
                self.criterion(found) < self.criterion(best) + lack and self.parting(best, found) < PARTED_SIGMAS
            ):
                out.append((candidate, found))
        return sorted(out, key=lambda pair: self.weight(pair[1]))

    def parting(self, better: EffortFit, other: EffortFit) -> float:
        """How surely all recordings, those held out too, say throughout that one set is better than another [standard deviations]
        (Vuong, Econometrica 57 (1989) 307).

        A likelihood adds up what all rows say. Where a few stretches decide, such as the turns of a joint, whose friction no law
        has quite right, it is the laws' errors there that speak.
        """
        size = self.data.size_of_each(self.data.rows(better.hypothesis, better.x))
        one, two = (
            np.concatenate([d.rows(f.hypothesis, f.x) / size[d.whitened.which] for d in (self.data, self.held)])
            for f in (other, better)
        )
        return heldout_gain(one, two)


def linear(candidate: Candidate) -> bool:
    """Whether the torque of a candidate is its only number times a shape."""
    return candidate.effect.name in LAWS and candidate.size == 1


def _elsewhere(candidate: Candidate, member: Candidate) -> bool:
    """Whether two laws act on the efforts of different joints, so that neither can do what the other does."""
    return candidate.effect.name in LAWS and member.effect.name in LAWS and candidate.site != member.site


def _begun(candidate: Candidate, start: Array, times: float) -> Array:
    """Where a fit begins: of a single number, as far from its absence as its trace asks for."""
    if len(start) > 1:
        return start
    (parameter,) = candidate.effect.parameters
    absent = parameter.neutral if np.isfinite(parameter.neutral) else 0.0
    away = times * (start - absent)
    if candidate.effect.law is None:
        # A trace is of a small change: what would take a much larger one is begun at the largest of the usual starts.
        most = max(abs(float(one[0]) - absent) for one in starts_of(candidate))
        away = np.clip(away, -most, most)
    asked = absent + away
    inside = np.all((parameter.lower < asked) & (asked < parameter.upper))
    return asked if inside and np.any(asked != absent) else start


class Plane(NamedTuple):
    """A law that is a sum of two shapes, of any sizes.

    starts: values of its parameters by a size of the first, in pairs, one of each shape; values: those that so many times the two
    of a pair stand for, None where the law has none.
    """

    starts: Callable[[float], list[Array]]
    values: Callable[[Array, Array], Array | None]


def _waves(amplitude: float) -> list[Array]:
    """Of each number of periods, whole ones that no slope leads to, a wave a quarter early and one on time."""
    return [np.array([amplitude, float(n), phase]) for n in range(2, 13) for phase in (-np.pi / 2.0, 0.0)]


def _wave(start: Array, times: Array) -> Array | None:
    # The first is −A sin φ times there, the other A cos φ times.
    amplitude = float(start[0] * np.hypot(*times))
    return np.array([amplitude, start[1], np.arctan2(-times[0], times[1])]) if amplitude > 0.0 else None


def _springs(stiffness: float) -> list[Array]:
    """One that is slack at one radian below zero, and one above."""
    return [np.array([stiffness, -1.0]), np.array([stiffness, 1.0])]


def _spring(start: Array, times: Array) -> Array | None:
    whole = float(np.sum(times))
    return np.array([start[0] * whole, (times[1] - times[0]) / whole]) if whole > 0.0 else None


PLANES = {"cogging_torque": Plane(_waves, _wave), "joint_stiffness": Plane(_springs, _spring)}


def _in_plane(
    starts: Sequence[Array], along: Array, gram: Array, values: Callable[[Array, Array], Array | None]
) -> tuple[float, int, Array]:
    """The gain of the best sum of two starts' traces, one of the two, and the values that it stands for.

    along: what the traces of the starts have in common with what is left, (starts,); gram: with one another.
    """
    best, which, found = 0.0, 0, starts[0]
    for k in range(0, len(starts), 2):
        pair = slice(k, k + 2)
        times = np.asarray(-np.linalg.lstsq(gram[pair, pair], along[pair], rcond=1e-9)[0], dtype=np.float64)
        gain, told = -float(times @ along[pair]), values(starts[k], times)
        if gain > best and told is not None:
            best, which, found = gain, k, told
    return best, which, found


def starts_of(candidate: Candidate) -> list[Array]:
    """Starting values of a candidate's parameters [SI]."""
    each = [p.start_values(candidate.references) for p in candidate.effect.parameters]
    if candidate.effect.name == TURNED:
        return [np.array([each[0][0]]), np.array([-1.0])]
    plane = PLANES.get(candidate.effect.name)
    if plane is not None:
        return plane.starts(float(each[0][0]))
    combinations = [np.array(c) for c in product(*each)]
    step = max(1, len(combinations) // MOST_STARTS)
    return combinations[::step]


def search(
    study: EffortStudy,
    progress: Callable[[str], None],
    turned: Callable[[EffortFit], EffortStudy | None] = lambda _: None,
) -> EffortFit:
    """The best set of effects by the criterion, grown from nothing.

    turned: another study of the same candidates to go on in, once it holds a better fit of the best set so far.
    """
    best = study.fit(Hypothesis(), [np.zeros(study.nominal)])
    beam = [best]
    most = max(MOST_EFFECTS, EFFECTS_A_JOINT * len(study.data.joints))
    while len(best.hypothesis.members) < most:
        other = turned(best)
        if other is not None:
            study = other
            beam = [study.fit(f.hypothesis, [f.x]) for f in beam]
            best = beam[0]
        grown: list[EffortFit] = []
        for base in beam:
            ranked = study.ranked(base)
            together = study.at_every_joint(base, ranked, most)
            grown += [study.glance(base, added) for added in study.promising(base, ranked)]
            grown += [] if together is None else [together]
            grown += study.of_every_servo(base, ranked, most)
        progress(f"efforts, {max((len(f.hypothesis.members) for f in grown), default=0)} effects")
        if not grown:
            break
        first = sorted({f.hypothesis.identity: f for f in grown}.values(), key=study.criterion)[:BEAM_WIDTH]
        beam = sorted((study.fit(f.hypothesis, [f.x]) for f in first), key=study.criterion)
        if study.criterion(beam[0]) >= study.criterion(best):
            break
        best = beam[0]
    return best
