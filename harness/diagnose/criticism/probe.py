"""The response of a fit's channels to small forces, which most residual checks are about."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.criticism.constants import PROBING_FORCE_SHARE
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.estimation.linear_response import Response, channels_moved, respond, responsive
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Probe:
    """Force responses of one fit: its motion in every window, and what force histories do to the channels."""

    predictor: Predictor
    likelihood: Likelihood
    fitted: Fit
    torque: float
    motions: dict[Window, Response]

    @property
    def names(self) -> tuple[str, ...]:
        return self.predictor.mechanism(self.fitted.hypothesis).names

    def changes(self, joint: str, forces: Callable[[Array, Array], Array]) -> list[Array]:
        """Whitened changes per window (k, M) by forces (k, G) over a joint's position and velocity, in natural torques."""
        return self.in_time(joint, lambda time, q, v: forces(q, v))

    def in_time(self, joint: str, forces: Callable[[Array, Array, Array], Array]) -> list[Array]:
        """The same by forces over time [s from the window's first sample], position and velocity, each (G,)."""
        k = self.names.index(joint)
        return [self._window(w, k, forces(m.time, m.q[:, k], m.qd[:, k])) for w, m in self.motions.items()]

    def pulses(self, joint: str, window: Window, histories: Array) -> Array:
        """The same for force histories (k, G) in one window, whose samples alone they change."""
        return self._window(window, self.names.index(joint), histories)

    def _window(self, window: Window, k: int, histories: Array) -> Array:
        found = self.motions[window]
        if responsive(self.predictor):
            moved = channels_moved(
                self.predictor, self.likelihood, self.fitted, found,
                partial(found.by_force, k), len(histories), lambda own: self.torque * histories[own],
            )  # fmt: skip
            return np.nan_to_num(moved, copy=False)
        grid = self.predictor.grid(window, self.predictor.margin(self.fitted.hypothesis))
        # Predictions are carried on a little beyond the window, where the linear response ends.
        extra = np.zeros((len(histories) + 1, len(grid.time), len(self.names)))
        extra[:-1, : histories.shape[1], k] = PROBING_FORCE_SHARE * self.torque * histories
        lanes = [(0, window, self.fitted.states[window])] * len(extra)
        predictions = self.predictor.predict(self.fitted.hypothesis, self.fitted.x[None, :], lanes, extra=extra)
        white = self.likelihood.whiten(window, predictions)
        return np.nan_to_num((white[:-1] - white[-1]) / PROBING_FORCE_SHARE)


def probe(predictor: Predictor, likelihood: Likelihood, fitted: Fit, torque: float) -> Probe:
    """The linear response of a fit in all its windows. torque: natural size of forces [N·m]."""
    motions = {w: respond(predictor, fitted, w, torque) for w in fitted.windows}
    return Probe(predictor, likelihood, fitted, torque, motions)
