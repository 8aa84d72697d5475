"""The same motion in the lanes and in other engines."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import NATIVE, Bench, Row, Series
from harness.cases.checks.equation_blame import Told, blamed, explained_by, weight_told_apart
from harness.cases.checks.finer import step_of
from harness.cases.checks.trajectory import initial_state
from harness.compare.attribution import attribute
from harness.compare.divergence_shape import left_line
from harness.compare.lane_accelerations import LANES, of_lanes
from harness.denoc.lanes.model import LaneModel
from harness.engines.protocol import EngineError
from harness.errors import UnsupportedError


@dataclass(frozen=True)
class LaneAgreement:
    """Largest difference of the coordinates between a copy in the lanes and each engine's run.

    allowed [rad or m], why. planar: by which recursion. method: of ``LaneModel.simulate``; lane_step [s] for it, step [s] of
    engines with a fixed one. position, velocity: initial state by coordinate. Nine copies run, and the last one is looked
    at, so that it stands in a group of eight that is not full; against_single: with the native run of one mechanism alone.
    """

    allowed: float
    why: str
    planar: bool = False
    method: str = "adaptive"
    lane_step: float | None = None
    position: tuple[tuple[str, float], ...] = ()
    velocity: tuple[tuple[str, float], ...] = ()
    duration: float = 1.0
    rate: float = 100.0
    step: float | None = None
    against_single: bool = False

    @property
    def quantity(self) -> str:
        return f"lanes_{self.method}_{'planar' if self.planar else 'spatial'}"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        q0, qd0 = initial_state(bench.system, dict(self.position), dict(self.velocity))
        time = np.linspace(0.0, self.duration, round(self.duration * self.rate) + 1)
        lanes = LaneModel(bench.system, planar=self.planar)
        copies = np.linspace(0.0, 1.0, 9)[:, None]
        found, _, _ = lanes.simulate(
            lanes.row(), copies * q0, copies * qd0, time, method=self.method, step=self.lane_step
        )
        ours = found[-1]
        for name, model in bench.models.items():
            if (name == NATIVE) != self.against_single:
                continue
            try:
                run = model.simulate(q0, qd0, time, step=step_of(name, self.step))
            except UnsupportedError as error:
                yield bench.skipped(self.quantity, (NATIVE, name), str(error))
                continue
            apart = np.abs(ours - run.position)
            far = float(apart.max()) if np.isfinite(apart).all() else float("nan")
            place: dict[str, object] | None = None
            note = f"over {self.duration:g} s"
            if not far <= self.allowed:
                place = left_line(time, bench.system.coordinate_names, ours, run.position, self.allowed)
                said, where = self._blame(bench, name, lanes, run.position, run.velocity)
                note, place = f"{note}; {said}", {**(place or {}), **where}
            yield bench.row(
                self.quantity,
                (NATIVE, "denoc single run" if name == NATIVE else name),
                far,
                self.allowed,
                unit="rad",
                why=self.why,
                note=note,
                first_divergence=place,
            )

    def _blame(
        self, bench: Bench, name: str, lanes: LaneModel, q: np.ndarray, qd: np.ndarray
    ) -> tuple[str, dict[str, object]]:
        """Where the native equations of one mechanism are right, it is the lanes': their term, or how they are integrated."""
        chosen = np.unique(np.linspace(0, len(q) - 1, 8).round().astype(int))
        q, qd = q[chosen], qd[chosen]
        told = Told() if name == NATIVE else blamed(bench, name, q, qd, np.zeros_like(qd))
        if told.words:
            return told.words, told.place
        lane = f"the equations of one mechanism agree, so it is the lanes ({'planar' if self.planar else 'spatial'})"
        said, place = in_lanes(bench, lanes, q, qd)
        return "; ".join(filter(None, [lane, said])), place


def in_lanes(bench: Bench, lanes: LaneModel, q: np.ndarray, qd: np.ndarray) -> tuple[str, dict[str, object]]:
    """The term in which the lanes accelerate otherwise than the native equations of one mechanism, and where; q, qd: shape (B, n).

    Nothing where that cannot be told: at closed loops, whose accelerations are not free, and under dry friction, which sticks.
    """
    if bench.system.loops or any(joint.friction for joint in bench.system.joints):
        return "", {}
    native = bench.models[NATIVE]
    theirs = of_lanes(lanes, native)
    # Forces that have nothing to do with the motion, so that no term can hide in its balance.
    rng = np.random.default_rng(bench.seed)
    tau = np.array([native.mass_matrix(x) @ a for x, a in zip(q, rng.standard_normal(qd.shape), strict=True)])
    try:
        found = attribute(native, theirs, q, qd, tau, called=("the single model", LANES), derived=True)
        if not found.blames:
            return "their accelerations agree, so it is how they are integrated", {"term": "integration"}
        found = weight_told_apart(found, theirs, bench.system, q)
        culprit = found.blames[0]
        place: dict[str, object] = {"term": culprit.term, "at": culprit.coordinate}
        numbers = explained_by(bench.system, theirs, q, qd, bench.seed)
    except (UnsupportedError, EngineError, np.linalg.LinAlgError):
        return "", {}
    if numbers:
        place |= numbers[0].place
    return "; ".join(filter(None, [" or ".join(one.sentence() for one in numbers), found.sentence()])), place
