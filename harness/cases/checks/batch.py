"""Many states in one call against other engines, one state at a time."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import NATIVE, Bench, Row, Series
from harness.cases.checks.states import difference_of, evaluate, random_states, where
from harness.denoc import Denoc
from harness.errors import UnsupportedError

# What a batch method answers, and the arguments it takes, of the members of ``States``.
BATCHES = {
    "acceleration": ("forward_dynamics_batch", ("q", "qd", "tau")),
    "inverse_dynamics": ("inverse_dynamics_batch", ("q", "qd", "qdd")),
    "mass_matrix": ("mass_matrix_batch", ("q",)),
}


@dataclass(frozen=True)
class BatchAgreement:
    """Largest relative difference between a ``*_batch`` method of the native dynamics and each other engine.

    of: a key of ``BATCHES``. allowed, why: as in ``StateAgreement``. states: not a multiple of eight, so that a group of
    eight that is not full is among them. elastic: 1σ of elastic coordinates.
    """

    of: str
    allowed: float
    why: str
    states: int = 19
    elastic: float = 0.0

    @property
    def quantity(self) -> str:
        return BATCHES[self.of][0]

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        method, arguments = BATCHES[self.of]
        states = random_states(bench, self.states, 1.0, 1.0, self.elastic)
        native = Denoc(bench.system)
        ours = getattr(native, method)(*(getattr(states, name) for name in arguments))
        ours = np.asarray(ours).reshape(self.states, -1)
        for name, model in bench.peers():
            try:
                theirs = evaluate(self.of, model, states)
                mass = np.array([model.mass_matrix(q) for q in states.q])
            except UnsupportedError as error:
                yield bench.skipped(self.quantity, (NATIVE, name), str(error))
                continue
            apart = difference_of(self.of, mass, ours, theirs)
            worst = int(np.argmax(apart))
            place = None
            if not apart[worst] <= self.allowed:
                place = where(bench.system, self.of, worst, ours[worst], theirs[worst])
            yield bench.row(
                self.quantity,
                (NATIVE, name),
                float(apart[worst]),
                self.allowed,
                why=self.why,
                first_divergence=place,
                note=f"{self.states} states in one call",
            )
