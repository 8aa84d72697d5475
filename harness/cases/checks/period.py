"""Period of a pendulum's large swing against the complete elliptic integral."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.special import ellipk

from harness.cases.case import Array, Bench, Row, Series
from harness.errors import UnsupportedError
from harness.system import Trajectory

TRUTH = "analytic"
CITES = "T/T0 = (2/π) K(sin(A/2)), complete elliptic integral of the first kind; Landau & Lifshitz, Mechanics, §11"


def period_ratio(amplitude: float) -> float:
    """T/T0 of a pendulum swinging with the amplitude [rad]."""
    return float(2.0 / np.pi * ellipk(np.sin(0.5 * amplitude) ** 2))


def period(trajectory: Trajectory, column: int = 0, rest: float = 0.0) -> float:
    """Mean period [s] between rising passages through ``rest``; nan if there are fewer than two.

    The sampled position and velocity make a cubic Hermite spline, whose roots are exact to O(h⁴).
    """
    found = passages(trajectory.time, trajectory.position[:, column] - rest, trajectory.velocity[:, column])
    rising = found[found[:, 1] > 0.0, 0]
    return float((rising[-1] - rising[0]) / (len(rising) - 1)) if len(rising) > 1 else float("nan")


def passages(time: Array, position: Array, velocity: Array) -> Array:
    """Passages through zero: rows of time [s] and velocity there, shape (k, 2)."""
    spline = CubicHermiteSpline(time, position, velocity)
    roots = spline.roots(extrapolate=False)
    return np.column_stack([roots, spline(roots, 1)])


@dataclass(frozen=True)
class PeriodTruth:
    """Relative difference between the simulated period and T0 · (2/π) K(sin(A/2)), one row an engine.

    joint: the pendulum's joint. rest: its position hanging straight down [rad]. small: T0 [s], period of
    vanishing swings. amplitudes [deg]. periods: how many are simulated.
    """

    joint: str
    small: float
    amplitudes: tuple[float, ...]
    allowed: float
    why: str
    rest: float = 0.0
    periods: float = 2.3
    samples: int = 400
    quantity: str = "period"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        names = list(bench.system.coordinate_names)
        column = names.index(self.joint)
        amplitudes = np.radians(self.amplitudes)
        true = np.array([self.small * period_ratio(a) for a in amplitudes])
        fine = np.radians(np.linspace(1.0, max(self.amplitudes), 200))
        yield self._line(
            bench, "elliptic integral", fine, 1.0 / (self.small * np.array([period_ratio(a) for a in fine])), "line"
        )
        for name, model in bench.models.items():
            if name == TRUTH:
                continue
            measured = []
            try:
                for a, truth in zip(amplitudes, true, strict=True):
                    q0 = np.zeros(len(names))
                    q0[column] = self.rest + a
                    time = np.linspace(0.0, self.periods * truth, round(self.periods * self.samples) + 1)
                    run = model.simulate(q0, np.zeros(len(names)), time, step=None)
                    measured.append(period(run, column, self.rest))
            except UnsupportedError as error:
                yield bench.skipped(self.quantity, (name, TRUTH), str(error))
                continue
            errors = np.abs(np.array(measured) - true) / true
            worst = int(np.argmax(np.nan_to_num(errors, nan=np.inf)))
            yield bench.row(
                self.quantity,
                (name, TRUTH),
                float(errors[worst]),
                self.allowed,
                why=self.why,
                note=f"worst at {self.amplitudes[worst]:g}°: {measured[worst]:.10g} s against {true[worst]:.10g} s",
                source=CITES,
            )
            yield self._line(bench, name, amplitudes, 1.0 / np.array(measured), "points")

    def _line(self, bench: Bench, label: str, amplitude: Array, frequency: Array, style: str) -> Series:
        return Series(
            bench.case.name,
            "frequency_amplitude",
            label,
            tuple(np.degrees(amplitude).tolist()),
            tuple(frequency.tolist()),
            "amplitude [°]",
            "frequency [Hz]",
            title=bench.case.title,
            style=style,
        )
