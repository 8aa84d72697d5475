"""Linear response of the channels to small forces along a fitted motion: one short step per grid point, then a recursion.

Along the motion the deviation obeys δ_{k+1} = Φ_k δ_k + Γ_k u_k. The transitions Φ_k and input matrices Γ_k come from lanes
that each take a single step; after that, hundreds of force histories cost a few matrix products.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from harness.denoc.lanes.model import LaneModel
from harness.diagnose.estimation.constants import FORCE_DIFFERENCE, STATE_DIFFERENCE
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.grid import cubic
from harness.diagnose.problem.problem import ChannelInfo, Run
from harness.diagnose.problem.windows import Window, contains
from harness.effects.scale import pull
from harness.recording.sensors import observe
from harness.system import System

Array = NDArray[np.float64]

TOGETHER = 64  # histories propagated at once, whose deviations fit into the processor's cache


@dataclass(frozen=True, eq=False)
class Response:
    """Motion of a fit in a window and its linear response.

    time: grid [s] from the window's first sample, shape (G,); q, qd: (G, n); transition: (G − 1, 2n, 2n);
    force: response of the state to unit generalized forces over a step, (G − 1, 2n, n); base: the same to a unit
    acceleration of the base along its direction of shaking, (G − 1, 2n).
    """

    window: Window
    time: Array
    q: Array
    qd: Array
    qdd: Array
    transition: Array
    force: Array
    base: Array

    def within(self, window: Window, points: slice, begins: float) -> Response:
        """A stretch of it, that of some of its points, for a piece of its window; times are from ``begins`` [s]."""
        steps = slice(points.start, points.stop - 1)
        return replace(
            self, window=window, time=self.time[points] - begins, q=self.q[points], qd=self.qd[points], qdd=self.qdd[points],
            transition=self.transition[steps], force=self.force[steps], base=self.base[steps],
        )  # fmt: skip

    def by_force(self, joint: int, histories: Array) -> Array:
        """State deviations (G, 2n, K) caused by force histories (K, G) at a coordinate."""
        return self._propagated(self.force[:, :, joint], histories)

    def by_shaking(self, histories: Array) -> Array:
        """State deviations (G, 2n, K) caused by histories of base acceleration (K, G)."""
        return self._propagated(self.base, histories)

    def _propagated(self, gain: Array, histories: Array) -> Array:
        mean = np.ascontiguousarray((0.5 * (histories[:, :-1] + histories[:, 1:])).T)
        return np.asarray(_propagate(self.transition.copy(), gain.copy(), mean))


@njit(cache=True, error_model="numpy", nogil=True)
def _propagate(transition: Any, gain: Any, mean: Any) -> Any:
    """State deviations (G, S, K) from rest under the mean inputs (G − 1, K) of every step; gain: (G − 1, S)."""
    steps, size = gain.shape
    count = mean.shape[1]
    out = np.zeros((steps + 1, size, count))
    for k in range(steps):
        for i in range(size):
            for c in range(count):
                out[k + 1, i, c] = gain[k, i] * mean[k, c]
            for j in range(size):
                share = transition[k, i, j]
                for c in range(count):
                    out[k + 1, i, c] += share * out[k, j, c]
    return out


def respond(predictor: Predictor, fitted: Fit, window: Window, torque: float) -> Response:
    """Linear response of a fit in one window. torque: natural size of forces [N·m]."""
    mechanism = predictor.mechanism(fitted.hypothesis)
    model = mechanism.model
    n = len(mechanism.names)
    grid = predictor.grid(window, predictor.margin(fitted.hypothesis))
    time = grid.own
    row = predictor.row_in(fitted.hypothesis, fitted.x, window.run)
    state = fitted.states[window]
    offset = predictor.runs[window.run].date(window.first)
    tau = predictor.acting(fitted.hypothesis, fitted.x[None, :], mechanism, [(0, window, state)], time)
    amplitude = model.slot("base", "excitation_amplitude")
    start = offset if row[amplitude] != 0.0 else 0.0
    q, qd, qdd = predictor.motions(mechanism, row[None, :], state[None], time + start, tau, np.zeros(1))
    points = len(time) - 1
    copies = 1 + 3 * n + 1
    rows = np.tile(row, (points * copies, 1))
    if row[amplitude] != 0.0:
        frequency = row[model.slot("base", "excitation_frequency")]
        rows[:, model.slot("base", "excitation_phase")] += (
            2.0 * np.pi * frequency * np.repeat(time[:-1] + start, copies)
        )
    shake = FORCE_DIFFERENCE * float(np.linalg.norm(row[[model.slot("base", f"gravity_{a}") for a in "xyz"]]) or 9.81)
    for axis in "xyz":
        direction = row[model.slot("base", f"excitation_{axis}")]
        rows[copies - 1 :: copies, model.slot("base", f"gravity_{axis}")] -= shake * direction
    states = np.repeat(np.concatenate([q[0, :-1], qd[0, :-1]], axis=1), copies, axis=0)
    for j in range(2 * n):
        states[1 + j :: copies, j] += STATE_DIFFERENCE
    acting = over_each_step(predictor, tau, (points, n), copies)
    push = FORCE_DIFFERENCE * torque
    for j in range(n):
        acting[1 + 2 * n + j :: copies, :, j] += push
    eq, eqd, _ = model.simulate(
        rows, np.ascontiguousarray(states[:, :n]), np.ascontiguousarray(states[:, n:]), np.array([0.0, grid.step]), tau=acting,
        hold=predictor.hold, tolerance=predictor.tolerance, threads=predictor.threads,
    )  # fmt: skip
    end = np.concatenate([eq[:, 1], eqd[:, 1]], axis=1).reshape(points, copies, 2 * n)
    change = end[:, 1:] - end[:, :1]
    transition = np.swapaxes(change[:, : 2 * n], 1, 2) / STATE_DIFFERENCE
    force = np.swapaxes(change[:, 2 * n : 3 * n], 1, 2) / push
    base = change[:, 3 * n] / shake
    return Response(
        window, time, q[0], qd[0], qdd[0],
        np.nan_to_num(transition), np.nan_to_num(force), np.nan_to_num(base),
    )  # fmt: skip


def over_each_step(predictor: Predictor, tau: Array | None, shape: tuple[int, int], copies: int) -> Array:
    """Forces at the beginning and the end of every step of a grid, (G − 1) · copies of (2, n): those of one lane, (1, G, n).

    shape: G − 1 and n; copies: lanes of every step, which follow one another.
    """
    points, n = shape
    out = np.zeros((points * copies, 2, n))
    if tau is not None:
        out[:, 0] = np.repeat(tau[0, :-1], copies, axis=0)
        out[:, 1] = np.repeat(tau[0, :-1] if predictor.problem.held else tau[0, 1:], copies, axis=0)
    return out


def motions(predictor: Predictor, fitted: Fit, windows: Sequence[Window]) -> list[Response]:
    """The motion of a fit, and its linear response, in some of its windows."""
    system = predictor.system
    torque = pull(system)
    return [respond(predictor, fitted, window, torque) for window in windows]


def begun(along: Sequence[Response], run: Run, piece: Window) -> Array:
    """Where a piece of a window begins, on the motion through that window; the state (2n,)."""
    motion = next(m for m in along if contains(m.window, piece))
    since = run.time[piece.first] - run.time[motion.window.first]
    return np.array([np.interp(since, motion.time, own) for own in np.hstack([motion.q, motion.qd]).T])


LINEAR = ("position", "velocity", "tip_deflection", "root_strain")
"""Quantities that are linear in the state."""


def channels_moved(
    predictor: Predictor, likelihood: Likelihood, fitted: Fit, found: Response,
    propagated: Callable[[Array], Array], count: int, histories: Callable[[slice], Array],
) -> Array:  # fmt: skip
    """Whitened changes of the channels (K, M) by histories of a force or of the base's acceleration, some of them at a time.

    propagated: state deviations (G, 2n, k) under histories (k, G); count: K; histories: those of a stretch of them.
    """
    stretches = [slice(k, k + TOGETHER) for k in range(0, max(count, 1), TOGETHER)]
    return np.vstack([
        to_channels(predictor, likelihood, fitted, found, propagated(histories(own))) for own in stretches
    ])  # fmt: skip


def to_channels(predictor: Predictor, likelihood: Likelihood, fitted: Fit, found: Response, deviations: Array) -> Array:
    """Whitened changes of the channels (K, M) that state deviations (G, 2n, K) make; of those linear in the state only."""
    model = predictor.mechanism(fitted.hypothesis).model
    n = model.n
    grid = predictor.grid(found.window, predictor.margin(fitted.hypothesis))
    problem = predictor.problem
    size, count = found.window.size, deviations.shape[2]
    (row,), (system,) = predictor.made(fitted.hypothesis, fitted.x[None])
    place, speed = deviations[:, :n], deviations[:, n:]
    weights = likelihood.weights(found.window)
    out = np.zeros((len(problem.channels), size, count))
    for c, channel in enumerate(problem.channels):
        if channel.quantity not in LINEAR:
            continue
        rate = _read(model, row, system, channel, speed)
        if channel.quantity == "velocity":
            i, s = grid.index[:size], grid.weight[:size, None]
            sampled = rate[i] if grid.exact else rate[i] * (1 - s) + rate[i + 1] * s
        else:
            sampled = cubic(grid, _read(model, row, system, channel, place), rate, size)
        out[c] = likelihood.colours[c].whiten(np.nan_to_num(sampled), axis=0) * weights[c, :, None]
    return out.reshape(-1, count).T


def _read(model: LaneModel, row: Array, system: System, channel: ChannelInfo, states: Array) -> Array:
    """What a channel linear in the positions makes of them, (G, n, K): (G, K); of their rates it makes its own rate."""
    count = states.shape[2]
    if channel.site in model.names:
        return np.asarray(states[:, model.names.index(channel.site)])
    lanes = np.moveaxis(states, 2, 0)
    still = np.zeros_like(lanes)
    rows, systems = np.broadcast_to(row, (count, model.P)), [system] * count
    return observe(model, rows, channel.site, channel.quantity, (lanes, still, still), systems, linear=True).T


def responsive(predictor: Predictor) -> bool:
    """Whether the linear response can speak for all channels: of forces at joints, if there are any."""
    return bool(predictor.problem.system.movable_joints) and all(
        c.quantity in LINEAR for c in predictor.problem.channels
    )
