"""How far a motion can be foretold: windows in which an error of the initial state does not outgrow what fits can follow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import (
    DEAD_POINT_RATIO,
    FEWEST_PIECE_SAMPLES,
    FEWEST_WINDOW_SAMPLES,
    FORETOLD_GROWTH,
    FORETOLD_GROWTH_AT_FIRST,
    PIECES_A_SWING,
    STATE_DIFFERENCE,
)
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.window_states import measured_state
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.grid import hermite
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window, equal_parts
from harness.system.closure import opening

Array = NDArray[np.float64]


class Horizon:
    """How errors of initial states grow in the model as stated, along the motion that was recorded.

    A model that is let run falls over where the recording does not, and what has fallen is stable. So growth is put together from
    pieces too short to lead away, each from where the recording is. Where not every joint was recorded, or something bends, it is
    that of free runs over whole windows.
    rate: of the slowest swing [rad/s]; errors are counted in units of one radian and of this.
    """

    def __init__(self, problem: Problem, predictor: Predictor, rate: float) -> None:
        self.problem, self.predictor, self.rate = problem, predictor, rate
        recorded = {c.site for c in problem.channels if c.quantity == "position"}
        joints = {joint.name for joint in problem.system.movable_joints}
        self.followed = not problem.system.flexible and joints <= recorded
        self._known: dict[int, tuple[NDArray[np.intp], Array]] = {}

    def calm(self, windows: Sequence[Window]) -> tuple[Window, ...]:
        """The windows, those halved over which errors grow too much for a first fit, until they do not or hold few samples.

        None begins at a dead point of what was recorded if it can be helped.
        """
        windows = self._off_dead_points(windows)
        if not self.followed:
            return windows
        done: list[Window] = []
        left = list(windows)
        while left:
            halved: list[Window] = []
            for window in left:
                if window.size < 2 * FEWEST_WINDOW_SAMPLES or _growth(self._along(window)) < FORETOLD_GROWTH_AT_FIRST:
                    done.append(window)
                else:
                    halved += equal_parts(window, 2)
            left = halved
        return self._off_dead_points(sorted(done, key=lambda w: (w.run, w.first)))

    def _off_dead_points(self, windows: Sequence[Window]) -> tuple[Window, ...]:
        """The windows, those that begin at a dead point of what leads joined to the ones before them.

        Where a slide stands stretched its crank turns on: no position and speed of the slide tell those of the crank there, and a
        fit of the initial state has nothing to step in.
        """
        if not self.predictor.mechanism(Hypothesis()).model.dependent:
            return tuple(windows)
        moved = [self._moved(window) for window in windows]
        most = DEAD_POINT_RATIO * float(np.median(moved))
        kept: list[Window] = []
        for window, own in zip(windows, moved, strict=True):
            if kept and kept[-1].run == window.run and own > most:
                kept[-1] = Window(window.run, kept[-1].first, window.last)
            else:
                kept.append(window)
        return tuple(kept)

    def _moved(self, window: Window) -> float:
        """How far what follows by loops moves for what leads, where a window begins."""
        model = self.predictor.mechanism(Hypothesis()).model
        state = measured_state(self.problem, self.predictor, window)
        rows = opening(model.system, state[: model.n]).jacobian
        follows = np.array([name in model.dependent for name in model.names])
        return float(np.linalg.norm(np.linalg.pinv(rows[:, follows]) @ rows[:, ~follows], 2))

    def joined(self, fitted: Fit) -> tuple[Window, ...]:
        """The windows of a fit joined as long as an initial error does not grow beyond what a linear view can follow."""
        groups: list[Window] = []
        current: Window | None = None
        growth = np.zeros((0, 0))
        for window in fitted.windows:
            own = self._along(window) if self.followed else self._free(fitted, window)
            if current is not None and current.run == window.run and _growth(own @ growth) < FORETOLD_GROWTH:
                current = Window(window.run, current.first, window.last)
                growth = own @ growth
                continue
            if current is not None:
                groups.append(current)
            current, growth = window, own
        if current is not None:
            groups.append(current)
        return tuple(groups)

    def _along(self, window: Window) -> Array:
        """Sensitivity (2n, 2n) of the final to the initial state of a window, along the recording."""
        begins, changes = self._pieces(window.run)
        first, last = np.searchsorted(begins, (window.first, window.last))
        total = np.eye(changes.shape[1])
        for change in changes[first:last]:
            total = change @ total
        return total

    def _free(self, fitted: Fit, window: Window) -> Array:
        """The same along the free run of a fit."""
        return transitions(self.predictor, fitted.x, [window], [fitted.states[window]], self.rate)[0]

    def _pieces(self, run: int) -> tuple[NDArray[np.intp], Array]:
        """Where the pieces of a run begin (K,), and their sensitivities (K, 2n, 2n)."""
        if run not in self._known:
            samples, interval = len(self.problem.runs[run].time), self.problem.runs[run].interval
            swing = 2.0 * np.pi / self.rate
            size = int(np.clip(round(swing / PIECES_A_SWING / interval), FEWEST_PIECE_SAMPLES, FEWEST_WINDOW_SAMPLES))
            edges = np.arange(0, samples - 1, size)
            # Each ends where the next one begins.
            pieces = [Window(run, int(a), min(int(a) + size + 1, samples)) for a in edges]
            states = [measured_state(self.problem, self.predictor, piece) for piece in pieces]
            x = np.zeros(len(self.predictor.nominal))
            self._known[run] = edges, transitions(self.predictor, x, pieces, states, self.rate)
        return self._known[run]


def transitions(
    predictor: Predictor, x: Array, windows: Sequence[Window], states: Sequence[Array], rate: float
) -> Array:
    """Sensitivities (W, 2n, 2n) of the final to the initial states (2n,) of windows under nominal quantities ``x``, in units of
    one radian and ``rate`` [rad/s]."""
    hypothesis = Hypothesis()
    mechanism = predictor.mechanism(hypothesis)
    n = len(states[0])
    half = n // 2
    units = np.concatenate([np.ones(half), np.full(half, rate)])
    out = np.empty((len(windows), n, n))
    alike: dict[tuple[int, int], list[int]] = {}
    for k, window in enumerate(windows):
        # Samples that are unevenly spaced have grids of their own.
        alike.setdefault((window.run, window.size if predictor.grid(window).exact else -1 - k), []).append(k)
    for places in alike.values():
        grid = predictor.grid(windows[places[0]])
        starts = np.concatenate([np.vstack([states[k], states[k] + STATE_DIFFERENCE * np.eye(n)]) for k in places])
        lanes = [(0, windows[k], states[k]) for k in places]
        tau = predictor.acting(hypothesis, x[None, :], mechanism, lanes, grid.own)
        tau = None if tau is None else np.repeat(tau, n + 1, axis=0)
        motion = mechanism.model.simulate(
            predictor.row_in(hypothesis, x, windows[places[0]].run), starts[:, :half], starts[:, half:], grid.own,
            tau=tau, hold=predictor.hold, tolerance=predictor.tolerance, threads=predictor.threads,
        )  # fmt: skip
        q, qd, _ = hermite(grid, *motion)
        ends = np.concatenate([q[:, -1], qd[:, -1]], axis=1).reshape(len(places), n + 1, n)
        changes = (ends[:, 1:] - ends[:, :1]).transpose(0, 2, 1) / STATE_DIFFERENCE
        out[places] = changes * units[None, None, :] / units[None, :, None]
    return out


def _growth(change: Array) -> float:
    """The most that an error of unit size grows; infinite where the motion was lost."""
    return float(np.linalg.norm(change, 2)) if np.isfinite(change).all() else np.inf
