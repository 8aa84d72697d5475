"""What a joint's effort can be made up of without anything outside: torques that any mechanism and any law of a joint could have.

From it the noise of an effort is known before any set of effects is fitted, and what something outside does shows beside it. A few
torques are always there; others (of each link's inertial numbers, laws of the joint) are taken in one at a time, as long as each
pays for itself by the extended Bayesian information criterion (Chen and Chen, Biometrika 95 (2008) 759), so that a short recording
is not explained by their number alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.denoc.model import Denoc
from harness.diagnose.conditioning.constants import ROBUST_SIGMA
from harness.diagnose.inverse.constants import (
    BREAKAWAY_RATIO,
    FALLING_SPEEDS,
    MOST_COGGING_WAVES,
    MOST_FURTHER_TORQUES,
    REWEIGHTING_ROUNDS,
    SAMPLE_DENSITY,
    SAMPLE_PERIODS,
    SETTLED_SPREAD,
    TUKEY_WIDTH,
)
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.inverse.nominal_torque import NominalRows
from harness.diagnose.problem.hypothesis import nominal_quantities
from harness.system import System

Array = NDArray[np.float64]

ORDINARY = 7  # columns that are always there
DRY = 4  # column of dry friction among the ordinary terms


def ordinary_terms(system: System, run: EffortRun, joint: int) -> Array:
    """Torques that any model of the mechanism could have at a joint, up to a factor each, before smoothing, shape (T, 7).

    Inertia, gravity and velocity-product torque of the nominal model, then viscous, dry, quadratic and constant torque.
    """
    model = Denoc(system)
    still, motion = np.zeros_like(run.q), run.qd
    gravity = model.inverse_dynamics_batch(run.q, still, still)
    moving = model.inverse_dynamics_batch(run.q, motion, still) - gravity
    inertia = model.inverse_dynamics_batch(run.q, still, run.qdd) - gravity
    v = motion[:, joint]
    terms = [
        inertia[:, joint],
        gravity[:, joint],
        moving[:, joint],
        v,
        run.direction[:, joint],
        v * np.abs(v),
        np.ones(len(v)),
    ]
    return np.stack(terms, axis=1)


def joint_terms(run: EffortRun, joint: int) -> Array:
    """Torques of laws that act at the joint alone, before smoothing, (T, m): a rotor's, springs', cogging's, breaking loose."""
    q, v, a = run.q[:, joint], run.qd[:, joint], run.qdd[:, joint]
    terms = [a, q, q**3]
    for k in range(1, MOST_COGGING_WAVES + 1):
        terms += [np.sin(k * q), np.cos(k * q)]
    terms += [np.exp(-((v / (f * run.still[joint])) ** 2)) * run.direction[:, joint] for f in FALLING_SPEEDS]
    return np.stack(terms, axis=1)


def link_terms(system: System, runs: Sequence[EffortRun]) -> list[Array]:
    """Of every run the torques that one more of each inertial number of a link takes, before smoothing, (T, numbers, n).

    Torques are linear in those numbers (Atkeson, An and Hollerbach, Int. J. Robotics Res. 5(3) (1986) 101). None where a system has
    no row of them.
    """
    if not NominalRows.fits(system):
        return [np.zeros((len(run.time), 0, run.q.shape[1])) for run in runs]
    rows = NominalRows(system, nominal_quantities(system))
    models = [rows.model.with_row(row) for row in rows.of_each_number()]
    return [np.stack([model.inverse_dynamics(run.q, run.qd, run.qdd) for model in models], axis=1) for run in runs]


@dataclass(frozen=True, eq=False)
class OrdinaryTorque:
    """What a joint's ordinary torques leave of its effort in every run, (T,) each.

    reach: standard deviations of what is left over those of the noise, (T,) each: one where the regression has looked, elsewhere
    the more the less a motion is like those that it has seen. dry: their level of dry friction [N·m]. foretold: the effort that
    they make up, before smoothing, in every run and then in others that the regression has not seen, (T,) each.
    """

    left: list[Array]
    reach: list[Array]
    dry: float
    foretold: list[Array]

    def surely(self, runs: Sequence[EffortRun], joint: int) -> list[Array]:
        """What is left less what dry friction may do while the joint turns about or breaks loose, and by as much smaller as it is
        less certain.
        """
        most = BREAKAWAY_RATIO * self.dry
        return [
            np.sign(rest) * np.maximum(np.abs(rest) - most * run.unsure[:, joint], 0.0) / reach
            for rest, reach, run in zip(self.left, self.reach, runs, strict=True)
        ]


