"""An unknown force at every joint in the likelihood: what a model's own error does to predictions, beside the sensors' noise.

Where a model is wrong by more than its sensors are, a likelihood of sensor noise alone calls every further law significant and
every interval narrow. Here the force that a hypothesis leaves out at a joint is a stochastic process with a size and a memory
(Kennedy and O'Hagan, J. R. Statist. Soc. B 63 (2001) 425): stationary, exponentially correlated in time. Channels answer to it
linearly along the motion of a fit, so that its covariance is known without a further run, and whitening a residual means to
count less in a few directions. Size and memory are estimated by restricted maximum likelihood (Patterson and Thompson,
Biometrika 58 (1971) 545), the initial states projected out.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, qr, solve_triangular
from scipy.optimize import minimize
from scipy.stats import chi2

from harness.diagnose.estimation.constants import (
    FLEETING_RATIO,
    LARGEST_FORCE,
    LEFT_FORCE_CHANCE,
    LONGEST_FORCE_MEMORY,
    LOUDEST_VARIANCE,
    MOST_FORCE_KNOTS,
    MOST_KNOTS_A_SWING,
    SMALLEST_FORCE,
)
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.linear_response import Response, channels_moved, respond, responsive
from harness.diagnose.estimation.linearisation import Linearisation
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.windows import Window, contains

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Forced:
    """How a window's whitened channels answer to forces at the joints: Q (M, K) orthonormal, R (K, n·k), times of the k knots."""

    q: Array
    r: Array
    knots: Array


@dataclass(frozen=True, eq=False)
class Discrepancy:
    """Size and memory of the force that a model leaves out, and what they make of a whitened residual.

    joints: where it acts; sizes: standard deviations [N·m or N]; memory: correlation time [s]; gain: twice the log-likelihood over
    none; louder: variance of what is left beside it, in units of the sensors' noise (errors of the model too fast for a force over
    the knots); scale: natural force that the responses are in, seen through that noise [N·m]; shortest: memory that could be told
    from none [s].
    """

    joints: tuple[str, ...]
    sizes: tuple[float, ...]
    memory: float
    gain: float
    louder: float
    scale: float
    responses: Responses
    shortest: float = 0.0

    @property
    def fleeting(self) -> bool:
        """Whether the memory is no longer than could be told: the force may change faster, or be noise of a sensor that does."""
        return self.memory <= FLEETING_RATIO * self.shortest


