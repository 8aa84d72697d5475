"""What a strong practitioner does in an afternoon: SciPy's least squares on free runs, a handful of laws, choice by
data held out.

Freed at every joint are its inertia (a factor), viscous damping, smoothed dry friction, drag over speed squared and the
zero of the angle (a constant force where gravity does not tell the angle); where the rig is driven, a factor on gravity
too, as two of inertia, gravity and torque then show. Runs, or windows of them, have initial states of their own, fitted
beside the laws. From several starts, with short windows first, which keeps long runs out of the valleys where they lose
count of the swings. Which of the three laws of dissipation stay is chosen on recordings held out: the fewest that
predict them as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import norm

from harness.compare.peers.runs import ways
from harness.proof.peers.afternoon_motion import Law, Motion
from harness.proof.peers.runs import Run, as_run, finding
from harness.system import System

Array = NDArray[np.float64]

LAWS = ("viscous", "dry", "drag")
Laws = tuple[str, ...]
LeftOut = Sequence[Sequence[tuple[float, float]]]
SETS: tuple[Laws, ...] = tuple(s for size in range(len(LAWS) + 1) for s in combinations(LAWS, size))
SOFT = 0.005  # of the largest speed: where dry friction is smoothed
FIRST_WINDOW = 2.0  # s, of the windows that are fitted first
AS_GOOD = 1.02  # error held out, times the best: where fewer laws do as well
ROUNDS = 40


@dataclass(frozen=True, eq=False)
class Fitted:
    """What was fitted.

    values, std: by ``joint:parameter``, SI (factors for inertia and gravity). rmse: of the free runs fitted, positions
    [rad or m]. heldout: the same of the runs that the laws were chosen on, their first states fitted; nan if none was.
    """

    motion: Motion
    law: Law
    laws: tuple[str, ...]
    values: Mapping[str, float]
    std: Mapping[str, float]
    rmse: float
    heldout: float
    held: bool

    def free_run(self, state: Array, time: Array, tau: Array | None) -> Array:
        """Positions (T, n) from a state as it reads (2n,)."""
        return self.motion.run(self.law, state, time, tau, held=self.held)


class Practitioner:
    """Fits of one rig.

    runs: recordings to fit. left_out: stretches of each that no model can run through [s]. window: length of the free
    runs [s]; None: whole recordings. held: whether efforts stay from sample to sample; None: whichever fits better.
    """

    def __init__(
        self,
        system: System,
        runs: Sequence[Run],
        *,
        left_out: Sequence[Sequence[tuple[float, float]]] = (),
        window: float | None = None,
        held: bool | None = False,
    ) -> None:
        self.joints, self.system = system.joint_names, system
        self.motion = Motion(system)
        gaps = left_out or [()] * len(runs)
        self.windows = [w.thinned() for r, g in zip(runs, gaps, strict=True) for w in r.cut(window, g)]
        short = FIRST_WINDOW if window is None else min(window, FIRST_WINDOW)
        self.short = [w.thinned() for r, g in zip(runs, gaps, strict=True) for w in r.cut(short, g)]
        self.ways = ways(runs, held)
        self.driven = any(r.driven for r in runs)
        speeds = [np.abs(np.diff(r.positions, axis=0) / np.diff(r.time)[:, None]) for r in self.short]
        self.fastest = np.max([np.quantile(s, 0.999, axis=0) for s in speeds], axis=0)
        self.spread = np.maximum(np.std(np.concatenate([r.positions for r in self.short]), axis=0), 1e-9)
        pull = np.hypot(self.motion.cosine, self.motion.sine)
        pushes = [np.sqrt(np.mean(r.efforts**2, axis=0)) for r in runs if r.efforts is not None]
        self.force = np.maximum(pull, np.max(pushes, axis=0) if pushes else 0.0)
        self.force = np.where(self.force > 0.0, self.force, self.motion.inertia * self.fastest)
        # The zero of an angle shows through gravity alone.
        self.tilts = pull > 1e-6 * self.force

    def _names(self, laws: Sequence[str]) -> list[tuple[str, int]]:
        names = [(what, k) for k in range(len(self.joints)) for what in ("inertia", *laws)]
        names += [("zero" if tilts else "constant", k) for k, tilts in enumerate(self.tilts)]
        return names + ([("gravity", 0)] if self.driven and np.any(self.tilts) else [])

    def _scale(self, what: str, k: int) -> float:
        """Size of a parameter that would matter, by which all are divided."""
        if what in ("inertia", "gravity"):
            return 1.0
        if what == "zero":
            return 0.1
        return float(self.force[k] / {"viscous": self.fastest[k], "drag": self.fastest[k] ** 2}.get(what, 1.0))

    def _bounds(self, what: str) -> tuple[float, float]:
        """In units of the scale."""
        return {"inertia": (0.2, 5.0), "gravity": (0.2, 5.0)}.get(
            what, (-3.0, 3.0) if what in ("zero", "constant") else (0.0, 10.0)
        )

    def _law(self, names: Sequence[tuple[str, int]], x: Array) -> Law:
        n = len(self.joints)
        parts = {what: np.zeros(n) for what in ("viscous", "dry", "drag", "zero", "constant")}
        inertia, gravity = np.ones(n), 1.0
        for (what, k), value in zip(names, x, strict=True):
            if what == "inertia":
                inertia[k] = value
            elif what == "gravity":
                gravity = float(value)
            else:
                parts[what][k] = value * self._scale(what, k)
        return Law(inertia=inertia, gravity=gravity, soft=SOFT * self.fastest, **parts)

    def _starts(self, names: Sequence[tuple[str, int]]) -> Iterator[Array]:
        """As published; little of everything; mostly dry; mostly viscous. None on a bound, where a gradient may see
        nothing."""
        for viscous, dry, drag in ((None, 1e-3, 1e-3), (1e-3, 1e-3, 1e-3), (1e-3, 3e-2, 1e-2), (3e-2, 1e-3, 1e-3)):
            x = []
            for what, k in names:
                if what in ("inertia", "gravity"):
                    x.append(1.0)
                elif what in ("zero", "constant"):
                    x.append(0.0)
                elif what == "viscous" and viscous is None:
                    x.append(max(self.system.joint(self.joints[k]).damping / self._scale(what, k), 1e-4))
                else:
                    x.append({"viscous": viscous, "dry": dry, "drag": drag}[what] or 1e-4)
            yield np.array(x)

    def _fit(
        self, law_of: Callable[[Array], Law], x: Array, bounds: Array, windows: Sequence[Run], held: bool, rounds: int
    ) -> tuple[Array, Array, Array]:
        """Parameters, residuals, and their Jacobian over parameters then first states, in units of the spread.

        Forward differences; a first state moves nothing but its own window, so that all windows' states are moved at
        once.
        """
        n, p = len(self.joints), len(x)
        lows, highs = bounds
        states = np.array([w.first_state() for w in windows])
        state_scale = np.r_[self.spread, self.fastest]
        rows = np.cumsum([0, *(w.positions.size for w in windows)])

        def runs(law: Law, s: Array) -> Array:
            found = [
                (
                    (self.motion.run(law, s[k] * state_scale, w.time, w.efforts, held=held) - w.positions) / self.spread
                ).ravel()
                for k, w in enumerate(windows)
            ]
            return np.nan_to_num(np.clip(np.concatenate(found), -1e3, 1e3), nan=1e3)

        def apart(y: Array) -> tuple[Array, Array]:
            return y[:p], y[p:].reshape(len(windows), 2 * n)

        def misfit(y: Array) -> Array:
            return runs(law_of(y[:p]), apart(y)[1])

        def slopes(y: Array) -> Array:
            x, s = apart(y)
            base = misfit(y)
            jacobian = np.zeros((len(base), len(y)))
            for k in range(p):
                moved = x.copy()
                step = 1e-6 * max(1.0, abs(x[k]))
                moved[k] += step if x[k] + step <= highs[k] else -step
                jacobian[:, k] = (runs(law_of(moved), s) - base) / (moved[k] - x[k])
            law = law_of(x)
            for k in range(2 * n):
                moved = s.copy()
                moved[:, k] += 1e-6
                change = (runs(law, moved) - base) / 1e-6
                for w in range(len(windows)):
                    jacobian[rows[w] : rows[w + 1], p + 2 * n * w + k] = change[rows[w] : rows[w + 1]]
            return jacobian

        low = np.r_[lows, np.full(states.size, -np.inf)]
        high = np.r_[highs, np.full(states.size, np.inf)]
        y = np.r_[np.clip(x, lows + 1e-9, highs - 1e-9), (states / state_scale).ravel()]
        found = least_squares(misfit, y, slopes, bounds=(low, high), x_scale="jac", max_nfev=rounds)
        return found.x[:p], found.fun, found.jac

    def _rmse(self, residual: Array) -> float:
        """In the channels' own unit, over all joints together."""
        scaled = residual.reshape(-1, len(self.joints)) * self.spread
        return float(np.sqrt(np.mean(scaled**2)))

    def fit(self, laws: Sequence[str] = LAWS, near: Fitted | None = None) -> Fitted:
        """With these laws of dissipation, from every start; the best end. near: a fit with more laws, begun from
        instead."""
        names = self._names(laws)
        bounds = np.array([self._bounds(what) for what, _ in names]).T
        law_of = partial(self._law, names)
        best: tuple[Array, Array, Array] | None = None
        best_held = False
        tried = self.ways if near is None else (near.held,)
        ends: list[Array] = []
        for start in self._starts(names) if near is None else [self._like(names, near)]:
            close, *_ = self._fit(law_of, start, bounds, self.short, tried[0], ROUNDS // 2)
            if any(np.allclose(close, other, rtol=1e-3, atol=1e-4) for other in ends):
                continue
            ends.append(close)
            for held in tried:
                found = self._fit(law_of, close, bounds, self.windows, held, ROUNDS)
                if best is None or float(found[1] @ found[1]) < float(best[1] @ best[1]):
                    best, best_held = found, held
        assert best is not None
        x, residual, jacobian = best
        law = law_of(x)
        variance = float(residual @ residual) / max(residual.size - jacobian.shape[1], 1)
        covariance = np.linalg.pinv(jacobian.T @ jacobian) * variance
        std = np.sqrt(np.maximum(np.diag(covariance), 0.0))[: len(names)]
        labels = [f"{self.joints[k]}:{what}" if what != "gravity" else what for what, k in names]
        scales = np.array([self._scale(what, k) for what, k in names])
        return Fitted(
            self.motion, law, tuple(laws), dict(zip(labels, map(float, x * scales), strict=True)),
            dict(zip(labels, map(float, std * scales), strict=True)), self._rmse(residual), float("nan"), best_held,
        )  # fmt: skip

    def _like(self, names: Sequence[tuple[str, int]], other: Fitted) -> Array:
        """Where another fit is, in units of the scale, what it has at nothing a little off its bound."""
        at = [other.values["gravity" if what == "gravity" else f"{self.joints[k]}:{what}"] for what, k in names]
        scaled = np.array(at) / np.array([self._scale(what, k) for what, k in names])
        return np.array([max(x, 1e-4) if what in LAWS else x for x, (what, _) in zip(scaled, names, strict=True)])

    def predicts(
        self, fitted: Fitted, heldout: Sequence[Run], window: float | None = None, left_out: LeftOut = ()
    ) -> float:
        """Error of free runs over recordings not fitted to, their first states fitted [rad or m]."""
        gaps = left_out or [()] * len(heldout)
        windows = [w.thinned() for r, g in zip(heldout, gaps, strict=True) for w in r.cut(window, g)]
        none = np.zeros((2, 0))
        _, residual, _ = self._fit(lambda _: fitted.law, np.zeros(0), none, windows, fitted.held, ROUNDS)
        return self._rmse(residual)

    def every(self, heldout: Sequence[Run], window: float | None = None, left_out: LeftOut = ()) -> dict[Laws, Fitted]:
        """Fits with each subset of the laws, and how each predicts the runs held out."""
        full = self.fit(LAWS)
        fits = [full if laws == LAWS else self.fit(laws, full) for laws in SETS]
        return {f.laws: replace(f, heldout=self.predicts(f, heldout, window, left_out)) for f in fits}

    def choose(self, heldout: Sequence[Run]) -> Fitted:
        """The fewest laws that predict the runs held out as well as the best set does."""
        fits = self.every(heldout)
        return fits[fewest({laws: f.heldout for laws, f in fits.items()})]


def fewest(errors: Mapping[Laws, float]) -> Laws:
    """The smallest set of laws whose error is within ``AS_GOOD`` of the least."""
    least = min(errors.values())
    return next(s for s in sorted(errors, key=lambda s: (len(s), errors[s])) if errors[s] <= AS_GOOD * least)


WHAT = {"viscous": "viscous_damping", "dry": "coulomb_friction", "drag": "quadratic_drag", "zero": "sensor_offset"}


def practitioner_claims(folder: Path) -> dict[str, Any]:
    """What a folder with ``model.toml`` and ``run*.csv`` is said to lack: laws that were kept and zeros, where 95 % for
    all of them together leave the nominal value out."""
    import harness
    from harness.recording import read_recordings

    system = harness.load(folder / "model.toml")
    runs = [as_run(system, r) for r in read_recordings(sorted(folder.glob("run*.csv")), system=system)]
    found = Practitioner(system, runs[:-1], held=None).choose(runs[-1:])
    asked = [name for name in found.values if name.split(":")[-1] in WHAT]
    wide = float(norm.ppf(1.0 - 0.025 / max(len(asked), 1)))
    findings = []
    for name in asked:
        joint, what = name.split(":")
        stated = {"viscous": system.joint(joint).damping, "dry": system.joint(joint).friction}.get(what, 0.0)
        if abs(found.values[name] - stated) > wide * found.std[name] > 0.0:
            findings.append(finding(WHAT[what], joint, found.values[name] - stated, 1.96 * found.std[name]))
    return {
        "findings": findings, "laws": found.laws, "values": dict(found.values), "std": dict(found.std), "train_rmse": found.rmse,
        "heldout_rmse": found.heldout,
    }  # fmt: skip
