"""The same chaotic motion in every engine, compared as far as it can be predicted."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Row, Series, thin
from harness.cases.checks.finer import finer, step_of
from harness.cases.checks.trajectory import initial_state, unit_of
from harness.compare.divergence_shape import course_of
from harness.compare.parting import Motion, parting
from harness.compare.trajectories import Difference, compare, horizon, separation
from harness.errors import UnsupportedError
from harness.system import Trajectory


@dataclass(frozen=True)
class ChaoticAgreement:
    """Difference of the joints' positions up to the measured horizon of predictability.

    The horizon is where two native runs whose initial positions differ by ``nudge`` [rad or m] have come ``allowed``
    apart: beyond it an engine whose integration error is as small as the nudge could not be told from a wrong one.
    position, velocity: initial state by coordinate name. duration [s], rate [Hz]; step [s] of fixed-step engines.
    """

    position: tuple[tuple[str, float], ...] = ()
    velocity: tuple[tuple[str, float], ...] = ()
    duration: float = 20.0
    rate: float = 100.0
    step: float | None = None
    nudge: float = 1e-9
    allowed: float = 1e-5
    quantity: str = "trajectory_to_horizon"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        if NATIVE not in bench.models:
            return
        q0, qd0 = initial_state(bench.system, dict(self.position), dict(self.velocity))
        time = np.linspace(0.0, self.duration, round(self.duration * self.rate) + 1)
        native = bench.models[NATIVE]
        reach = horizon(native, q0, qd0, time, allowed=self.allowed, nudge=self.nudge, seed=bench.seed)
        # Beyond the horizon a while is enough to see the engines part.
        shown = time <= reach.until + max(2.0, reach.until)
        time = time[shown]
        ours = native.simulate(q0, qd0, time)
        reach = replace(reach, separation=reach.separation[shown])
        yield self._line(bench, f"denoc, nudged by {self.nudge:g}", time, reach.separation, reach.until)
        unit = unit_of(bench.system, list(bench.system.joint_names))
        for name, model in bench.peers():
            try:
                run = model.simulate(q0, qd0, time, step=step_of(name, self.step))
            except UnsupportedError as error:
                yield bench.skipped(self.quantity, (NATIVE, name), str(error))
                continue
            found = compare(ours, run, self.allowed, until=reach.until)
            place, said = self._parted(bench, name, ours, run, found)
            yield bench.row(
                self.quantity,
                (NATIVE, name),
                found.largest,
                self.allowed,
                unit=unit,
                why=f"a nudge of {self.nudge:g} {unit} grows to this by the horizon; integration errors do the same",
                note="; ".join(filter(None, [reach.sentence(), said])),
                first_divergence=place,
            )
            _, apart = separation(ours, run)
            yield self._line(bench, name, time, apart.max(axis=1), reach.until)

    def _parted(
        self, bench: Bench, name: str, ours: Trajectory, run: Trajectory, found: Difference
    ) -> tuple[dict[str, object] | None, str]:
        """Where and how an engine parts within the horizon, and whether that is its model or how it is integrated."""
        if found.first is None:
            return None, ""
        start = initial_state(bench.system, dict(self.position), dict(self.velocity))
        names = [joint for joint in ours.position_names if joint in run.position_names]
        within = ours.time <= found.until

        def motion_of(engine: str, motion: Trajectory) -> Motion:
            again = finer(bench.system, engine, bench.models[engine], *start, motion, step_of(engine, self.step))
            return Motion.of(engine, motion, again, names).until(within)

        time, first, second = ours.time[within], motion_of(NATIVE, ours), motion_of(name, run)
        parted = parting(time, first, second, self.allowed)
        column = names.index(found.first.coordinate)
        course = course_of(time, first.position[:, column], second.position[:, column], parted.begins)
        return {**asdict(found.first), **parted.place(time), **course}, parted.words

    def _line(self, bench: Bench, label: str, time: Array, difference: Array, horizon: float) -> Series:
        # What is exactly equal has no place on a logarithmic axis.
        shown = np.where((difference > 0.0) & np.isfinite(difference), difference, np.nan)
        return Series(
            bench.case.name,
            "divergence",
            label,
            thin(time),
            thin(shown),
            "time [s]",
            f"difference [{unit_of(bench.system, list(bench.system.joint_names))}]",
            title=bench.case.title,
            style="dashed" if "nudged" in label else "line",
            log="y",
            marks={"horizon": horizon},
        )
