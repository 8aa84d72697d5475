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

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, cholesky
from scipy.optimize import minimize

from harness.diagnose.estimation.discrepancy import LARGEST, LOUDEST, SMALLEST, Profiled, Responses, hat_functions
from harness.diagnose.estimation.effective_samples import hanging_together
from harness.diagnose.problem.windows import Window
from harness.effects.effect import cauchy_surprise

Array = NDArray[np.float64]

MOST_NODES = 240  # of the grids over the state, all joints together: bounds the work
FEWEST_A_SIDE, MOST_A_SIDE = 5, 11
SHORTEST, LONGEST = 0.15, 5.0  # over which the force changes, in standard deviations of position and velocity
USUAL = 0.01  # of the natural torque: what a model that is right leaves of the forces that it has; the scale of a Cauchy prior
JITTER = 1e-6  # of the variance, so that covariances of long lengths can be factorised


@dataclass(frozen=True, eq=False)
class Force:
    """Size and shape of a force over the state, and the noise beside it.

    sizes: standard deviations at every joint, in natural torques; lengths: over which it changes in position and in velocity, in
    standard deviations of these; louder: variance beside it of every channel, in units of the sensors'.
    """

    sizes: Array
    lengths: Array
    louder: Array


@dataclass(frozen=True, eq=False)
class Sums:
    """What residuals say of the forces at the nodes, channel by channel: squares ZᵀZ, products Zᵀr, rᵀr, and how many count."""

    squares: Array
    products: Array
    left: Array
    counts: Array


@dataclass(eq=False)
class StateForce:
    """Forces at the nodes of grids over the joints' states, and what the whitened channels answer to them.

    places: joint (k,) and position and velocity (k, 2) of every node, in standard deviations. answers: (M, k) by window.
    together: samples of every channel that err together beside the force. shape: of the force that the reference leaves, where
    the search for that of others begins.
    """

    joint: NDArray[np.intp]
    at: Array
    answers: Mapping[Window, Array]
    channels: int
    together: Array
    shape: Force | None = None

    @property
    def joints(self) -> int:
        return int(self.joint.max()) + 1 if len(self.joint) else 0

    def prior_root(self, force: Force) -> Array:
        """L with L Lᵀ the prior covariance of the forces at the nodes, in natural torques."""
        away = np.sum(((self.at[:, None] - self.at[None]) / force.lengths) ** 2, axis=2)
        same = self.joint[:, None] == self.joint
        covariance = np.exp(-0.5 * away) * same
        covariance[np.diag_indices(len(covariance))] += JITTER
        return np.asarray(force.sizes[self.joint, None] * cholesky(covariance, lower=True, check_finite=False))

    def sums(self, windows: Sequence[Window], free: Sequence[Profiled]) -> Sums:
        """What the residuals of windows say, initial states projected out."""
        k, count = len(self.joint), self.channels
        squares, products = np.zeros((count, k, k)), np.zeros((count, k))
        left, counts = np.zeros(count), np.zeros(count)
        for window, own in zip(windows, free, strict=True):
            answers = self.answers[window]
            seen = answers - own.states @ (own.states.T @ answers)
            for c in range(count):
                rows = slice(c * window.size, (c + 1) * window.size)
                z, r = seen[rows], own.residual[rows]
                squares[c] += z.T @ z
                products[c] += z.T @ r
                left[c] += float(r @ r)
                counts[c] += np.count_nonzero(r)
            counts -= own.states.shape[1] / count
        return Sums(squares, products, left, np.maximum(counts, 1.0))

    def surprise(self, sums: Sums, force: Force) -> float:
        """−2 log of how likely residuals are with the force integrated out, up to a constant of the recordings, and of how usual
        its size is."""
        weights = 1.0 / (force.louder * self.together)
        own = float(np.sum(cauchy_surprise(force.sizes / USUAL)))
        own += float(np.sum(sums.counts / self.together * np.log(force.louder)) + np.sum(weights * sums.left))
        root = self.prior_root(force)
        inside, seen = self._seen(sums, weights, root)
        factor = cho_factor(inside, lower=True, check_finite=False)
        explained = float(seen @ cho_solve(factor, seen, check_finite=False))
        return own - explained + 2.0 * float(np.sum(np.log(np.diag(factor[0]))))

    def _seen(self, sums: Sums, weights: Array, root: Array) -> tuple[Array, Array]:
        inside = root.T @ np.einsum("c,cij->ij", weights, sums.squares) @ root
        inside[np.diag_indices(len(inside))] += 1.0
        return inside, root.T @ (weights @ sums.products)

    def likeliest(self, sums: Sums) -> tuple[float, Force]:
        """The least surprise over size, shape and loudness, and the force that has it."""
        joints, count = self.joints, self.channels
        loud = np.maximum(sums.left / sums.counts, 1.0)

        def force(z: Array) -> Force:
            return Force(np.exp(z[:joints]), np.exp(z[joints + count :]), np.exp(z[joints : joints + count]))

        bounds = [(np.log(SMALLEST), np.log(LARGEST))] * joints + [(0.0, np.log(LOUDEST))] * count
        bounds += [(np.log(SHORTEST), np.log(LONGEST))] * 2
        usual = np.concatenate([np.full(joints, np.log(2.0 * USUAL)), np.log(0.5 * loud + 0.5)])
        starts = [np.concatenate([usual, np.log((0.4, 0.4))])]
        if self.shape is None:
            starts.append(np.concatenate([usual, np.zeros(2)]))
        else:
            louder = np.minimum(self.shape.louder, loud)
            starts.append(np.log(np.concatenate([self.shape.sizes, louder, self.shape.lengths])))
        best: tuple[float, Force] | None = None
        for start in starts:
            ended = minimize(
                lambda z: self.surprise(sums, force(z)), np.clip(start, *np.array(bounds).T),
                method="L-BFGS-B", bounds=bounds, options={"maxiter": 30, "ftol": 1e-7},
            )  # fmt: skip
            if best is None or ended.fun < best[0]:
                best = float(ended.fun), force(ended.x)
        assert best is not None
        return best

    def errors(self, windows: Sequence[Window], free: Sequence[Profiled], sums: Sums, force: Force) -> list[Array]:
        """Residuals (M,) of windows less what the likeliest force makes of them."""
        root, weights = self.prior_root(force), 1.0 / (force.louder * self.together)
        inside, seen = self._seen(sums, weights, root)
        forces = root @ np.linalg.solve(inside, seen)
        out = []
        for window, own in zip(windows, free, strict=True):
            answers = self.answers[window]
            out.append(own.residual - (answers - own.states @ (own.states.T @ answers)) @ forces)
        return out


