"""Sparse regression on the torque that the nominal model leaves over, as ``pysindy`` does it.

- Motion: Savitzky-Golay filters over a tenth of a second, the smoother that its ``SmoothedFiniteDifference`` takes.
- Terms with a column each, brought to the same length (its ``normalize_columns``); sequentially thresholded least squares
  (``STLSQ``), its default optimizer.
- The threshold is searched for by data held out, as its release 1.1.0 made for ("cross-validation of SINDy models"): the fewest
  terms that predict the torque left over of the last recording as well as the best do, none at all among them.
- Commands that a controller holds are on average what was and what comes at a sample; a recording does not say whether they
  are, so that both are tried, and what predicts the torque left over better stays.
- Where no effort acts an inertia is no term: what the model asks for is then made of the acceleration and of the weight alone, and
  minus the model itself explains all of it.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numba
import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from harness.compare.peers.runs import NotForIt, Run, pushed, ways
from harness.denoc import Denoc
from harness.system import System

Array = NDArray[np.float64]

SMOOTHED = 0.1  # s
THRESHOLDS = (0.02, 0.05, 0.1, 0.2, 0.5)  # of the length of what is left over, for columns of length one
RIDGE = 1e-6
AS_GOOD = 1.02  # error held out, times the best: where fewer terms do as well
SOFT = 0.005  # of the largest speed: where dry friction sets in in a free run
STEP = 2e-3  # s at most, of a free run
# Columns, of positions, velocities and accelerations (T,): what a coefficient of each is, and where it is in ``_swing``.
TERMS = {
    "viscous_damping": lambda q, v, a: v,
    "coulomb_friction": lambda q, v, a: np.sign(v),
    "quadratic_drag": lambda q, v, a: v * np.abs(v),
    "constant_torque": lambda q, v, a: np.ones(len(q)),
    "joint_stiffness": lambda q, v, a: q,
    "cubic_stiffness": lambda q, v, a: q**3,
    "added_inertia": lambda q, v, a: a,
    "payload_mass": lambda q, v, a: np.sin(q),
}


@dataclass(frozen=True)
class Sparse:
    """Coefficients of the terms kept, by joint [SI]; error: of the torque left over of the last recording; soft: [rad/s or m/s];
    held: whether efforts stay from sample to sample."""

    system: System
    terms: Mapping[str, Mapping[str, float]]
    error: float
    soft: float
    held: bool = False

    def free_run(self, state: Array, time: Array, tau: Array | None) -> Array:
        """Positions (T, 1) of a rig of one joint from a state (2,)."""
        if len(self.system.joint_names) != 1:
            raise NotForIt("its laws run freely for one joint here")
        model = Denoc(self.system)
        inertia = float(model.mass_matrix(np.zeros(1))[0, 0])
        (kept,) = self.terms.values()
        p = np.array([kept.get(name, 0.0) for name in TERMS])
        # Gravity's torque in one joint: at 0, a quarter and half a turn.
        rest, quarter, half = (float(model.gravity(np.array([x]))[0]) for x in (0.0, 0.5 * np.pi, np.pi))
        level = rest if self.system.movable_joints[0].prismatic else 0.5 * (rest + half)
        weight = np.array([rest - level, 0.0 if self.system.movable_joints[0].prismatic else quarter - level, level])
        p[0] += self.system.movable_joints[0].damping
        p[1] += self.system.movable_joints[0].friction
        out = np.empty(len(time))
        sampled = pushed(time, tau, held=True)
        _swing(state[0], state[1], np.ascontiguousarray(time), sampled, inertia, weight, p, self.soft, self.held, out)
        return out[:, None]


def fit_regression(system: System, train: Sequence[Run], heldout: Sequence[Run]) -> Sparse:
    """Terms for every joint; see above. Raises ImportError where pysindy is not installed."""
    found = [
        replace(_fitted(system, [r.at_samples(way) for r in train], [r.at_samples(way) for r in heldout]), held=way)
        for way in ways(train)
    ]
    return min(found, key=lambda one: one.error)


def thresholded(columns: Array, y: Array, threshold: float) -> Array:
    """Coefficients (K,) of columns (T, K) of length one that add up to y (T,), those below a share of its length left out.

    By pysindy's own ``STLSQ``.
    """
    import pysindy

    optimizer = pysindy.STLSQ(threshold=threshold * float(np.linalg.norm(y)), alpha=RIDGE)
    with contextlib.redirect_stdout(io.StringIO()):
        optimizer.fit(columns, y.reshape(-1, 1))
    return np.ravel(optimizer.coef_)


def _fitted(system: System, train: Sequence[Run], heldout: Sequence[Run]) -> Sparse:
    """With efforts as they are at the samples."""
    fitted, judged = ([_left_over(system, run) for run in some] for some in (train, heldout))
    found: dict[str, dict[str, float]] = {}
    squares = 0.0
    names = [name for name in TERMS if name != "added_inertia" or any(run.driven for run in train)]
    for k, joint in enumerate(system.joint_names):
        library, y = _columns(fitted, k, names)
        other, z = _columns(judged, k, names)
        norms = np.linalg.norm(library, axis=0)
        norms[norms == 0.0] = 1.0
        tried = [np.zeros(len(names))]
        tried += [thresholded(library / norms, y, threshold) / norms for threshold in THRESHOLDS]
        errors = [float(np.sqrt(np.mean((z - other @ c) ** 2))) for c in tried]
        enough = AS_GOOD * min(errors)
        best = min(
            (n for n, e in enumerate(errors) if e <= enough), key=lambda n: (np.count_nonzero(tried[n]), errors[n])
        )
        found[joint] = {name: float(c) for name, c in zip(names, tried[best], strict=True) if c}
        squares += errors[best] ** 2
    fastest = max(float(np.max(np.abs(v))) for _, v, _, _ in fitted)
    return Sparse(system, found, float(np.sqrt(squares / len(found))), SOFT * fastest)


def _left_over(system: System, run: Run) -> tuple[Array, Array, Array, Array]:
    """Smoothed positions, velocities, accelerations, and the torque that the model does not ask for, each (T, n)."""
    step = float(np.median(np.diff(run.time)))
    window = max(7, int(SMOOTHED / step) // 2 * 2 + 1)
    grid = np.arange(run.time[0], run.time[-1], step)
    even = np.stack([np.interp(grid, run.time, p) for p in run.positions.T], axis=1)
    q, v, a = (savgol_filter(even, window, 4, deriv=d, delta=step, axis=0) for d in (0, 1, 2))
    model = Denoc(system)
    asked = np.array([model.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)])
    pushed = np.zeros_like(even)
    if run.efforts is not None:
        pushed = np.stack([np.interp(grid, run.time, u) for u in run.efforts.T], axis=1)
    return q, v, a, pushed - asked


def _columns(
    parts: Sequence[tuple[Array, Array, Array, Array]], joint: int, names: Sequence[str]
) -> tuple[Array, Array]:
    q, v, a, y = (np.concatenate([part[k][:, joint] for part in parts]) for k in range(4))
    return np.column_stack([TERMS[name](q, v, a) for name in names]), y


@numba.njit(cache=True)
def _swing(
    q: float, v: float, time: Array, tau: Array, inertia: float, weight: Array, p: Array, soft: float, held: bool, out: Array
) -> None:  # fmt: skip
    total = max(inertia + p[6], 0.05 * inertia)
    for t in range(len(time)):
        out[t] = q
        if t + 1 == len(time):
            break
        m = max(1, int(np.ceil((time[t + 1] - time[t]) / STEP - 1e-6)))
        h = (time[t + 1] - time[t]) / m
        for i in range(m):
            qk, vk, dq, dv = q, v, 0.0, 0.0
            for stage in range(4):
                share = 0.0 if held else (i + (0.0 if stage == 0 else 1.0 if stage == 3 else 0.5)) / m
                force = tau[t] + share * (tau[t + 1] - tau[t])
                force -= weight[0] * np.cos(qk) + weight[1] * np.sin(qk) + weight[2]
                force -= p[0] * vk + p[1] * np.tanh(vk / soft) + p[2] * vk * abs(vk)
                force -= p[3] + p[4] * qk + p[5] * qk**3 + p[7] * np.sin(qk)
                acceleration = force / total
                share = 1.0 if stage == 0 or stage == 3 else 2.0
                dq += share * vk
                dv += share * acceleration
                step = 0.5 * h if stage < 2 else h
                qk, vk = q + step * vk, min(max(v + step * acceleration, -1e3), 1e3)
            q, v = q + h / 6.0 * dq, min(max(v + h / 6.0 * dv, -1e3), 1e3)
