"""The same chaotic motion in every engine, compared as far as it can be predicted."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Row, Series, thin
from harness.cases.checks.trajectory import initial_state, pick, step_of, unit_of
from harness.errors import UnsupportedError


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
        ours = native.simulate(q0, qd0, time)
        nudged = native.simulate(q0 + self.nudge, qd0, time)
        twin = apart(pick(ours, bench.system, "position"), pick(nudged, bench.system, "position"))
        beyond = twin > self.allowed
        last = int(np.argmax(beyond)) if beyond.any() else len(time) - 1
        horizon = float(time[last])
        growth = lyapunov(time[: last + 1], twin[: last + 1])
        yield self._line(bench, f"denoc, nudged by {self.nudge:g}", time, twin, horizon)
        unit = unit_of(bench.system, list(bench.system.joint_names))
        for name, model in bench.peers():
            try:
                run = model.simulate(q0, qd0, time, step=step_of(name, self.step))
            except UnsupportedError as error:
                yield bench.skipped(self.quantity, (NATIVE, name), str(error))
                continue
            difference = apart(pick(ours, bench.system, "position"), pick(run, bench.system, "position"))
            inside = difference[: last + 1]
            largest = float(inside.max()) if np.isfinite(inside).all() else float("nan")
            left = ~(inside <= self.allowed)
            yield bench.row(
                self.quantity,
                (NATIVE, name),
                largest,
                self.allowed,
                unit=unit,
                why=f"a nudge of {self.nudge:g} {unit} grows to this by the horizon; integration errors do the same",
                note=f"chaotic: compared up to the measured horizon of {horizon:.1f} s of {self.duration:g} s "
                f"(divergence {growth:.1f} 1/s)",
                first_divergence={"time": float(time[int(np.argmax(left))])} if left.any() else None,
            )
            yield self._line(bench, name, time, difference, horizon)

    def _line(self, bench: Bench, label: str, time: Array, difference: Array, horizon: float) -> Series:
        # What is exactly equal has no place on a logarithmic axis.
        shown = np.where(difference > 0.0, difference, np.nan)
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


def apart(a: dict[str, Array], b: dict[str, Array]) -> Array:
    """Largest difference over the signals at each sample, shape (T,)."""
    return np.max([np.abs(a[key] - b[key]) for key in a], axis=0)


def lyapunov(time: Array, difference: Array) -> float:
    """Slope of the logarithm of a difference over time [1/s], by least squares; 0 if there is nothing to fit."""
    good = difference > 0.0
    if good.sum() < 3:
        return 0.0
    return float(np.polyfit(time[good], np.log(difference[good]), 1)[0])