def over_the_state(found: Responses, windows: Sequence[Window], free: Sequence[Profiled]) -> StateForce | None:
    """The forces over the state along the fit of ``found``, with their shape as a reference leaves it; None without motion.

    windows, free: of the reference, the plainest explanation at hand: a test is calibrated by what it holds to be true.
    """
    places = found.places
    motions = {w: found.motion(w) for w in windows}
    moving = {w: m for w, m in motions.items() if m is not None}
    if not moving or not places:
        return None
    a_side = int(np.clip(np.sqrt(MOST_NODES / len(places)), FEWEST_A_SIDE, MOST_A_SIDE))
    channels = len(found.probe.predictor.problem.channels)
    joint: list[int] = []
    at: list[Array] = []
    pieces: dict[Window, list[Array]] = {w: [] for w in windows}
    for number, place in enumerate(places):
        position = np.concatenate([m.q[:, place] for m in moving.values()])
        velocity = np.concatenate([m.qd[:, place] for m in moving.values()])
        axes = [_axis(own, a_side) for own in (position, velocity)]
        spread = [max(float(np.std(own)), 1e-12) for own in (position, velocity)]
        hats = {w: _hats(axes, m.q[:, place], m.qd[:, place]) for w, m in moving.items()}
        visited = np.any([h.max(axis=1) > 0.0 for h in hats.values()], axis=0)
        grid = np.array([(p / spread[0], v / spread[1]) for p in axes[0] for v in axes[1]])
        joint += [number] * int(visited.sum())
        at.append(grid[visited])
        for w in windows:
            if w not in moving:
                pieces[w].append(np.zeros((channels * w.size, int(visited.sum()))))
                continue
            pieces[w].append(np.nan_to_num(found.moved(moving[w], place, hats[w][visited])))
    answers = {w: np.hstack(own) for w, own in pieces.items()}
    force = StateForce(np.array(joint, dtype=np.intp), np.vstack(at), answers, channels, np.ones(channels))
    sums = force.sums(windows, free)
    _, first = force.likeliest(sums)
    errors = [e.reshape(channels, -1) for e in force.errors(windows, free, sums, first)]
    force.together = np.maximum(hanging_together(errors), 1.0)
    _, force.shape = force.likeliest(sums)
    return force


def _axis(values: Array, count: int) -> Array:
    low, high = float(np.min(values)), float(np.max(values))
    wide = max(high - low, 1e-9)
    return np.linspace(low - 1e-6 * wide, high + 1e-6 * wide, count)


def _hats(axes: Sequence[Array], position: Array, velocity: Array) -> Array:
    """Bilinear hat functions of the nodes (k, G) along a motion."""
    along, across = hat_functions(axes[0], position), hat_functions(axes[1], velocity)
    return np.asarray((along[:, None] * across[None]).reshape(-1, len(position)))
