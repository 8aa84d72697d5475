"""Linearised score tests: how much of what a fitted hypothesis leaves would each further effect take away?

The change that an effect makes to the prediction is projected off everything that the hypothesis may adjust anyway
(initial states, nominal quantities, the parameters of the effects it already has); what remains is held against the
residual. Nothing is fitted, so the whole catalogue costs little more than one run for each starting point.

Waves of force are scanned over period and frequency through the linear response along the motion, since no slope leads from one of
them to another. A law that is either there or not (geometric stiffening) has no slope where it is absent and is fitted outright.
Sensors cost no run, so those that are not linear in how strongly they act are tested at likely sizes too. Nominal quantities that
are bent far stand for an effect along a valley too narrow to walk back; tests are then also made with the noise enlarged, so that
only the tolerances speak.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from harness.diagnose.estimation.angle_waves import without_waves
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.linear_response import Response, channels_moved, respond, responsive
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor, Request
from harness.diagnose.problem.hypothesis import Candidate, Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.constants.starts import (
    COARSEST_TOLERANCE,
    FIRST_NEARER,
    GREATEST_START_RATIO,
    LINEAR_EXTENT,
    LINEAR_MOTION_EXTENT,
    MOST_COGGING_PERIODS,
    NEAREST_TO_ABSENCE,
    RESIZED_RATIO,
    RESOLVED_NOISE,
    SOFTEST_SPRING_RATIO,
    TRUSTED_SIGMAS,
    UNRESOLVED_SHARE,
    WEAK_DIRECTION,
)
from harness.diagnose.selection.scan import Course, Scan
from harness.diagnose.selection.scans.catalogue import scanned, scans
from harness.diagnose.selection.starts import Ray, of_a_contact, rays
from harness.parallel import meanwhile

Array = NDArray[np.float64]

MOST_SAMPLES = 1_500_000  # of all lanes run at once and of changes kept at once, to bound memory
MOST_TOGETHER = 256  # columns whose inner products are all kept


@dataclass(frozen=True, eq=False)
class Score:
    """A candidate's best starting point against a fit.

    gain: reduction of the cost that the linear model promises; start: SI values scaled accordingly; share: of the cost that
    lies outside the adjustable directions; visible: norm of the projected direction [noise standard deviations].
    """

    candidate: Candidate
    gain: float
    start: Array
    visible: float


@dataclass(frozen=True, eq=False)
class Projected:
    """Inner products of columns without their adjustable part: with the residual, with themselves, with the next one; and
    all of them among each other (None for very many). Shapes (K,), (K,), (K − 1,), (K, K)."""

    along: Array
    squares: Array
    neighbours: Array
    gram: Array | None

    def gains(self) -> Array:
        """Gain in cost by each column alone, shape (K,); 0 for those of which nothing is left."""
        ok = self.squares > 1e-12 * max(float(self.squares.max(initial=0.0)), 1e-18)
        return np.where(ok, self.along**2 / np.where(ok, self.squares, 1.0), 0.0)


@dataclass(frozen=True, eq=False)
class Nuisance:
    """Orthonormal bases of what a fit may adjust: per window the initial state, over all windows the shared parameters.

    softness: factor on the noise of the data, the nominal quantities' priors staying as they are.
    """

    states: tuple[Array, ...]
    shared: Array
    residual: Array
    prior: Array
    softness: float = 1.0

    def measure(self, columns: Sequence[Array], *, only: int | None = None) -> Projected:
        """Whitened changes per window, each (K, M_w), without their adjustable part, held against the residual.

        only: the number of the window that ``columns`` (one array) belongs to, if they change nothing elsewhere.
        The columns themselves are never projected: what is adjustable of them is told by a few inner products.
        """
        windows = range(len(self.states)) if only is None else [only]
        if self.softness != 1.0:
            columns = [c / self.softness for c in columns]
        edges = np.cumsum([0, *(len(q) for q in self.states)])
        count = columns[0].shape[0]
        along, raw = np.zeros(count), np.zeros(count)
        gram = np.zeros((count, count)) if count <= MOST_TOGETHER else None
        neighbours = np.zeros(max(count - 1, 0))
        of_shared = np.zeros((count, self.shared.shape[1]))
        of_states = []
        for c, w in zip(columns, windows, strict=True):
            rows = slice(edges[w], edges[w + 1])
            along += c @ self.residual[rows]
            of_shared += c @ self.shared[rows]
            of_states.append(c @ self.states[w])
            if gram is None:
                raw += np.einsum("ij,ij->i", c, c)
                neighbours += np.einsum("ij,ij->i", c[:-1], c[1:])
            else:
                gram += c @ c.T
        adjustable = np.hstack([of_shared, *of_states])
        if gram is not None:
            gram -= adjustable @ adjustable.T
            squares, beside = np.diag(gram), np.diag(gram, 1)
        else:
            squares = raw - np.einsum("ij,ij->i", adjustable, adjustable)
            beside = neighbours - np.einsum("ij,ij->i", adjustable[:-1], adjustable[1:])
        raw = squares + np.einsum("ij,ij->i", adjustable, adjustable)
        return Projected(along, np.where(squares > UNRESOLVED_SHARE * raw, squares, 0.0), beside, gram)


def nuisance(fitted: Fit, predictor: Predictor, *, softened: bool = False) -> Nuisance:
    """Bases of what a fit may adjust, at the fit.

    softened: whether the data's noise is taken so large that no parameter moves them by more than ``TRUSTED_SIGMAS`` of its
    deviations. What gives the same motion as a nominal quantity bent out of its tolerance can only be seen so: of two directions
    that differ by less than the linear view is good to, neither could otherwise take the other's place.
    """
    states = []
    for basis in fitted.linear.bases:
        q, r = qr(basis, mode="economic", check_finite=False)
        diagonal = np.abs(np.diag(r))
        states.append(q[:, diagonal > 1e-9 * max(float(diagonal.max(initial=0.0)), 1e-300)])
    parts = [j - q @ (q.T @ j) for j, q in zip(fitted.linear.shared, states, strict=True)]
    residuals = [r - q @ (q.T @ r) for r, q in zip(fitted.linear.residuals, states, strict=True)]
    k = len(predictor.nominal)
    size = len(fitted.x)
    softness = 1.0
    if softened and parts:
        largest = float(np.sqrt(max(sum(float(np.sum(part[:, :k] ** 2)) for part in parts), 0.0)))
        softness = max(1.0, largest / TRUSTED_SIGMAS)
        parts = [part / softness for part in parts]
        residuals = [r / softness for r in residuals]
    prior_rows = np.eye(size)[:k] if k else np.zeros((0, size))
    stacked = np.vstack([*parts, prior_rows])[:, fitted.free]
    u, s, _ = np.linalg.svd(stacked, full_matrices=False) if stacked.shape[1] else (stacked, np.zeros(0), None)
    basis = u[:, s > 1e-9 * max(float(s.max(initial=0.0)), 1e-300)] if len(s) else np.zeros((stacked.shape[0], 0))
    right = np.concatenate([*residuals, fitted.x[:k]])
    return Nuisance(tuple(states), basis, right - basis @ (basis.T @ right), fitted.x[:k], softness)


def score(
    fitted: Fit,
    predictor: Predictor,
    likelihood: Likelihood,
    candidates: Sequence[Candidate],
    problem: Problem,
    spaces: Sequence[Nuisance],
) -> list[Score]:
    """Every candidate against a fit, best first; candidates that change nothing visible are left out.

    spaces: of what the fit may adjust, of which the one counts that promises most.
    """
    asked = [
        (candidate, [*rays(candidate, problem), *_beyond_the_scan(fitted, predictor, candidate, problem)])
        for candidate in candidates
    ]

    def scored(some: Sequence[tuple[Candidate, Sequence[Ray]]]) -> list[Score]:
        found = []
        motions: dict[Window, Response] = {}
        for batch in _batches(some, fitted):
            points = [[point for line in lines for point in line] for _, lines in batch]
            near = near_changes(fitted, predictor, likelihood, [c for c, _ in batch], points, motions)
            at_size = _at_size(fitted, predictor, likelihood, batch, spaces)
            for (candidate, lines), (starts, changes, factors) in zip(batch, near, strict=True):
                own = [s for space in spaces for s in _along_rays(candidate, lines, space, starts, changes, factors)]
                own += at_size.get(candidate.key, [])
                found += sorted(own, key=lambda s: -s.gain)[:1]
        return found

    # Two lots that take about as long, most of the first in compiled code.
    first = [k for k, (candidate, _) in enumerate(asked) if candidate.effect.adds_coordinates]
    first = first or [k for k, (candidate, _) in enumerate(asked) if scanned(candidate)]
    of_first = meanwhile(predictor.threads, scored, [asked[k] for k in first])
    found = scored([one for k, one in enumerate(asked) if k not in first])
    return sorted([*found, *of_first()], key=lambda s: -s.gain)


def _beyond_the_scan(fitted: Fit, predictor: Predictor, candidate: Candidate, problem: Problem) -> list[Ray]:
    """Where an encoder's error has more periods a turn than are tried one by one: those of the residual's line over the angle."""
    names = [channel.name for channel in problem.channels]
    if candidate.effect.name != "encoder_interpolation" or candidate.site not in names:
        return []
    c = names.index(candidate.site)
    lanes = [(0, window, fitted.states[window]) for window in fitted.windows]
    predictions = predictor.predict(fitted.hypothesis, fitted.x[None], lanes)
    pieces, places = [], []
    for window, predicted in zip(fitted.windows, predictions, strict=True):
        left = problem.runs[window.run].values[c, window.first : window.last] - predicted[c]
        present = np.isfinite(left)
        pieces.append(left[present])
        places.append(predicted[c][present])
    _, lines = without_waves(pieces, places, problem.steps[c], most=1)
    size = candidate.scales[0]
    return [
        (np.array([size, round(line), 0.0]), np.array([size, round(line), 0.5 * np.pi]))
        for line in lines
        if line > MOST_COGGING_PERIODS
    ]


def by_place(
    fitted: Fit, predictor: Predictor, likelihood: Likelihood, candidate: Candidate, problem: Problem
) -> list[Score]:
    """One candidate's scores against a fit at every place that it is looked for at, best first."""
    lines = rays(candidate, problem)
    points = [[point for line in lines for point in line]]
    ((starts, changes, factors),) = near_changes(fitted, predictor, likelihood, [candidate], points, {})
    found = _along_rays(candidate, lines, nuisance(fitted, predictor), starts, changes, factors)
    return sorted(found, key=lambda s: -s.gain)


