"""What a set leaves of recorded efforts that is more than noise: tests, one function each, of every joint that is driven."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm
from scipy.stats import f as fisher

from harness.diagnose.criticism.constants import COMPLETE_RESIDUAL_RATIO, SLOW_NOISE_RATIO
from harness.diagnose.inverse.band import motion_noise
from harness.diagnose.inverse.constants import (
    HELD_OUT_RATIO,
    SHAPE_CHANCE,
    SHAPE_SHARE,
    SHAPES_DEPENDENT,
    SURELY_OFF_SIGMAS,
)
from harness.diagnose.inverse.effort_fit import EffortData, EffortFit
from harness.diagnose.inverse.effort_motion import EffortRun
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.inverse.effort_words import ONCE
from harness.diagnose.inverse.pushes import Push
from harness.effects.scale import references
from harness.recording.clean import quantisation_step
from harness.recording.differences import white_noise
from harness.recording.recording import Recording
from harness.recording.units import written
from harness.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Asked:
    """What the tests of one joint look at. floor, held: root mean square left of the training data and of those held out; scatter:
    what the sensors' own scatter from sample to sample leaves there.
    """

    system: System
    study: EffortStudy
    best: EffortFit
    joint: int
    floor: float
    held: float
    scatter: float

    @property
    def name(self) -> str:
        return self.system.joint_names[self.joint]

    @property
    def noise(self) -> float:
        return self.study.data.noises[self.joint].std


def tests_of(
    system: System, recordings: Sequence[Recording], study: EffortStudy, best: EffortFit, pushes: Sequence[Push]
) -> list[dict[str, Any]]:
    """Every test that counts, as the document has it."""
    out: list[dict[str, Any]] = []
    for j in study.data.joints:
        asked = _Asked(
            system, study, best, j, root_mean_square(study.data, best, j), root_mean_square(study.held, best, j),
            scatter_of(system, recordings, j, study.data.model.runs[0].bandwidth),
        )  # fmt: skip
        out += [row for test in TESTS for row in test(asked)]
    for push in pushes:
        joint = system.joint(system.joint_names[push.joint])
        where = (
            f"{recordings[push.run].name}, {push.first:.2f} to {push.last:.2f} s, up to {-push.peak:+.2g} "
            + written(joint.force_unit)
        )
        gain = (push.peak / study.data.noises[push.joint].std) ** 2
        out.append(_row(f"a force that {ONCE} at {joint.name}", gain, 0.0, joint.name, where))
    return out


def root_mean_square(data: EffortData, fitted: EffortFit, joint: int) -> float:
    """What a fit leaves of a joint's effort [N·m or N]; nan where none is compared."""
    values = _plain(data, fitted, joint)
    return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")


def _smooth_force(asked: _Asked) -> Iterator[dict[str, Any]]:
    """A smooth force over the state of the joint that no ordinary torque has, by Fisher's F."""
    data, j = asked.study.data, asked.joint
    residuals = data.model.residuals(asked.best.hypothesis, asked.best.x)
    shapes, left = [], []
    for run, grid, residual in zip(data.model.runs, data.grids, residuals, strict=True):
        for s in grid.stretches:
            if run.driven[j]:
                shapes.append(_shapes(run, j, s))
                left.append(residual[s, j])
    design, target = np.concatenate(shapes), np.concatenate(left)
    total = float(target @ target)
    rest = target - design @ np.linalg.lstsq(design, target, rcond=SHAPES_DEPENDENT)[0]
    explained = total - float(rest @ rest)
    dof = len(target) - design.shape[1] - len(asked.best.x)
    ratio = (explained / design.shape[1]) / max(float(rest @ rest) / max(dof, 1), 1e-300)
    chance = float(fisher.sf(ratio, design.shape[1], max(dof, 1)))
    if chance < SHAPE_CHANCE and explained > SHAPE_SHARE * total:
        yield _row(f"a smooth force over the state at {asked.name}", explained / asked.noise**2, chance, asked.name)


def _held_out(asked: _Asked) -> Iterator[dict[str, Any]]:
    """Data held out that are predicted worse than those fitted."""
    study, held, floor = asked.study, asked.held, asked.floor
    parts = [_plain(data, asked.best, asked.joint) for data in (study.held, study.data)]
    unsure = float(np.linalg.norm([_unsureness(part) for part in parts]))
    z = float(np.log(held / floor)) / unsure if floor > 0.0 and unsure > 0.0 else 0.0
    if held > HELD_OUT_RATIO * floor and z > SURELY_OFF_SIGMAS:
        count = max(study.held.samples, 2)
        yield _row(
            "a worse fit of the data held out", (held / floor) ** 2 * count - count, float(norm.sf(z)),
            f"{held / floor:.2f} times the training data's residual",
        )  # fmt: skip