@dataclass(eq=False)
class Responses:
    """Answers of the whitened channels to forces along the motion of one fit, in its windows and in pieces of them."""

    probe: Whitening
    found: Mapping[Window, Response]
    torque: float
    period: float
    _known: dict[Window, Forced] = field(default_factory=dict)

    @property
    def joints(self) -> tuple[str, ...]:
        """Where forces may act: at the joints, not at the coordinates of what gives or bends."""
        names = self.probe.predictor.mechanism(self.probe.fitted.hypothesis).names
        return tuple(name for name in names if name in self.probe.predictor.problem.system.joint_names)

    @property
    def places(self) -> list[int]:
        """Where the joints stand among the coordinates of the motions."""
        names = self.probe.predictor.mechanism(self.probe.fitted.hypothesis).names
        return [names.index(joint) for joint in self.joints]

    def moved(self, motion: Response, place: int, histories: Array) -> Array:
        """What the whitened channels make of force histories (k, G), in natural torques, at a coordinate: (M, k)."""
        return channels_moved(
            self.probe.predictor, self.probe.likelihood, self.probe.fitted, motion,
            partial(motion.by_force, place), len(histories), lambda own: self.torque * histories[own],
        ).T  # fmt: skip

    def of(self, window: Window) -> Forced:
        """The answer in a window or in a piece of one; nothing where the fit has no motion."""
        if window not in self._known:
            self._known[window] = self._made(window)
        return self._known[window]

    def _made(self, window: Window) -> Forced:
        motion = self.motion(window)
        channels = len(self.probe.predictor.problem.channels)
        if motion is None:
            return Forced(np.zeros((channels * window.size, 0)), np.zeros((0, 0)), np.zeros(0))
        places = self.places
        span = float(motion.time[-1])
        count = int(
            np.clip(np.ceil(span * MOST_KNOTS_A_SWING / self.period), 2, max(MOST_FORCE_KNOTS // len(places), 2))
        )
        knots = np.linspace(0.0, span, count + 1)
        hats = hat_functions(knots, motion.time)
        columns = [self.moved(motion, place, hats) for place in places]
        q, r = qr(np.nan_to_num(np.hstack(columns)), mode="economic", check_finite=False)
        return Forced(q, r, knots)

    def motion(self, window: Window) -> Response | None:
        """The motion of the fit in a window or in a piece of one, None where it has none."""
        if window in self.found:
            return self.found[window]
        whole = next((w for w in self.found if contains(w, window)), None)
        if whole is None:
            return None
        run = self.probe.predictor.problem.runs[window.run]
        motion, predictor = self.found[whole], self.probe.predictor
        size = len(predictor.grid(window, predictor.margin(self.probe.fitted.hypothesis)).own)
        since = run.time[window.first] - run.time[whole.first]
        first = max(min(int(np.searchsorted(motion.time, since + 1e-9)) - 1, len(motion.time) - size), 0)
        return motion.within(window, slice(first, first + size), float(motion.time[first]))


@dataclass(frozen=True, eq=False)
class Whitening:
    """The fit that forces act along, and the sensors' noise alone that whitens what they do."""

    predictor: Predictor
    likelihood: Likelihood
    fitted: Fit


def responses(
    predictor: Predictor, likelihood: Likelihood, fitted: Fit, torque: float, period: float
) -> Responses | None:
    """Answers to forces along a fit; None where channels do not answer linearly. torque: natural size [N·m]; period [s]."""
    if not responsive(predictor):
        return None
    motions = {window: respond(predictor, fitted, window, torque) for window in fitted.windows}
    return Responses(Whitening(predictor, likelihood.of_sensors, fitted), motions, torque, period)


def hat_functions(knots: Array, values: Array) -> Array:
    """Piecewise linear functions (k, G), one at each of k evenly spaced knots and none at the others."""
    return np.asarray(np.maximum(1.0 - np.abs(values - knots[:, None]) / (knots[1] - knots[0]), 0.0))


def covariance_at(knots: Array, sizes: Array, memory: float) -> Array:
    """Covariance (n·k, n·k) of the forces at the knots, in natural units, joint after joint."""
    one = np.exp(-np.abs(knots[:, None] - knots) / max(memory, 1e-12))
    return np.asarray(np.kron(np.diag(sizes**2), one))


@dataclass(frozen=True, eq=False)
class Piece:
    """A window's residual seen by the forces, initial states projected out: Qᵀr, R, knots [s]; cost and number of the rest."""

    along: Array
    r: Array
    knots: Array
    outside: float
    count: int


@dataclass(frozen=True, eq=False)
class Profiled:
    """A window's residual (M,) less what other initial states would make of it, what those make (M, S) orthonormal, and how many
    samples count."""

    residual: Array
    states: Array
    samples: int


def orthonormal(states: Array) -> Array:
    """An orthonormal basis (M, S) of what initial states change, given what each of them does (M, S)."""
    return np.linalg.qr(states)[0] if states.shape[1] else np.zeros((len(states), 0))


def profiled(here: Linearisation) -> list[Profiled]:
    """A linear view with the initial states of every window profiled out."""
    out = []
    for residual, basis in zip(here.residuals, here.bases, strict=True):
        states = orthonormal(basis)
        left = residual - states @ (states.T @ residual)
        out.append(Profiled(left, states, int(np.count_nonzero(residual))))
    return out


def pieces_of(found: Responses, windows: Sequence[Window], free: Sequence[Profiled]) -> list[Piece]:
    """Of every window that has a motion, what is left seen by the forces; free: the fit in its windows, states profiled out."""
    out = []
    for window, own in zip(windows, free, strict=True):
        forced = found.of(window)
        if not forced.q.shape[1]:
            continue
        seen = own.states.T @ forced.q
        # H = Q R less its part along the initial states, factorised again in the small space.
        small = np.eye(len(seen.T)) - seen.T @ seen
        values, vectors = np.linalg.eigh(small)
        kept = values > 1e-10
        root = np.sqrt(values[kept])
        along = (vectors[:, kept].T @ (forced.q.T @ own.residual)) / root
        count = max(own.samples - own.states.shape[1] - len(along), 0)
        outside = max(float(own.residual @ own.residual) - float(along @ along), 0.0)
        out.append(Piece(along, (root[:, None] * vectors[:, kept].T) @ forced.r, forced.knots, outside, count))
    return out


def _gain(pieces: Sequence[Piece], sizes: Array, memory: float, louder: float) -> tuple[float, Array]:
    """Twice the restricted log-likelihood with such a force and so much louder noise over that of neither.

    With its slope in the logarithms of the sizes, the memory and the louder noise.
    """
    n = len(sizes)
    total, slope = 0.0, np.zeros(n + 2)
    for piece in pieces:
        along, r, count = piece.along, piece.r, len(piece.along)
        covariance = covariance_at(piece.knots, sizes, memory)
        whole = np.eye(count) + (r @ covariance @ r.T) / louder
        root, determinant = _inverse_root(whole)
        inside = root @ along
        inverse, b = root.T @ root, root.T @ inside
        total += float(along @ along) + piece.outside - (float(inside @ inside) + piece.outside) / louder
        total -= determinant + (piece.count + count) * float(np.log(louder))
        # d gain = [(Rᵀb)ᵀ dC (Rᵀb) / λ − tr(Rᵀ M⁻¹ R dC)] / λ for a change dC of the forces' covariance.
        seen = r.T @ b
        pull = (np.outer(seen, seen) / louder - r.T @ inverse @ r) / louder * covariance
        k = len(piece.knots)
        apart = np.abs(piece.knots[:, None] - piece.knots) / max(memory, 1e-12)
        for joint in range(n):
            own = slice(joint * k, (joint + 1) * k)
            slope[joint] += 2.0 * float(np.sum(pull[own, own]))
            slope[n] += float(np.sum(pull[own, own] * apart))
        slope[n + 1] += (float(b @ b) + piece.outside) / louder - float(np.trace(inverse)) - piece.count
    return total, slope


def _inverse_root(whole: Array) -> tuple[Array, float]:
    """K with Kᵀ K = (I + S)⁻¹, and the log-determinant of I + S: quadratic forms of it are squares, however ill-conditioned."""
    try:
        lower = cholesky(whole, lower=True, check_finite=False)
    except np.linalg.LinAlgError:
        # Where nothing pulls a joint back, slow forces move it so far that rounding makes small directions negative.
        values, vectors = np.linalg.eigh(whole)
        values = np.maximum(values, 1.0)
        return np.asarray(vectors.T / np.sqrt(values)[:, None]), float(np.sum(np.log(values)))
    root = solve_triangular(lower, np.eye(len(whole)), lower=True, check_finite=False)
    return np.asarray(root), 2.0 * float(np.sum(np.log(np.diag(lower))))


def estimate(
    found: Responses, windows: Sequence[Window], free: Sequence[Profiled], joints: Sequence[str]
) -> Discrepancy | None:
    """Size and memory of the force that a fit leaves out; None where sensor noise alone will do.

    free: the fit in its windows under the sensors' noise alone.
    """
    pieces = pieces_of(found, windows, free)
    if not pieces:
        return None
    n = len(joints)
    shortest = max(float(np.median([p.knots[1] - p.knots[0] for p in pieces])), 1e-9)
    bounds = [(np.log(SMALLEST_FORCE), np.log(LARGEST_FORCE))] * n + [
        (np.log(shortest), np.log(LONGEST_FORCE_MEMORY * found.period))
    ]
    bounds.append((0.0, np.log(LOUDEST_VARIANCE)))

    def loss(z: Array) -> tuple[float, Array]:
        value, slope = _gain(pieces, np.exp(z[:n]), float(np.exp(z[n])), float(np.exp(z[n + 1])))
        return -value, -slope

    best: tuple[float, Array] | None = None
    for memory in (2.0 * shortest, 0.25 * found.period):
        louder = sum(p.outside for p in pieces) / max(sum(p.count for p in pieces), 1)
        start = np.log(np.array([*np.full(n, _first_size(pieces, n, memory)), memory, max(louder, 1.0)]))
        start = np.clip(start, *np.array(bounds).T)
        ended = minimize(loss, start, jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": 25, "ftol": 1e-7})
        if best is None or ended.fun < best[0]:
            best = float(ended.fun), np.asarray(ended.x)
    assert best is not None
    gain, louder = -best[0], float(np.exp(best[1][n + 1]))
    # Noise that is louder than it was taken to be is no force: it is asked for beside that.
    alone = max(
        sum(float(p.along @ p.along) + p.outside for p in pieces) / sum(p.count + len(p.along) for p in pieces), 1.0
    )
    without, _ = _gain(pieces, np.full(n, SMALLEST_FORCE), shortest, alone)
    if chi2.sf(max(gain - max(without, 0.0), 0.0), n + 1) >= LEFT_FORCE_CHANCE:
        return None
    sizes = tuple(float(s) * found.torque for s in np.exp(best[1][:n]))
    return Discrepancy(
        tuple(joints),
        sizes,
        float(np.exp(best[1][n])),
        gain,
        louder,
        found.torque * float(np.sqrt(louder)),
        found,
        shortest,
    )


def _first_size(pieces: Sequence[Piece], joints: int, memory: float) -> float:
    """A size that accounts for the excess of the residual over noise, in natural units."""
    excess = sum(max(float(p.along @ p.along) - len(p.along), 0.0) for p in pieces)
    one = sum(float(np.sum((p.r @ covariance_at(p.knots, np.ones(joints), memory)) * p.r)) for p in pieces)
    return float(np.clip(np.sqrt(max(excess, 1e-12) / max(one, 1e-300)), 10.0 * SMALLEST_FORCE, 0.1 * LARGEST_FORCE))