def _at_size(
    fitted: Fit,
    predictor: Predictor,
    likelihood: Likelihood,
    asked: Sequence[tuple[Candidate, Sequence[Ray]]],
    spaces: Sequence[Nuisance],
) -> dict[str, list[Score]]:
    """Scores of sensors whose readings are not linear in how strongly they act, at likely sizes; by candidate.

    A filter near the swing's frequency is another thing than a weak one many times stronger, which is a delay. Sensors cost no
    further run.
    """
    own = [(candidate, lines) for candidate, lines in asked if _bends(candidate)]
    points = [[point for line in lines for point in line] for _, lines in own]
    changes = change(fitted, predictor, likelihood, [candidate for candidate, _ in own], points)
    return {
        candidate.key: [s for space in spaces for s in _along_rays(candidate, lines, space, at, moved, [1.0] * len(at))]
        for (candidate, lines), at, moved in zip(own, points, changes, strict=True)
    }


def _bends(candidate: Candidate) -> bool:
    """Whether it is a sensor whose reading is not linear in how strongly it acts; one of the clock costs runs."""
    sensor = candidate.effect.sensor
    return sensor is not None and not sensor.linear and not sensor.clock


def _batches(
    asked: Sequence[tuple[Candidate, Sequence[Ray]]], fitted: Fit
) -> Iterator[list[tuple[Candidate, Sequence[Ray]]]]:
    """Candidates in stretches whose changes fit into memory together."""
    samples = sum(window.size for window in fitted.windows)
    batch: list[tuple[Candidate, Sequence[Ray]]] = []
    size = 0
    for candidate, lines in asked:
        own = samples * sum(len(line) for line in lines)
        if batch and size + own > MOST_SAMPLES:
            yield batch
            batch, size = [], 0
        batch.append((candidate, lines))
        size += own
    if batch:
        yield batch


