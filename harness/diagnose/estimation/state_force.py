"""A force over the state at every joint, the same in every recording: the null that a law has to be likelier than.

What a model leaves out acts wherever the motion passes the same angle at the same speed, so recordings that pass there together
say the same thing once and not as often as they are. A likelihood that takes their errors for independent calls every curve that
bends to them significant. Here the force that a set of laws leaves out is a Gaussian process over each joint's position and
velocity (Kennedy and O'Hagan, J. R. Statist. Soc. B 63 (2001) 425: a discrepancy is a function of the inputs), known through what
channels answer to it, beside noise as loud as what is left. How likely recordings are with the force integrated out compares sets
of laws of any kind (Rasmussen and Williams, Gaussian Processes for Machine Learning (2006), ch. 5): a law that a smooth unknown
force could replace gains no more than its own shape deserves.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, cholesky, solve_triangular
from scipy.linalg.lapack import dtrtri
from scipy.optimize import minimize

from harness.diagnose.estimation.constants import (
    CONTINUED_STEPS,
    COVARIANCE_JITTER,
    FEWEST_NODES_A_SIDE,
    FIRST_ADDED,
    FORCE_LENGTH_SPREAD,
    LARGEST_ADDED,
    LARGEST_FORCE,
    LONGEST_FORCE_LENGTH,
    LOUDEST_VARIANCE,
    MOST_NODES_A_SIDE,
    MOST_STATE_NODES,
    NODE_RIDGE,
    SHORTEST_FORCE_LENGTH,
    SMALLEST_FORCE,
    TURNING_SPEED,
    USUAL_FORCE_LENGTH,
    USUAL_GAIN,
    USUAL_LEVEL,
    USUAL_STATE_FORCE,
)
from harness.diagnose.estimation.discrepancy import Profiled, Responses, hat_functions, responses
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.linear_response import Response
from harness.diagnose.prediction.predictor import Predictor, Push
from harness.diagnose.problem.windows import Window
from harness.effects.effect import cauchy_surprise

Array = NDArray[np.float64]

FRICTIONS = 2  # that recordings may have more or less of: dry and viscous


class Level(IntEnum):
    """What recordings may have more or less of than all together: friction [natural torque], of a recorded effort [its share]."""

    FRICTION = 1
    GAIN = 2


@dataclass(frozen=True, eq=False)
class Force:
    """Size and shape of a force over the state, and the noise beside it.

    sizes: standard deviations at every joint, in natural torques, and after these, of each kind of level if there are any; lengths:
    over which it changes in position and in velocity, in standard deviations of these; louder: variance beside it of every channel,
    in units of the sensors'.
    """

    sizes: Array
    lengths: Array
    louder: Array


@dataclass(frozen=True, eq=False)
class Sums:
    """What residuals say of the forces at the nodes and of a set's own numbers, channel by channel, initial states projected out.

    squares: ZᵀZ (C, k + P, k + P) with Z the answers to the forces and, less than nothing, to the numbers; products: Zᵀr; left:
    rᵀr; counts: readings. stiff: how stiffly the numbers are held where they stand; deviations: of the nominal ones, (P,).
    """

    squares: Array
    products: Array
    left: Array
    counts: Array
    stiff: Array
    deviations: Array

    @property
    def louder(self) -> Array:
        """Variance of what is left, in units of the sensors', (C,)."""
        return np.asarray(np.maximum(self.left / self.counts, 1.0))


@dataclass(frozen=True, eq=False)
class Numbers:
    """A set's own numbers: what the channels make of each, (M, P) by window; how stiffly each is held where it stands, and by how
    much those with a unit normal prior deviate from what is stated, (P,)."""

    shared: Sequence[Array]
    stiff: Array
    deviations: Array


@dataclass(frozen=True, eq=False)
class Likeliest:
    """The likeliest size and shape of a force: its surprise, the forces at the nodes (k,), what numbers move by (P,)."""

    value: float
    force: Force
    nodes: Array
    numbers: Array


Set = tuple[frozenset[str], tuple[Window, ...]]
"""A set of laws in some windows."""


