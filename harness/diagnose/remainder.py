"""What is left when the best hypothesis has been fitted: is it more than noise, and what does it look like as a force?

A force that nobody has a law for still shows: the response of the channels to small generalized forces that depend on
position and velocity (the same in every recording), or that act for a short time only (different in each), is linear. Such
responses are projected off everything the hypothesis may adjust and held against the residual, on the training data and
then, with the coefficients found there, on the data held out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.fit import Fit
from harness.diagnose.likelihood import Likelihood
from harness.diagnose.predict import Predictor
from harness.diagnose.screen import Nuisance, nuisance
from harness.diagnose.windows import Window

Array = NDArray[np.float64]

BUMPS = 10  # places over the range of a joint at which a force of its own is allowed
PULSE = 0.5  # of a swing's period: how long a force that acts once is taken to last
PUSH = 1e-4  # size of the probing forces, in units of the gravity torque: small enough to stay linear


@dataclass(frozen=True, eq=False)
class Shape:
    """A force as a function of a joint's motion: ``what`` in words and formula, ``values(q, qd)`` in units of one."""

    what: str
    joint: str
    values: Array


@dataclass(frozen=True, eq=False)
class Test:
    """One question put to the residual: gain in cost by ``size`` shapes, its chance under noise alone, and held out.

    heldout_z: gain on held-out data in standard deviations of what noise would do; nan if not asked.
    """

    name: str
    gain: float
    size: int
    chance: float
    heldout_z: float = float("nan")
    where: tuple[str, ...] = ()


def motion(predictor: Predictor, fitted: Fit, window: Window) -> tuple[Array, Array, Array]:
    """Times on the simulation grid [s], positions and velocities (G, n) of the fitted motion in a window."""
    mechanism = predictor.mechanism(fitted.hypothesis)
    n = len(mechanism.names)
    grid = predictor.grid(window, predictor.margin(fitted.hypothesis))
    row = predictor.row(fitted.hypothesis, fitted.x)
    state = fitted.states[window]
    tau = None
    if predictor.runs[window.run].effort is not None:
        tau = predictor.efforts(fitted.hypothesis, fitted.x[None, :], mechanism, [(0, window, state)], grid.time)
    q, qd, _ = mechanism.model.simulate(
        row[None, :], state[None, :n], state[None, n:], grid.time, tau=tau, tolerance=predictor.tolerance
    )
    return grid.time, q[0], qd[0]


def responses(
    predictor: Predictor, likelihood: Likelihood, fitted: Fit, window: Window, joint: str, forces: Array
) -> Array:
    """Whitened response of a window's channels per unit of each force history (k, G) at a joint, shape (k, M)."""
    mechanism = predictor.mechanism(fitted.hypothesis)
    extra = np.zeros((len(forces), forces.shape[1], len(mechanism.names)))
    extra[:, :, mechanism.names.index(joint)] = forces
    state = fitted.states[window]
    lanes = [(0, window, state)] * len(forces)
    predictions = predictor.predict(fitted.hypothesis, fitted.x[None, :], lanes, extra=extra)
    return likelihood.whiten(window, predictions) - likelihood.whiten(
        window, predictor.predict(fitted.hypothesis, fitted.x[None, :], [(0, window, state)], extra=extra[:1] * 0.0)
    )


def state_shapes(q: Array, qd: Array, low: float, high: float, fast: float) -> tuple[list[str], Array]:
    """Forces over one joint's position and velocity: smooth polynomials, then bumps in position, going and coming.

    low, high: range of position that the bumps divide; fast: velocity scale. Returns names and values (k, G).
    """
    u = np.clip((q - 0.5 * (low + high)) / (0.5 * (high - low)), -1.5, 1.5)
    w = np.clip(qd / fast, -1.5, 1.5)
    names, values = [], []
    for a in range(4):
        for b in range(4):
            if a + b <= 4:
                names.append(f"u^{a} w^{b}")
                values.append(u**a * w**b)
    for b, sign in (("sign(w)", np.tanh(20.0 * w)), ("u sign(w)", u * np.tanh(20.0 * w))):
        names.append(b)
        values.append(sign)
    centres = np.linspace(-1.0, 1.0, BUMPS)
    width = centres[1] - centres[0]
    for c in centres:
        bump = np.exp(-(((u - c) / width) ** 2))
        names += [f"bump({c:.2f})", f"bump({c:.2f}) sign(w)"]
        values += [bump, bump * np.tanh(20.0 * w)]
    return names, np.array(values)


