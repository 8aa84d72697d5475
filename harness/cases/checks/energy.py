"""Energy of an undamped free motion is kept."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import NATIVE, Bench, Row, Series
from harness.cases.checks.trajectory import initial_state
from harness.errors import UnsupportedError


@dataclass(frozen=True)
class EnergyKept:
    """Largest change of the total energy over a run of the native engine, relative to the largest kinetic energy.

    position, velocity: initial state by coordinate name. duration [s].
    """

    allowed: float
    why: str
    position: tuple[tuple[str, float], ...] = ()
    velocity: tuple[tuple[str, float], ...] = ()
    duration: float = 60.0
    samples: int = 601
    quantity: str = "energy_kept"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        model = bench.models.get(NATIVE)
        if model is None:
            return
        q0, qd0 = initial_state(bench.system, dict(self.position), dict(self.velocity))
        run = model.simulate(q0, qd0, np.linspace(0.0, self.duration, self.samples), step=None)
        try:
            parts = np.array([model.energy(q, qd) for q, qd in zip(run.position, run.velocity, strict=True)])
        except UnsupportedError as error:
            yield bench.skipped(self.quantity, (NATIVE, "analytic"), str(error))
            return
        total = parts.sum(axis=1)
        change = float(np.abs(total - total[0]).max() / parts[:, 0].max())
        yield bench.row(
            self.quantity,
            (NATIVE, "analytic"),
            change,
            self.allowed,
            why=self.why,
            note=f"over {self.duration:g} s",
            source="conservation of energy",
        )