def change(
    fitted: Fit,
    predictor: Predictor,
    likelihood: Likelihood,
    candidates: Sequence[Candidate],
    points: Sequence[Sequence[Array]],
) -> list[list[Array]]:
    """Whitened changes of the prediction when candidates are switched on, each at its SI ``points``: of every candidate, per
    window (k, M)."""
    requests, sources = [], []
    most = max(1, MOST_SAMPLES // sum(window.size for window in fitted.windows))
    for number, (candidate, own) in enumerate(zip(candidates, points, strict=True)):
        wider = fitted.hypothesis.with_(candidate)
        x = np.array([np.concatenate([fitted.x, to_internal(candidate, point)]) for point in own])
        states = [
            (w, carry_state(predictor, fitted.hypothesis, wider, fitted.states[window]))
            for w, window in enumerate(fitted.windows)
        ]
        for first in range(0, len(own), most):
            part = x[first : first + most]
            lanes = [(row, fitted.windows[w], state) for w, state in states for row in range(len(part))]
            requests.append(Request(wider, part, lanes, tolerance=_tolerance(likelihood, candidate)))
            sources.append(number)
    pieces: list[list[list[Array]]] = [[[] for _ in fitted.windows] for _ in candidates]
    for first, last in _stretches(requests):
        predicted = predictor.predict_all(requests[first:last])
        for number, request, lanes_out in zip(sources[first:last], requests[first:last], predicted, strict=True):
            count = len(request.x)
            for w, window in enumerate(fitted.windows):
                own_lanes = lanes_out[w * count : (w + 1) * count]
                changes = likelihood.whiten(window, own_lanes) - fitted.linear.residuals[w]
                # A run that could not be followed says nothing; as no motion at all it would explain whatever is left.
                changes[[not np.isfinite(lane).all() for lane in own_lanes]] = 0.0
                pieces[number][w].append(changes)
    return [[np.vstack(parts) for parts in own] for own in pieces]


def _tolerance(likelihood: Likelihood, candidate: Candidate) -> float:
    """Error of one step where a change is looked at as a whole, not divided by a small step: far below the noise."""
    if not candidate.effect.adds_coordinates:
        return 0.0
    return min(COARSEST_TOLERANCE, RESOLVED_NOISE * min(colour.std for colour in likelihood.colours))


def _stretches(requests: Sequence[Request]) -> Iterator[tuple[int, int]]:
    """Stretches of requests to be run together, first and last + 1: as many as fit into memory."""
    first, samples = 0, 0
    for k, request in enumerate(requests):
        own = sum(window.size for _, window, _ in request.lanes)
        if k > first and samples + own > MOST_SAMPLES:
            yield first, k
            first, samples = k, 0
        samples += own
    if requests:
        yield first, len(requests)


def scan(
    fitted: Fit,
    predictor: Predictor,
    likelihood: Likelihood,
    candidate: Candidate,
    points: Sequence[Array],
    motions: dict[Window, Response],
) -> list[Array]:
    """The same as ``change`` for scanned forces, to first order; ``motions`` keeps the linear responses."""
    parameters, how = np.array(points), scans()[candidate.effect.name]
    names = predictor.mechanism(fitted.hypothesis).names
    out = []
    for window in fitted.windows:
        if window not in motions:
            motions[window] = respond(predictor, fitted, window, candidate.references.torque)
        found = motions[window]
        time = found.time + predictor.runs[window.run].date(window.first)
        if how.shakes:
            propagated, course = found.by_shaking, Course(time, np.empty(0), np.empty(0))
        else:
            joint = names.index(candidate.site)
            propagated, course = partial(found.by_force, joint), Course(time, found.q[:, joint], found.qd[:, joint])
        histories = partial(_along, how, parameters, course)
        out.append(channels_moved(predictor, likelihood, fitted, found, propagated, len(parameters), histories))
    return out


def _along(how: Scan, parameters: Array, course: Course, own: slice) -> Array:
    """Forces of a stretch of the parameters along a course (K, G)."""
    return how.forces(parameters[own], course)


def carry_state(predictor: Predictor, before: Hypothesis, after: Hypothesis, state: Array) -> Array:
    """A state vector of one hypothesis in the coordinates of another, by name; new coordinates begin at rest at zero."""
    old, new = predictor.mechanism(before).names, predictor.mechanism(after).names
    if old == new:
        return state
    out = np.zeros(2 * len(new))
    for k, name in enumerate(new):
        if name in old:
            j = old.index(name)
            out[k], out[len(new) + k] = state[j], state[len(old) + j]
    return out


def brought_near(candidate: Candidate, point: Array, factor: float) -> Array:
    """A starting point with its effect made smaller by ``factor``, so that it acts linearly."""
    parameters = candidate.effect.parameters
    out = point.copy()
    # What is either there or not (geometric stiffening) has no size.
    if not parameters or candidate.effect.adds_coordinates:
        return out
    first = parameters[0]
    if first.search == "size":
        return out
    if first.search == "range":
        # Where it acts is to be scanned; how strongly, if that is another number, is what acts linearly.
        out[1:] *= factor
        return out
    if first.neutral == 0.0:
        for k, parameter in enumerate(parameters):
            if k == 0 or parameter.unit == first.unit or of_a_contact(first, parameter):
                out[k] *= factor
    elif np.isfinite(first.neutral):
        out[0] = first.neutral + (point[0] - first.neutral) * factor
    else:
        out[0] = point[0] / factor
    return out


def _resized(candidate: Candidate, point: Array, factor: float) -> Array:
    """A starting point of an effect with coordinates of its own, that acts ``factor`` times as much as this one.

    What gives is the inverse of a stiffness and of a frequency's square; damping keeps its ratio to the critical one.
    """
    out = point.copy()
    for k, parameter in enumerate(candidate.effect.parameters):
        if parameter.name == "gap":
            out[k] *= factor
        elif parameter.name == "stiffness":
            out[k] /= factor
        elif parameter.name in ("frequency", "damping"):
            out[k] /= np.sqrt(factor)
    return out


Near = tuple[list[Array], list[Array], list[float]]
"""Points near enough to absence to act linearly, the changes there per window (k, M), and how near they were brought."""


def near_changes(
    fitted: Fit,
    predictor: Predictor,
    likelihood: Likelihood,
    candidates: Sequence[Candidate],
    points: Sequence[Sequence[Array]],
    motions: dict[Window, Response],
) -> list[Near]:
    """Points of several candidates brought near to absence, and the changes there; all of them run together."""
    found: list[Near | None] = [None] * len(candidates)
    near: dict[int, list[Array]] = {}
    for k, (candidate, own) in enumerate(zip(candidates, points, strict=True)):
        if scanned(candidate) and responsive(predictor):
            factor = 1.0 if scans()[candidate.effect.name].linear else NEAREST_TO_ABSENCE
            places = [brought_near(candidate, p, factor) for p in own]
            changes = scan(fitted, predictor, likelihood, candidate, places, motions)
            found[k] = places, changes, [factor] * len(own)
            continue
        near[k] = [brought_near(candidate, p, FIRST_NEARER) for p in own]
    moved = {k for k, own in near.items() if not all(map(np.array_equal, own, points[k]))}
    running = list(near)
    for k, own_changes in zip(
        running,
        change(fitted, predictor, likelihood, [candidates[k] for k in running], [near[k] for k in running]),
        strict=True,
    ):
        found[k] = near[k], own_changes, [FIRST_NEARER if k in moved else 1.0] * len(near[k])
    extent = _extents(predictor, likelihood, fitted)
    for _ in range(2):
        wide: dict[int, list[int]] = {}
        for k in sorted(moved):
            starts, changes, factors = found[k] or ([], [], [])
            squares = sum(_by_channel(np.nan_to_num(c, nan=1e6), len(extent)) for c in changes)
            sizes = np.max(np.sqrt(squares) / extent, axis=1)
            sensor = candidates[k].effect.sensor
            small = LINEAR_MOTION_EXTENT if sensor is None or sensor.clock else LINEAR_EXTENT
            own_wide = [i for i in range(len(starts)) if sizes[i] > small and factors[i] > NEAREST_TO_ABSENCE]
            for i in own_wide:
                factors[i] = max(NEAREST_TO_ABSENCE, factors[i] * 0.5 * small / float(sizes[i]))
                starts[i] = brought_near(candidates[k], points[k][i], factors[i])
            if own_wide:
                wide[k] = own_wide
        moved = set(wide)
        again = change(
            fitted, predictor, likelihood,
            [candidates[k] for k in wide], [[near[k][i] for i in own] for k, own in wide.items()],
        )  # fmt: skip
        for (k, own_wide), renewed in zip(wide.items(), again, strict=True):
            known = found[k]
            assert known is not None
            for old, new in zip(known[1], renewed, strict=True):
                old[own_wide] = new
    return [item for item in found if item is not None]


def _by_channel(change: Array, channels: int) -> Array:
    """Squares of whitened changes (K, C·T), summed over each channel, (K, C)."""
    return np.asarray(np.sum(change.reshape(len(change), channels, -1) ** 2, axis=2))


def _extents(predictor: Predictor, likelihood: Likelihood, fitted: Fit) -> Array:
    """Norm of every channel's own variation over all windows, in standard deviations of noise, shape (C,)."""
    total = np.full(len(likelihood.colours), 1e-300)
    for window in fitted.windows:
        values = predictor.runs[window.run].values[:, window.first : window.last]
        for c, colour in enumerate(likelihood.colours):
            total[c] += float(np.nanvar(values[c])) * values.shape[1] / colour.std**2
    return np.sqrt(total)


def _along_rays(
    candidate: Candidate,
    lines: Sequence[Ray],
    space: Nuisance,
    near: Sequence[Array],
    changes: Sequence[Array],
    factors: Sequence[float],
) -> Iterator[Score]:
    """What each ray of a candidate promises, those that physics forbids or nothing shows of left out."""
    finite = np.ones(len(near), dtype=bool)
    for part in changes:
        finite &= np.all(np.isfinite(part), axis=1)
    if not finite.all():
        changes = [np.nan_to_num(part) for part in changes]
    seen = space.measure(changes)
    along, squares, neighbours = seen.along, seen.squares, seen.neighbours
    place = 0
    for line in lines:
        first = place
        index = slice(place, place + len(line))
        place += len(line)
        visible = float(np.sqrt(squares[index].max()))
        if not bool(np.all(finite[index])) or visible < WEAK_DIRECTION * min(factors[index]):
            continue
        if len(line) == 2:
            s0, s1, c = float(squares[first]), float(squares[first + 1]), float(neighbours[first])
            determinant = s0 * s1 - c * c
            if determinant < 1e-12 * s0 * s1 or determinant <= 0.0:
                continue
            r0, r1 = -float(along[first]), -float(along[first + 1])
            x, y = (s1 * r0 - c * r1) / determinant, (s0 * r1 - c * r0) / determinant
            gain = x * r0 + y * r1
            found = combined(candidate, near[first], near[first + 1], x, y)
            if found is None:
                continue
            start = found
        else:
            size = float(squares[first])
            a0 = -float(along[first]) / size
            if a0 <= 0.0 and not may_reverse(candidate):
                continue
            gain = a0 * a0 * size
            reach = GREATEST_START_RATIO / factors[first]
            start = near[first]
            if candidate.effect.adds_coordinates:
                start = _resized(candidate, near[first], float(np.clip(a0, 1.0 / RESIZED_RATIO, RESIZED_RATIO)))
            elif candidate.effect.parameters and np.isfinite(candidate.effect.parameters[0].neutral):
                # Not beyond what the linear view can vouch for.
                start = brought_near(candidate, near[first], float(np.clip(a0, -reach, reach)))
            elif factors[first] < 1.0:
                start = brought_near(candidate, near[first], float(np.clip(a0, 1e-2, reach)))
            start = np.clip(start, candidate.effect.lower, candidate.effect.upper)
        yield Score(candidate, gain, start, visible)


def combined(candidate: Candidate, first: Array, second: Array, a: float, b: float) -> Array | None:
    """The starting values that act as ``a`` times the first plus ``b`` times the second point; None if physics forbids them."""
    names = [p.name for p in candidate.effect.parameters]
    start = first.copy()
    if "phase" in names:
        quarter = names.index("phase")
        start[0] = first[0] * float(np.hypot(a, b))
        start[quarter] = float(np.arctan2(b, a))
    elif "rest_angle" in names:
        # Torques −k q and −k (q − r): the first is the spring alone, the second the spring with its rest moved.
        # A spring that would have to push stands for a torque: a soft one with its rest far away.
        stiffness = (a + b) * first[0]
        if stiffness <= candidate.effect.lower[0]:
            stiffness = SOFTEST_SPRING_RATIO * abs(b) * second[0]
        if stiffness <= candidate.effect.lower[0]:
            return None
        start = np.array([stiffness, b * second[0] * second[1] / stiffness])
    else:
        start = a * first + b * second
    return np.clip(start, candidate.effect.lower, candidate.effect.upper)


def may_reverse(candidate: Candidate) -> bool:
    """Whether the first parameter may lie on either side of its neutral value."""
    if not candidate.effect.parameters:
        return False
    p = candidate.effect.parameters[0]
    return bool(np.isfinite(p.neutral) and p.lower < p.neutral)
