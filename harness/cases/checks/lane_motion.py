"""The same motion in the lanes and in other engines."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import NATIVE, Bench, Row, Series
from harness.cases.checks.states import blame
from harness.cases.checks.trajectory import initial_state, step_of
from harness.denoc.lanes.model import LaneModel
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
            place, note = None, f"over {self.duration:g} s"
            if not far <= self.allowed:
                sample = int(np.argmax(~(apart.max(axis=1) <= self.allowed)))
                worst = int(np.argmax(np.nan_to_num(apart[sample], nan=np.inf)))
                place = {"time": float(time[sample]), "coordinate": bench.system.coordinate_names[worst]}
                note += f"; {self._blame(bench, name, run.position, run.velocity)}"
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

    def _blame(self, bench: Bench, name: str, q: np.ndarray, qd: np.ndarray) -> str:
        """Where the native equations of one mechanism are right, it is the lanes'."""
        chosen = np.unique(np.linspace(0, len(q) - 1, 8).round().astype(int))
        said = "" if name == NATIVE else blame(bench, name, q[chosen], qd[chosen], np.zeros_like(qd[chosen]))
        if said and "agree" not in said:
            return said
        return f"the equations of one mechanism agree, so it is the lanes ({'planar' if self.planar else 'spatial'})"
