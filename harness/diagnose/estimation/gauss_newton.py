"""One damped Gauss–Newton step: of the shared parameters within their bounds, and of the initial states that follow them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import CURVED_STEP_RATIO
from harness.diagnose.estimation.linearisation import Linearisation, eliminated
from harness.diagnose.estimation.objective import Residuals, States
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trial:
    """A step proposed: where it leads, what it is expected to gain, and which parameters were free of their bounds."""

    damping: float
    x: Array
    states: dict[Window, Array]
    predicted: float
    free: NDArray[np.bool_]
    step: Array
    state_steps: Array


@dataclass(frozen=True, eq=False)
class Stepping:
    """What steps obey wherever they begin.

    weights: of the priors, (P,). lower, upper: bounds, (P,). held: parameters that do not move, (P,). stiff: how stiffly the
    initial states are held, (S,); see ``loosely_held``. stay: those that are held where they are and not to zero, (S,).
    """

    windows: tuple[Window, ...]
    weights: Array
    lower: Array
    upper: Array
    held: NDArray[np.bool_]
    stiff: Array
    stay: NDArray[np.bool_]

    def prior(self, x: Array) -> float:
        """Weighted cost of the parameters by themselves."""
        return float(np.sum(self.weights * x**2))

    def trial(self, here: Linearisation, x: Array, states: States, damping: float) -> Trial:
        """The step that the linear view proposes under a damping."""
        step, free = _step(here, x, self, damping)
        begun = np.where(self.stay, 0.0, np.array([states[w] for w in self.windows]))
        gain = _predicted_gain(here, self.weights, x, step)
        state_steps = following(here.triangles, step, damping, self.stiff, begun)
        predicted = gain - _left(here, step, state_steps)
        if predicted < 0.0 and self.stiff.any():
            # What begins far off is not brought back at a loss.
            state_steps = following(here.triangles, step, damping, self.stiff, np.zeros_like(begun))
            predicted = gain - _left(here, step, state_steps)
        if predicted < 0.0:
            # A long step of the parameters asks for long ones of the states; held back, they would make it look like a loss.
            state_steps = following(here.triangles, step, 0.0, 0.0 * self.stiff, np.zeros_like(begun))
            predicted = gain - _left(here, step, state_steps)
        moved = {w: states[w] + s for w, s in zip(self.windows, state_steps, strict=True)}
        return Trial(damping, np.clip(x + step, self.lower, self.upper), moved, predicted, free, step, state_steps)

    def along_the_curve(self, here: Linearisation, trial: Trial, found: Residuals) -> Trial | None:
        """A trial brought back into the valley by what its residuals have beyond the linear view; none where that is no correction.

        The second-order correction of sequential quadratic programming (Fletcher, Practical Methods of Optimization, 1987,
        §14.4), here as in the geodesic acceleration of Transtrum and Sethna (arXiv:1201.5885).
        """
        with np.errstate(over="ignore", invalid="ignore"):
            beyond = [
                np.nan_to_num(after - before - basis @ moved - shared @ trial.step)
                for after, before, basis, shared, moved in zip(
                    found[1], here.residuals, here.bases, here.shared, trial.state_steps, strict=True
                )
            ]
        curve = eliminated(0.0, beyond, here.bases, here.shared)
        within = replace(self, lower=self.lower - trial.x, upper=self.upper - trial.x)
        step, _ = _step(curve, np.zeros(len(trial.x)), within, trial.damping)
        steps = following(curve.triangles, step, trial.damping, self.stiff, np.zeros_like(trial.state_steps))
        if not (
            _length(step) <= CURVED_STEP_RATIO * _length(trial.step)
            and _length(steps) <= CURVED_STEP_RATIO * _length(trial.state_steps)
        ):
            return None
        moved = {w: trial.states[w] + s for w, s in zip(self.windows, steps, strict=True)}
        return replace(trial, x=np.clip(trial.x + step, self.lower, self.upper), states=moved)


def following(
    triangles: Sequence[tuple[Array, Array, Array]], step: Array, damping: float, stiff: Array, begun: Array
) -> Array:
    """How the initial states of all windows follow a step of the shared parameters, shape (W, S).

    triangles: of the linear view. stiff: how stiffly states are held to zero, (S,); begun: where they stand, (W, S).
    """
    rss = np.array([t[0] for t in triangles])
    size = rss.shape[2]
    scale = np.linalg.norm(rss, axis=1) + 1e-9
    held = [(np.sqrt(damping * 1e-3) * scale + 1e-9)[:, :, None] * np.eye(size)]
    wanted = -np.array([t[2] for t in triangles]) - np.array([t[1] for t in triangles]) @ step
    right = [wanted, np.zeros_like(wanted)]
    if stiff.any():
        held.append(np.broadcast_to(np.diag(stiff), rss.shape))
        right.append(-stiff * begun)
    # Least squares by singular values, of all windows at once.
    u, s, vt = np.linalg.svd(np.concatenate([rss, *held], axis=1), full_matrices=False)
    along = np.einsum("wij,wi->wj", u, np.concatenate(right, axis=1))
    least = np.finfo(np.float64).eps * 2 * size * s[:, :1]
    along = np.where(s > least, along / np.where(s > least, s, 1.0), 0.0)
    return np.asarray(np.einsum("wji,wj->wi", vt, along))


def _step(here: Linearisation, x: Array, rules: Stepping, damping: float) -> tuple[Array, NDArray[np.bool_]]:
    """Damped step in the shared parameters that respects the bounds; and which of them were free."""
    size = len(x)
    free = ~rules.held
    step = np.zeros(size)
    scale = np.sqrt(np.sum(here.matrix**2, axis=0) + rules.weights)
    for _ in range(size + 1):
        index = np.flatnonzero(free)
        if len(index) == 0:
            return step * 0.0, free
        stiffness = np.sqrt(rules.weights[index])
        a = np.vstack([here.matrix[:, index], np.diag(stiffness), np.sqrt(damping) * np.diag(scale[index] + 1e-12)])
        fixed_part = here.matrix @ np.where(free, 0.0, step)
        b = -np.concatenate([here.vector + fixed_part, stiffness * x[index], np.zeros(len(index))])
        step[index] = np.linalg.lstsq(a, b, rcond=None)[0]
        beyond = free & ((x + step < rules.lower - 1e-12) | (x + step > rules.upper + 1e-12))
        if not np.any(beyond):
            break
        nearest = np.where(x + step < rules.lower, rules.lower, rules.upper)
        step[beyond] = nearest[beyond] - x[beyond]
        free = free & ~beyond
    return step, free


def _left(here: Linearisation, step: Array, state_steps: Array) -> float:
    """What the initial states leave of the part of the residuals that they alone could take away, under a step."""
    left = [r + b @ step + a @ own for (a, b, r), own in zip(here.triangles, state_steps, strict=True)]
    return sum(float(rest @ rest) for rest in left)


def _predicted_gain(here: Linearisation, weights: Array, x: Array, step: Array) -> float:
    """What a step takes off cost and prior if the initial states take away all that they can."""
    state_part = sum(float(rs @ rs) for _, _, rs in here.triangles)
    before = float(here.vector @ here.vector) + float(np.sum(weights * x**2))
    moved = here.vector + here.matrix @ step
    after = float(moved @ moved) + float(np.sum(weights * (x + step) ** 2))
    return before - after + state_part


def _length(step: Array) -> float:
    with np.errstate(over="ignore"):
        return float(np.sqrt(np.sum(step**2)))