def _louder(asked: _Asked) -> Iterator[dict[str, Any]]:
    """More than the noise, which is what the most that ordinary torques can take leaves."""
    ratio = asked.floor / asked.noise
    if ratio > COMPLETE_RESIDUAL_RATIO:
        yield _beyond("more than the noise of the effort", ratio, asked, f"{ratio:.2f} times it at {asked.name}")


def _slower(asked: _Asked) -> Iterator[dict[str, Any]]:
    """What ordinary torques cannot take passes for noise, however slow it is: beside sensors that scatter far less it is none."""
    ratio = asked.floor / asked.scatter if asked.scatter > 0.0 else 1.0
    if ratio > SLOW_NOISE_RATIO:
        where = f"{ratio:.2g} times what it leaves at {asked.name}"
        yield _beyond("slower than the sensors' scatter", ratio, asked, where)


def _beyond(what: str, ratio: float, asked: _Asked, where: str) -> dict[str, Any]:
    """What is left, so many times as large as it should be: gain and chance by χ² of as many samples as there are."""
    count = max(asked.study.data.samples, 1.0)
    return _row(what, (ratio**2 - 1.0) * count, float(chi2.sf(ratio**2 * count, count)), where)


def scatter_of(system: System, recordings: Sequence[Recording], joint: int, bandwidth: float) -> float:
    """Standard deviation of a joint's effort in the band, by its own scatter and that of the angles behind it [N·m or N].

    White noise of σ at intervals Δt leaves σ √(2 f Δt) below f; that of angles comes through the inertia.
    """
    name, powers = system.joint_names[joint], list[float]()
    inertia = float(references(system, name).inertia)
    for recording in recordings:
        own = next((c for c in recording.efforts if c.site == name), None)
        if own is None:
            continue
        good = np.isfinite(own.values)
        time, values = recording.time[good], own.values[good]
        white = max(white_noise(time, values), quantisation_step(values) / np.sqrt(12.0))
        shaken = sum(motion_noise(recording, other, bandwidth, 2) ** 2 for other in system.joint_names)
        powers.append(white**2 * 2.0 * bandwidth * recording.interval + inertia**2 * shaken)
    return float(np.sqrt(np.mean(powers))) if powers else 0.0


def _stretched(asked: _Asked) -> Iterator[dict[str, Any]]:
    """Nominal quantities outside their tolerance."""
    nominal = asked.best.x[: asked.study.nominal]
    if not len(nominal):
        return
    worst = int(np.argmax(np.abs(nominal)))
    if abs(nominal[worst]) > SURELY_OFF_SIGMAS:
        quantity = asked.study.data.model.nominal[worst]
        yield _row(
            "nominal quantities outside their tolerance", asked.best.prior, float(2.0 * norm.sf(abs(nominal[worst]))),
            f"{quantity.kind} of {quantity.name} by {nominal[worst]:+.1f} of its σ",
        )  # fmt: skip


TESTS: tuple[Callable[[_Asked], Iterator[dict[str, Any]]], ...] = (
    _smooth_force,
    _held_out,
    _louder,
    _slower,
    _stretched,
)


def _row(what: str, gain: float, chance: float, *where: str) -> dict[str, Any]:
    return {"what": what, "gain": gain, "chance": chance, "heldout_sigma": None, "where": list(where)}


def _plain(data: EffortData, fitted: EffortFit, joint: int) -> Array:
    return data.plain(data.model.residuals(fitted.hypothesis, fitted.x), joint)


def _unsureness(values: Array) -> float:
    """Standard deviation of the logarithm of the values' root mean square, heavy tails (reversals) counted."""
    power = values**2
    return 0.5 * float(np.std(power)) / (float(np.mean(power)) * float(np.sqrt(len(power)))) if power.any() else 0.0


def _shapes(run: EffortRun, j: int, s: NDArray[np.intp]) -> Array:
    """Smooth forces over the state of a joint that no ordinary torque has, shape (len(s), 8)."""
    q, v, a = run.q[s, j], run.qd[s, j], run.qdd[s, j]
    fast, quick = max(float(np.abs(run.qd[:, j]).max()), 1e-12), max(float(np.abs(run.qdd[:, j]).max()), 1e-12)
    w, b = v / fast, a / quick
    return np.stack(
        [np.cos(q), np.sin(2.0 * q), np.cos(2.0 * q), w * np.sin(q), w**2, w**3, w * b, b * np.abs(b)], axis=1
    )