def ordinary_torque(
    system: System, runs: Sequence[EffortRun], joint: int, links: Sequence[Array], unseen: Sequence[EffortRun] = ()
) -> OrdinaryTorque:
    """A robust regression of a joint's effort (Tukey's biweight, iteratively reweighted) on what pays of ordinary torques.

    runs: those with a recorded effort at the joint. unseen: others, whose efforts are foretold by what is found. links: the
    ``link_terms`` of both.
    """
    every_run = [*runs, *unseen]
    rough = [
        np.concatenate([ordinary_terms(system, run, joint), joint_terms(run, joint), own[:, :, joint]], axis=1)
        for run, own in zip(every_run, links, strict=True)
    ]
    whole = [run.smooth(table) for run, table in zip(runs, rough, strict=False)]
    step = max(1, round(SAMPLE_PERIODS / (runs[0].bandwidth * float(runs[0].time[1] - runs[0].time[0]))))
    every = max(1, step // SAMPLE_DENSITY)
    use = np.concatenate([run.usable[::every] for run in runs])
    seen = np.concatenate([w[::every] for w in whole])[use]
    target = np.concatenate([run.effort[::every, joint] for run in runs])[use]
    unsure = np.concatenate([run.unsure[::every, joint] for run in runs])[use]
    independent = max(len(target) * every / step, 2.0)
    size = np.sqrt(np.mean(seen**2, axis=0))
    there = size > 1e-9 * max(float(size.max()), 1e-300)
    seen = np.where(there, seen / np.where(there, size, 1.0), 0.0)
    chosen = [k for k in range(ORDINARY) if there[k]]
    further = [k for k in range(ORDINARY, len(size)) if there[k]]
    certain: Array = np.ones(len(target))
    found, spread, weight = _robust(seen[:, chosen], target, certain)
    for _ in range(MOST_FURTHER_TORQUES + 1):
        dry = abs(float(found[chosen.index(DRY)] / size[DRY])) if DRY in chosen else 0.0
        if spread <= 0.0:
            break
        certain = np.asarray(1.0 / (1.0 + (dry * unsure / spread) ** 2))
        found, spread, weight = _robust(seen[:, chosen], target, certain)
        best = _most(seen, target, weight, chosen, further, independent)
        if best is None or spread <= 0.0 or len(chosen) >= ORDINARY + MOST_FURTHER_TORQUES:
            break
        chosen.append(best)
        further.remove(best)
        found, spread, weight = _robust(seen[:, chosen], target, certain)
    dry = abs(float(found[chosen.index(DRY)] / size[DRY])) if DRY in chosen else 0.0
    foretold = [np.asarray(table[:, chosen] @ (found / size[chosen])) for table in rough]
    left = [run.effort[:, joint] - w[:, chosen] @ (found / size[chosen]) for run, w in zip(runs, whole, strict=True)]
    # The variance of a prediction is 1 + x (X' X)⁻¹ x' of the noise's; neighbours in X tell as much as one. X has all torques that
    # might have been chosen: which of them were says nothing of motions unlike those seen.
    inverse = np.linalg.pinv(np.linalg.qr(seen[:, there], mode="r"), rcond=1e-6)
    reach = [
        np.where(
            run.usable, 1.0, np.sqrt(1.0 + step / every * np.sum(((w[:, there] / size[there]) @ inverse) ** 2, axis=1))
        )
        for run, w in zip(runs, whole, strict=True)
    ]
    return OrdinaryTorque(left, reach, dry, foretold)


def _robust(columns: Array, target: Array, certain: Array) -> tuple[Array, float, Array]:
    """Coefficients, robust standard deviation of what is left, and weights."""
    weight = certain
    before, spread = np.inf, 0.0
    found: Array = np.zeros(columns.shape[1])
    for _ in range(REWEIGHTING_ROUNDS):
        root = np.sqrt(weight)
        found = np.asarray(np.linalg.lstsq(columns * root[:, None], target * root, rcond=1e-8)[0])
        left = (target - columns @ found) * np.sqrt(certain)
        spread = ROBUST_SIGMA * float(np.median(np.abs(left[certain > 0.5]))) if np.any(certain > 0.5) else 0.0
        if spread <= 0.0 or abs(spread - before) < SETTLED_SPREAD * spread:
            break
        before = spread
        weight = certain * np.maximum(1.0 - (left / (TUKEY_WIDTH * spread)) ** 2, 0.0) ** 2
    return found, spread, weight


def _most(
    seen: Array, target: Array, weight: Array, chosen: list[int], further: list[int], independent: float
) -> int | None:
    """The further column that explains most of what is left, if it pays for itself."""
    if not further:
        return None
    root = np.sqrt(weight)[:, None]
    basis, _ = np.linalg.qr(seen[:, chosen] * root)
    rest = target * root[:, 0]
    rest = rest - basis @ (basis.T @ rest)
    others = seen[:, further] * root
    before = np.einsum("ij,ij->j", others, others)
    others = others - basis @ (basis.T @ others)
    length = np.einsum("ij,ij->j", others, others)
    # What the chosen ones already tell but for rounding says nothing of its own.
    own = length > 1e-8 * before
    gain = np.where(own, (others.T @ rest) ** 2 / np.where(own, length, 1.0), 0.0)
    total, k = float(rest @ rest), int(np.argmax(gain))
    if total <= 0.0:
        return None
    count = independent * float(np.mean(weight))
    pays = count * float(-np.log(max(1.0 - gain[k] / total, 1e-300))) > np.log(max(count, 2.0)) + 2.0 * np.log(
        len(further)
    )
    return further[k] if pays else None