@dataclass(frozen=True, eq=False)
class Remains:
    """Answer of the tests: significant or not, the tests themselves, and the force over position as found."""

    significant: bool
    tests: tuple[Test, ...]
    excess: float
    coefficients: dict[str, tuple[list[str], Array]]


def project_window(space: Nuisance, changes: Sequence[Array]) -> Array:
    return space.project(changes)


def solve_gain(directions: Array, residual: Array, strength: float = 1e-6) -> tuple[float, Array, float]:
    """Gain in cost, coefficients and effective number of directions of a least-squares combination."""
    norms = np.linalg.norm(directions, axis=0)
    keep = norms > 1e-6 * max(float(norms.max(initial=0.0)), 1e-300)
    coefficients = np.zeros(directions.shape[1])
    if not np.any(keep):
        return 0.0, coefficients, 0.0
    scaled = directions[:, keep] / norms[keep]
    u, s, vt = np.linalg.svd(scaled, full_matrices=False)
    strong = s > strength * s[0]
    along = u[:, strong].T @ residual
    coefficients[keep] = -(vt[strong].T @ (along / s[strong])) / norms[keep]
    return float(along @ along), coefficients, float(strong.sum())


def examine(
    predictor: Predictor,
    likelihood: Likelihood,
    fitted: Fit,
    heldout: Fit | None,
    joints: Sequence[str],
    torque_scales: Sequence[float],
    period: float,
    level: float = 1e-4,
) -> Remains:
    """Tests of what a fit leaves.

    heldout: the same hypothesis on the held-out windows, only initial states fitted. joints, torque_scales: where forces
    may act and their natural size [N·m]. period: of the slowest swing [s]. level: chance at which a test counts.
    """
    space = nuisance(fitted, predictor)
    residual = space.residual
    noise = max(1.0, float(np.median(_block_variance(fitted))))
    tests: list[Test] = []
    coefficients: dict[str, tuple[list[str], Array]] = {}
    histories = {w: motion(predictor, fitted, w) for w in fitted.windows}
    held_space = nuisance(heldout, predictor) if heldout is not None else None
    held_histories = {w: motion(predictor, heldout, w) for w in heldout.windows} if heldout is not None else {}
    best_gain = 0.0
    for joint, torque in zip(joints, torque_scales, strict=True):
        k = predictor.mechanism(fitted.hypothesis).names.index(joint)
        pooled = np.concatenate([h[1][:, k] for h in histories.values()])
        speeds = np.concatenate([np.abs(h[2][:, k]) for h in histories.values()])
        low, high = (float(x) for x in np.quantile(pooled, [0.005, 0.995]))
        fast = max(float(np.quantile(speeds, 0.98)), 1e-9)
        if high - low < 1e-9:
            continue
        names: list[str] = []

        def probe(of: Fit, window: Window, history: tuple[Array, Array, Array]) -> Array:
            nonlocal names
            names, values = state_shapes(history[1][:, k], history[2][:, k], low, high, fast)
            return responses(predictor, likelihood, of, window, joint, PUSH * torque * values) / PUSH

        changes = [probe(fitted, w, histories[w]) for w in fitted.windows]
        directions = space.project([np.nan_to_num(c) for c in changes])
        held_directions = None
        if heldout is not None and held_space is not None:
            held_directions = held_space.project(
                [np.nan_to_num(probe(heldout, w, held_histories[w])) for w in heldout.windows]
            )
        smooth = [i for i, name in enumerate(names) if not name.startswith("bump")]
        for label, index in (("smooth force over the state", smooth), ("force at places", list(range(len(names))))):
            gain, found, size = solve_gain(directions[:, index], residual, 1e-3)
            chance = float(chi2.sf(gain / noise, max(size, 1.0)))
            z = float("nan")
            if held_directions is not None and held_space is not None:
                moved = held_directions[:, index] @ found
                before = held_space.residual
                z = heldout_gain(before, before + moved)
            tests.append(Test(f"{label} at {joint}", gain, int(size), min(1.0, chance), z, (joint,)))
            full = np.zeros(len(names))
            full[index] = found
            coefficients[f"{label} at {joint}"] = (names, full * torque)
            if chance < level and (np.isnan(z) or z > 1.0):
                best_gain = max(best_gain, gain - size)
        gain, chance, where = _pulses(predictor, likelihood, fitted, space, histories, joint, torque, period, noise)
        tests.append(Test(f"a force that acts once at {joint}", gain, 1, chance, float("nan"), where))
        if chance < level:
            best_gain = max(best_gain, gain)
    significant = any(t.chance < level and (np.isnan(t.heldout_z) or t.heldout_z > 1.0) for t in tests)
    return Remains(significant, tuple(tests), best_gain, coefficients)


