"""Dry, viscous and quadratic damping from every sample: the motion itself is fitted, dry friction sticking at the end."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.optimize import least_squares

from harness.compare.decay.envelope import envelope
from harness.compare.decay.oscillator import LAWS, Array
from harness.compare.decay.swings import HalfSwings
from harness.denoc.lanes.model import LaneModel
from harness.system import Joint, JointType, Link, System
from harness.system.description import constant

SLOTS = ("damping", "coulomb_torque", "quadratic_drag")
MOST_SAMPLES = 6000


@dataclass(frozen=True, eq=False)
class Likelihood:
    """A fit of the motion.

    laws: which were free. coefficients (3,) of ``LAWS`` over the inertia, std, and their 95 % intervals (3, 2).
    frequency: of vanishing swings [Hz]; rest: of the signal. time, predicted: samples fitted (T,).
    rms: of the residual; bic: Bayesian information criterion with the samples that the residual's memory leaves.
    memory: lag-one correlation of the residual, 0 for white noise. beginning: frequency, rest and state, in the fit's scales (4,).
    """

    laws: tuple[str, ...]
    coefficients: Array
    std: Array
    frequency: float
    rest: float
    time: Array
    predicted: Array
    rms: float
    bic: float
    memory: float
    beginning: Array

    @property
    def ci95(self) -> Array:
        """Intervals of 95 %, cut off at zero, shape (3, 2)."""
        reach = 1.96 * self.std
        return np.column_stack([np.maximum(self.coefficients - reach, 0.0), self.coefficients + reach])


def best(time: Array, signal: Array, found: HalfSwings) -> tuple[Likelihood, tuple[Likelihood, ...]]:
    """The set of laws with the least BIC, and all sets tried, best first; each begins at what the envelope says of it."""
    tried: list[Likelihood] = []
    for size in range(len(LAWS), -1, -1):
        for laws in combinations(LAWS, size):
            one = fit(time, signal, found, envelope(found, laws).coefficients, laws)
            # Where dry friction stops the motion the residual has kinks, and a small set may end in a wrong valley: it is begun
            # anew from a larger one that can do without its member.
            for larger in tried:
                dropped = [k for k, law in enumerate(LAWS) if law in larger.laws and law not in laws]
                if set(laws) < set(larger.laws) and (larger.coefficients[dropped] < 4.0 * larger.std[dropped]).all():
                    again = fit(time, signal, found, larger.coefficients, laws, larger.beginning)
                    one = min(one, again, key=lambda each: each.rms)
                    break
            tried.append(one)
    # All sets are judged by the same number of independent samples, that of the fit that leaves least.
    memory = min(tried, key=lambda one: one.rms).memory
    count = len(tried[0].time) * (1.0 - memory) / (1.0 + memory)
    ranked = sorted(tried, key=lambda one: count * np.log(one.rms**2) + len(one.laws) * np.log(count))
    scored = tuple(
        Likelihood(**{**vars(one), "bic": float(count * np.log(one.rms**2) + len(one.laws) * np.log(count))})
        for one in ranked
    )
    return scored[0], scored


def fit(
    time: Array,
    signal: Array,
    found: HalfSwings,
    start: Array,
    laws: tuple[str, ...] = LAWS,
    beginning: Array | None = None,
) -> Likelihood:
    """Least squares over the samples: damping, frequency, rest position and the state at the first sample are free.

    time [s], signal: (T,), even or not; more than 6000 samples are thinned evenly. start: coefficients (3,) to begin at;
    beginning: frequency, rest and state to begin at, as another fit of these samples found them.
    """
    keep = np.unique(np.linspace(0, len(time) - 1, min(len(time), MOST_SAMPLES)).round().astype(int))
    t, y = time[keep] - time[keep][0], signal[keep]
    model = LaneModel(_oscillator())
    free = [k for k, law in enumerate(LAWS) if law in laws]
    circular = 2.0 * np.pi * found.small
    size = float(found.amplitude[0])
    speed = size * circular
    scale = np.array([circular / 50.0, circular * speed / 50.0, 1.0 / size / 50.0])

    def run(x: Array) -> Array:
        """Signals of many parameter vectors (B, p) at once, (B, T)."""
        rows = np.repeat(model.row()[None, :], len(x), axis=0)
        square = (circular * (1.0 + x[:, 0])) ** 2
        if found.sine:
            rows[:, model.slot("base", "gravity_z")] = -square
        else:
            rows[:, model.slot("base", "gravity_z")] = 0.0
            rows[:, model.slot("swing", "stiffness")] = square
        for column, k in enumerate(free):
            rows[:, model.slot("swing", SLOTS[k])] = np.maximum(x[:, 4 + column], 0.0) * scale[k]
        position, _, _ = model.simulate(rows, x[:, 2:3] * size, x[:, 3:4] * speed, t, tolerance=1e-9)
        return np.asarray(position[:, :, 0] + x[:, 1:2] * size)

    def miss(x: Array) -> Array:
        return np.nan_to_num(run(x[None, :])[0] - y, nan=1e3 * size) / size

    def slope(x: Array) -> Array:
        step = 1e-5
        moved = np.repeat(x[None, :], 2 * len(x), axis=0)
        for k in range(len(x)):
            low = 0.0 if k >= 4 else -np.inf
            moved[2 * k, k], moved[2 * k + 1, k] = x[k] + step, max(x[k] - step, low)
        ran = run(moved)
        spans = np.array([moved[2 * k, k] - moved[2 * k + 1, k] for k in range(len(x))])
        return np.asarray(np.nan_to_num((ran[::2] - ran[1::2]) / spans[:, None] / size).T)

    if beginning is None:
        at, going = _first_state(t, y)
        beginning = np.array([0.0, found.rest / size, (at - found.rest) / size, going / speed])
    guess = np.concatenate([beginning, np.maximum(start[free] / scale[free], 0.01)])
    lower = np.concatenate([np.full(4, -np.inf), np.zeros(len(free))])
    done = least_squares(miss, guess, slope, bounds=(lower, np.inf), x_scale="jac", xtol=1e-10, ftol=1e-10, max_nfev=60)
    residual = done.fun * size
    rms = float(np.sqrt(np.mean(residual**2)))
    memory = float(np.clip(residual[1:] @ residual[:-1] / max(residual @ residual, 1e-300), 0.0, 0.99))
    inflated = rms**2 / size**2 * (1.0 + memory) / (1.0 - memory)
    covariance = np.linalg.pinv(done.jac.T @ done.jac) * inflated
    coefficients, std = np.zeros(3), np.zeros(3)
    coefficients[free] = done.x[4:] * scale[free]
    std[free] = np.sqrt(np.diagonal(covariance)[4:]) * scale[free]
    return Likelihood(
        laws=tuple(laws),
        coefficients=coefficients,
        std=std,
        frequency=float(found.small * (1.0 + done.x[0])),
        rest=float(done.x[1] * size),
        time=t + time[keep][0],
        predicted=y + residual,
        rms=rms,
        bic=float("nan"),
        memory=memory,
        beginning=done.x[:4],
    )


def _first_state(t: Array, y: Array) -> tuple[float, float]:
    """Position and velocity at the first sample, by a parabola through the first few."""
    few = slice(0, max(5, min(len(t), int(np.searchsorted(t, t[0] + 0.05)))))
    curve = np.polynomial.Polynomial.fit(t[few], y[few], 2)
    return float(curve(t[0])), float(curve.deriv()(t[0]))


def _oscillator() -> System:
    """A point of 1 kg on a massless metre: unit inertia, and gravity is the square of the circular frequency."""
    joint = Joint("swing", JointType.REVOLUTE, "base", "bob", axis=constant([0.0, 1.0, 0.0]))
    link = Link("bob", 1.0, constant([0.0, 0.0, -1.0]), constant([[0.0] * 3] * 3))
    return System("oscillator", (joint,), (link,), gravity=constant([0.0, 0.0, -1.0]))