@dataclass(eq=False)
class StateForce:
    """Forces at the nodes of grids over the joints' states, and what the whitened channels answer to them.

    joint: (k,) of every node, and where it stands, position and velocity (k, 2), in standard deviations of these. answers: (M, k)
    by window. level: of nodes that are no place of a grid, what it is that one recording has more or less of (``Level``), else 0,
    (k,).
    motions: that are answered along, in these coordinates, and the shares of the nodes there (k, G). names: of the joints; torque:
    natural force that nodes are in. together: samples of every channel that err together beside the force. shape: of the force
    that the reference leaves, where the search for that of others begins. known: what has been worked out beside the force, by set
    and windows; begun: from which sets' places these were
    begun, their own among them, with the squares that a set's own fit left there.
    """

    joint: NDArray[np.intp]
    at: Array
    answers: Mapping[Window, Array]
    channels: int
    together: Array
    shape: Force | None = None
    motions: Mapping[Window, Response] = field(default_factory=dict)
    shares: Mapping[Window, Array] = field(default_factory=dict)
    coordinates: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    torque: float = 1.0
    axes: Sequence[Sequence[Array]] = ()
    units: Array = field(default_factory=lambda: np.ones((0, 2)))
    known: dict[Set, Any] = field(default_factory=dict)
    begun: dict[tuple[Set, frozenset[str]], float] = field(default_factory=dict)
    level: NDArray[np.intp] | None = None

    @property
    def joints(self) -> int:
        return int(self.joint.max()) + 1 if len(self.joint) else 0

    @cached_property
    def over_grid(self) -> NDArray[np.bool_]:
        """Which nodes are places of the grids over the state, (k,)."""
        return np.ones(len(self.joint), dtype=bool) if self.level is None else self.level == 0

    @cached_property
    def group(self) -> NDArray[np.intp]:
        """Which of the sizes is that of every node, (k,)."""
        return self.joint if self.level is None else self.joint + self.joints * self.level

    @cached_property
    def usual(self) -> Array:
        """How large each of the sizes usually is."""
        kinds = 0 if self.level is None else int(self.level.max())
        return np.repeat((USUAL_STATE_FORCE, USUAL_LEVEL, USUAL_GAIN)[: 1 + kinds], self.joints)

    def prior_root(self, force: Force) -> Array:
        """L with L Lᵀ the prior covariance of the forces at the nodes, in natural torques."""
        return np.asarray(
            force.sizes[self.group, None] * cholesky(self._correlation(force), lower=True, check_finite=False)
        )

    @cached_property
    def _squared_apart(self) -> Array:
        """Squared distances between nodes, in position and in velocity, (2, k, k)."""
        return _squared_apart(self.at, self.at)

    @cached_property
    def _one_force(self) -> NDArray[np.bool_]:
        """Which nodes are places of one force over the state, (k, k)."""
        return (self.group[:, None] == self.group) & self.over_grid[:, None]

    def _correlation(self, force: Force) -> Array:
        correlation = _alike(self._squared_apart, force.lengths) * self._one_force
        correlation[np.diag_indices(len(correlation))] = 1.0 + COVARIANCE_JITTER
        return np.asarray(correlation)

    def pushes(self, nodes: Array) -> dict[Window, Push]:
        """Forces at the nodes (k,), in natural torques, as they act along every window."""
        out = {}
        for window, shares in self.shares.items():
            acting = self.torque * nodes[:, None] * shares
            forces = {name: acting[self.joint == number].sum(axis=0) for number, name in enumerate(self.names)}
            out[window] = Push(self.motions[window].time, forces)
        return out

    def table(self, number: int, nodes: Array, force: Force) -> tuple[Array, Array, Array]:
        """What acts at a joint over its state: positions (a,), velocities (b,) and the force there (a, b) [N·m or N].

        Where no motion passed, the prior's mean given the nodes (k,): it ends in nothing; a few steps beyond them as well.
        """
        own = (self.joint == number) & self.over_grid
        axes = [_further(axis) for axis in self.axes[number]]
        new = np.array([(p, v) for p in axes[0] for v in axes[1]]) / self.units[number]
        towards = _alike(_squared_apart(new, self.at[own]), force.lengths)
        inside = self._correlation(force)[np.ix_(own, own)]
        acting = self.torque * towards @ np.linalg.solve(inside, nodes[own])
        return axes[0], axes[1], acting.reshape(len(axes[0]), len(axes[1]))

    def over(self, forces: Mapping[Window, Array]) -> Array:
        """The forces at the nodes (k,) nearest to those in every step of the motions, (G − 1, joints), NaN where unknown."""
        out = np.zeros(len(self.joint))
        for number in range(self.joints):
            own = (self.joint == number) & self.over_grid
            shares = [self.shares[w][own] for w in forces]
            columns = np.hstack([0.5 * (s[:, 1:] + s[:, :-1]) for s in shares])
            values = np.concatenate([f[:, number] for f in forces.values()]) / self.torque
            known = np.isfinite(values)
            columns, values = columns[:, known], values[known]
            square = columns @ columns.T
            square[np.diag_indices(len(square))] += NODE_RIDGE * np.trace(square) / len(square)
            out[own] = np.linalg.solve(square, columns @ values)
        return out

    def along(self, predictor: Predictor, likelihood: Likelihood, fitted: Fit) -> StateForce:
        """The same forces as another motion answers to them: that of a fit, what pushes it included."""
        found = responses(predictor, likelihood, fitted, self.torque, 0.0)
        if found is None:
            return self
        answers = {}
        for window in fitted.windows:
            motion, shares = found.motion(window), self.shares.get(window)
            if motion is None or shares is None:
                continue
            own = [found.moved(motion, place, shares[self.joint == k]) for k, place in enumerate(found.places)]
            answers[window] = np.nan_to_num(np.hstack(own))
        return replace(self, answers={**self.answers, **answers}, known={}, begun={})

    def with_levels(self, predictor: Predictor, likelihood: Likelihood, fitted: Fit) -> StateForce | None:
        """The same with what every recording has by itself, as the motion of a fit answers to it: dry and viscous friction, and a
        gain of each effort that was recorded.

        None where there is one recording, or channels do not answer linearly.
        """
        runs = list(dict.fromkeys(w.run for w in fitted.windows))
        found = responses(predictor, likelihood, fitted, self.torque, 0.0)
        if found is None or len(runs) < 2:
            return None
        motions = {window: found.motion(window) for window in fitted.windows}
        efforts = {w: _efforts(predictor, fitted, w, m) / self.torque for w, m in motions.items() if m is not None}
        answers, joint, level = dict(self.answers), [self.joint], [np.zeros(len(self.joint), dtype=np.intp)]
        for number, place in enumerate(found.places):
            kinds = [Level.FRICTION] * (FRICTIONS * len(runs))
            if any(np.any(own[place]) for own in efforts.values()):
                kinds += [Level.GAIN] * len(runs)
            joint.append(np.full(len(kinds), number))
            level.append(np.array(kinds, dtype=np.intp))
            for window, motion in motions.items():
                columns = np.zeros((self.channels * window.size, len(kinds)))
                if motion is not None:
                    acting = _frictions(motion.qd[:, place] / self.units[number, 1])
                    if Level.GAIN in kinds:
                        acting = np.vstack([acting, efforts[window][place]])
                    columns[:, runs.index(window.run) :: len(runs)] = np.nan_to_num(found.moved(motion, place, acting))
                answers[window] = np.hstack([answers[window], columns])
        of_all = np.concatenate(joint)
        apart = np.zeros((len(of_all) - len(self.joint), 2))
        return replace(
            self, answers=answers, known={}, begun={}, at=np.vstack([self.at, apart]), joint=of_all,
            level=np.concatenate(level),
        )  # fmt: skip

    def sums(
        self,
        windows: Sequence[Window],
        free: Sequence[Profiled],
        nodes: Array | None = None,
        numbers: Numbers | None = None,
    ) -> Sums:
        """What the residuals of windows say, initial states projected out. nodes: forces that are pushed already; numbers: of the
        set, where they move too."""
        size = 0 if numbers is None else len(numbers.stiff)
        k, count = len(self.joint) + size, self.channels
        squares, products = np.zeros((count, k, k)), np.zeros((count, k))
        left, counts = np.zeros(count), np.zeros(count)
        for number, (window, own) in enumerate(zip(windows, free, strict=True)):
            answers = self.answers[window]
            both = answers if numbers is None else np.hstack([answers, -numbers.shared[number]])
            seen = both - own.states @ (own.states.T @ both)
            residual = own.residual if nodes is None else own.residual + seen[:, : len(nodes)] @ nodes
            for c in range(count):
                rows = slice(c * window.size, (c + 1) * window.size)
                z, r = seen[rows], residual[rows]
                squares[c] += z.T @ z
                products[c] += z.T @ r
                left[c] += float(r @ r)
                counts[c] += np.count_nonzero(own.residual[rows])
            counts -= own.states.shape[1] / count
        stiff, deviations = (np.ones(0), np.zeros(0)) if numbers is None else (numbers.stiff, numbers.deviations)
        return Sums(squares, products, left, np.maximum(counts, 1.0), stiff, deviations)

    def surprise(self, sums: Sums, force: Force) -> float:
        """−2 log of how likely residuals are with the force integrated out, up to a constant of the recordings, and of how usual
        its size is; the set's own numbers at their likeliest."""
        return self._at(sums, force)[0].value

    def held(self, sums: Sums, nodes: Array, force: Force) -> float:
        """The same where these forces at the nodes are the likeliest, and residuals are what a run with them leaves."""
        weights = 1.0 / (force.louder * self.together)
        root = self.prior_root(force)
        k = len(root)
        inside = root.T @ np.einsum("c,cij->ij", weights, sums.squares[:, :k, :k]) @ root
        inside[np.diag_indices(k)] += 1.0
        scaled = solve_triangular(root, nodes, lower=True, check_finite=False)
        value = self._noise(sums, force, float(weights @ sums.left)) + float(scaled @ scaled)
        return value + float(np.sum(sums.deviations**2)) + float(np.linalg.slogdet(inside)[1])

    def without(self, sums: Sums) -> float:
        """The same with no force at all."""
        none = Force(np.full(len(self.usual), SMALLEST_FORCE), np.full(2, USUAL_FORCE_LENGTH), sums.louder)
        return self._noise(sums, none, float(np.sum(sums.left / sums.louder / self.together))) + float(
            np.sum(sums.deviations**2)
        )

    def spread(self, sums: Sums, force: Force | None) -> Array:
        """Standard deviations of a set's numbers (P,) where these residuals are left, the force at the nodes free as well."""
        root = np.zeros((len(self.joint), 0)) if force is None else self.prior_root(force)
        inside = self._information(sums, root, sums.louder if force is None else force.louder)
        half = solve_triangular(_root(inside), np.eye(len(inside)), lower=True, check_finite=False)
        return np.sqrt(np.sum(half**2, axis=0))[root.shape[1] :]

    def _information(self, sums: Sums, root: Array, louder: Array) -> Array:
        """How well readings and priors know forces, in units of their prior's root (k, K), and numbers, (K + P, K + P)."""
        k, count = root.shape
        known = np.tensordot(1.0 / (louder * self.together), sums.squares, 1)
        inside = np.empty((count + len(sums.stiff),) * 2)
        inside[:count, :count] = root.T @ known[:k, :k] @ root
        inside[:count, count:] = root.T @ known[:k, k:]
        inside[count:, :count] = inside[:count, count:].T
        inside[count:, count:] = known[k:, k:]
        # A weak prior keeps numbers that nothing tells where they are.
        inside[np.diag_indices(len(inside))] += np.concatenate([np.ones(count), sums.stiff])
        return inside

    def _noise(self, sums: Sums, force: Force, left: float) -> float:
        usual = float(np.sum(cauchy_surprise(force.sizes / self.usual))) + _smooth_surprise(force.lengths)
        return usual + float(np.sum(sums.counts / self.together * np.log(force.louder))) + float(left)

    def _at(self, sums: Sums, force: Force) -> tuple[Likeliest, Array]:
        """What one size and shape say, and the slope of its surprise in the logarithms of sizes, loudness and lengths."""
        weights = 1.0 / (force.louder * self.together)
        root = self.prior_root(force)
        k = len(root)
        inside = self._information(sums, root, force.louder)
        seen = weights @ sums.products
        seen[:k] = root.T @ seen[:k]
        seen[k:] -= sums.deviations
        lower = _root(inside)
        found = cho_solve((lower, True), seen, check_finite=False)
        value = self._noise(sums, force, float(weights @ sums.left)) + float(np.sum(sums.deviations**2))
        value += 2.0 * float(np.sum(np.log(np.diag(lower)[:k]))) - float(seen @ found)
        both = np.concatenate([root @ found[:k], found[k:]])
        # Of the quadratic part by the envelope theorem; of ln |I + C M| by Jacobi's formula.
        left = sums.left - 2.0 * sums.products @ both + (sums.squares @ both) @ both
        inverse, back = _inverse(lower[:k, :k]), _inverse(root)
        half = inverse @ root.T
        after = half.T @ half
        slope_louder = sums.counts / self.together - weights * left
        slope_louder -= weights * np.array([np.vdot(own[:k, :k], after) for own in sums.squares])
        pull = back.T @ found[:k]
        gain = back.T @ (np.eye(k) - inverse.T @ inverse) @ back
        change = (gain - np.outer(pull, pull)) * (root @ root.T)
        rows = change.sum(axis=1)
        usual = force.sizes / self.usual
        sizes = 2.0 * np.bincount(self.group, rows, len(usual)) + 4.0 * usual**2 / (1.0 + usual**2)
        lengths = np.tensordot(self._squared_apart, change, 2) / force.lengths**2
        lengths += 2.0 * np.log(force.lengths / USUAL_FORCE_LENGTH) / FORCE_LENGTH_SPREAD**2
        return Likeliest(value, force, both[:k], both[k:]), np.concatenate([sizes, slope_louder, lengths])

    def likeliest(
        self, sums: Sums, near: Force | None = None, *, levels: Collection[Level] = tuple(Level)
    ) -> Likeliest:
        """The least surprise over size, shape and loudness. near: where to begin, if something is known. levels: what recordings
        may have of their own."""
        joints, count = len(self.usual), self.channels
        loud = sums.louder

        def force(z: Array) -> Force:
            return Force(np.exp(z[:joints]), np.exp(z[joints + count :]), np.exp(z[joints : joints + count]))

        def loss(z: Array) -> tuple[float, Array]:
            found, slope = self._at(sums, force(z))
            return found.value, slope

        free = np.isin(np.arange(joints) // max(self.joints, 1), [0, *levels])
        largest = np.where(free, LARGEST_FORCE, SMALLEST_FORCE)
        bounds = [(np.log(SMALLEST_FORCE), high) for high in np.log(largest)] + [
            (0.0, np.log(LOUDEST_VARIANCE))
        ] * count
        bounds += [(np.log(SHORTEST_FORCE_LENGTH), np.log(LONGEST_FORCE_LENGTH))] * 2
        usual = np.concatenate([np.log(2.0 * self.usual), np.log(0.5 * loud + 0.5)])
        starts = [np.concatenate([usual, np.log((0.4, 0.4))])]
        near = near or self.shape
        if near is None:
            starts.append(np.concatenate([usual, np.zeros(2)]))
        else:
            louder = np.minimum(near.louder, loud)
            starts.append(np.log(np.concatenate([near.sizes, louder, near.lengths])))
        best: tuple[float, Array] | None = None
        for start in starts:
            ended = minimize(
                loss, np.clip(start, *np.array(bounds).T), jac=True,
                method="L-BFGS-B", bounds=bounds, options={"maxiter": 40, "ftol": 1e-7},
            )  # fmt: skip
            if best is None or ended.fun < best[0]:
                best = float(ended.fun), np.asarray(ended.x)
        assert best is not None
        return self._at(sums, force(best[1]))[0]


def over_the_state(found: Responses) -> StateForce | None:
    """The forces over the state along the motion of ``found``; None without motion."""
    windows, places = found.probe.fitted.windows, found.places
    motions = {w: found.motion(w) for w in windows}
    moving = {w: m for w, m in motions.items() if m is not None}
    if not moving or not places:
        return None
    a_side = int(np.clip(np.sqrt(MOST_STATE_NODES / len(places)), FEWEST_NODES_A_SIDE, MOST_NODES_A_SIDE))
    channels = len(found.probe.predictor.problem.channels)
    joint: list[int] = []
    at: list[Array] = []
    grids: list[list[Array]] = []
    units: list[list[float]] = []
    pieces: dict[Window, list[Array]] = {w: [] for w in windows}
    shares: dict[Window, list[Array]] = {w: [] for w in moving}
    for number, place in enumerate(places):
        position = np.concatenate([m.q[:, place] for m in moving.values()])
        velocity = np.concatenate([m.qd[:, place] for m in moving.values()])
        axes = [_axis(own, a_side) for own in (position, velocity)]
        spread = [max(float(np.std(own)), 1e-12) for own in (position, velocity)]
        grids.append(axes)
        units.append(spread)
        hats = {w: _hats(axes, m.q[:, place], m.qd[:, place]) for w, m in moving.items()}
        visited = np.any([h.max(axis=1) > 0.0 for h in hats.values()], axis=0)
        grid = np.array([(p / spread[0], v / spread[1]) for p in axes[0] for v in axes[1]])
        joint += [number] * int(visited.sum())
        at.append(grid[visited])
        for w in windows:
            if w not in moving:
                pieces[w].append(np.zeros((channels * w.size, int(visited.sum()))))
                continue
            shares[w].append(hats[w][visited])
            pieces[w].append(np.nan_to_num(found.moved(moving[w], place, hats[w][visited])))
    answers = {w: np.hstack(own) for w, own in pieces.items()}
    return StateForce(
        np.array(joint, dtype=np.intp), np.vstack(at), answers, channels, np.ones(channels),
        motions=moving, shares={w: np.vstack(own) for w, own in shares.items()},
        coordinates=tuple(found.probe.predictor.mechanism(found.probe.fitted.hypothesis).names), names=found.joints,
        torque=found.torque, axes=grids, units=np.array(units),
    )  # fmt: skip


def _frictions(velocity: Array) -> Array:
    """Dry and viscous friction along a motion, (FRICTIONS, G). velocity: in standard deviations."""
    return np.array([np.tanh(velocity / TURNING_SPEED), velocity])


def _efforts(predictor: Predictor, fitted: Fit, window: Window, motion: Response) -> Array:
    """Recorded efforts as they act along a window [N·m or N], by coordinate (n, G)."""
    mechanism, lanes = predictor.mechanism(fitted.hypothesis), [(0, window, fitted.states[window])]
    tau = predictor.pushed({}).acting(fitted.hypothesis, fitted.x[None], mechanism, lanes, motion.time)
    return np.zeros((len(mechanism.names), len(motion.time))) if tau is None else tau[0].T


def _root(matrix: Array) -> Array:
    """L with L Lᵀ a matrix whose small directions rounding may have made negative: as much is added as that takes."""
    added, largest = 0.0, float(np.max(np.diag(matrix)))
    while True:
        try:
            return np.asarray(cholesky(matrix + added * largest * np.eye(len(matrix)), lower=True, check_finite=False))
        except np.linalg.LinAlgError:
            if added > LARGEST_ADDED:
                raise
            added = max(10.0 * added, FIRST_ADDED)


def _axis(values: Array, count: int) -> Array:
    low, high = float(np.min(values)), float(np.max(values))
    wide = max(high - low, 1e-9)
    return np.linspace(low - 1e-6 * wide, high + 1e-6 * wide, count)


def _inverse(lower: Array) -> Array:
    """The inverse of a lower triangle."""
    inverse, singular = dtrtri(lower, lower=1)
    if singular:
        raise np.linalg.LinAlgError(f"row {singular} of a triangle is nothing")
    return np.asarray(inverse)


def _squared_apart(these: Array, those: Array) -> Array:
    """Squared distances between states (j, 2) and (k, 2), in position and in velocity, (2, j, k)."""
    return np.asarray((these.T[:, :, None] - those.T[:, None]) ** 2)


def _alike(squared_apart: Array, lengths: Array) -> Array:
    """How alike a smooth force is at states so far apart: a squared exponential."""
    return np.asarray(np.exp(-0.5 * np.tensordot(1.0 / lengths**2, squared_apart, 1)))


def _smooth_surprise(lengths: Array) -> float:
    """−2 log of how usual the lengths are over which a force changes, less its least value (log-normal).

    A force that is nearly straight over all states that were visited is a constant, a spring or damping: laws that have a name.
    """
    return float(np.sum((np.log(lengths / USUAL_FORCE_LENGTH) / FORCE_LENGTH_SPREAD) ** 2))


def _further(axis: Array) -> Array:
    """An axis that goes on for a few steps at both ends."""
    step = axis[1] - axis[0]
    beyond = step * np.arange(1, CONTINUED_STEPS + 1)
    return np.concatenate([axis[0] - beyond[::-1], axis, axis[-1] + beyond])


def _hats(axes: Sequence[Array], position: Array, velocity: Array) -> Array:
    """Bilinear hat functions of the nodes (k, G) along a motion."""
    along, across = hat_functions(axes[0], position), hat_functions(axes[1], velocity)
    return np.asarray((along[:, None] * across[None]).reshape(-1, len(position)))