def heldout_gain(before: Array, after: Array) -> float:
    """Gain in cost on data not fitted to, in standard deviations of what the noise would do to it.

    With δ the change of the residual, the gain is Σ(r₀² − r₁²); its spread 2 (Σ_b (Σ_{t∈b} r₁ δ)²)^½ is taken over blocks b,
    so that correlated residuals count as such, and is at least that of white noise, 2|δ| (Vuong, Econometrica 57 (1989) 307).
    """
    delta = after - before
    gain = float(before @ before - after @ after)
    blocks = np.array_split(after * delta, max(8, min(40, len(delta) // 50)))
    spread = 2.0 * max(float(np.sqrt(sum(float(np.sum(b)) ** 2 for b in blocks))), float(np.linalg.norm(delta)))
    return gain / spread if spread > 0.0 else 0.0


def _block_variance(fitted: Fit) -> Array:
    out = []
    for r in fitted.linear.residuals:
        out += [float(np.mean(b[b != 0.0] ** 2)) if np.any(b != 0.0) else 1.0 for b in np.array_split(r, 20)]
    return np.array(out)


def _pulses(
    predictor: Predictor,
    likelihood: Likelihood,
    fitted: Fit,
    space: Nuisance,
    histories: dict[Window, tuple[Array, Array, Array]],
    joint: str,
    torque: float,
    period: float,
    noise: float,
) -> tuple[float, float, tuple[str, ...]]:
    """Largest gain by one pulse of force anywhere, its chance (all places counted), and where it acts."""
    best, count, where = 0.0, 0, ""
    for number, window in enumerate(fitted.windows):
        time = histories[window][0]
        width = PULSE * period
        centres = np.arange(0.5 * width, time[-1], 0.5 * width)
        if len(centres) == 0:
            continue
        pulses = PUSH * torque * np.exp(-(((time[None, :] - centres[:, None]) / (0.4 * width)) ** 2))
        change = np.nan_to_num(responses(predictor, likelihood, fitted, window, joint, pulses)) / PUSH
        parts = [
            change if w == window else np.zeros((len(centres), len(r)))
            for w, r in zip(fitted.windows, fitted.linear.residuals, strict=True)
        ]
        directions = space.project(parts)
        norms = np.linalg.norm(directions, axis=0)
        ok = norms > 1e-9
        gains = np.zeros(len(centres))
        gains[ok] = (directions[:, ok].T @ space.residual / norms[ok]) ** 2
        count += len(centres)
        top = int(np.argmax(gains))
        if gains[top] > best:
            best = float(gains[top])
            run = predictor.runs[window.run]
            at = centres[top] + run.time[window.first]
            where = f"{run.name} at {at:.2f} s"
        del number
    chance = min(1.0, count * float(chi2.sf(best / noise, 1)))
    return best, chance, (joint, where)
