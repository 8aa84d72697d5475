"""Natural frequencies against a closed form."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import Bench, Row, Series
from harness.cases.checks.beam_blame import by_frequencies
from harness.cases.checks.trajectory import initial_state
from harness.errors import UnsupportedError


@dataclass(frozen=True)
class FrequencyTruth:
    """Largest relative difference between an engine's natural frequencies and the true ones, mode by mode.

    values: true frequencies [Hz], ascending; the engine's frequency nearest to each is the same mode.
    at: position by coordinate name [rad or m] about which the motion is small.
    """

    values: tuple[float, ...]
    allowed: float
    why: str
    cites: str = ""
    at: tuple[tuple[str, float], ...] = ()
    quantity: str = "frequency"
    truth: str = "analytic"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        q, _ = initial_state(bench.system, dict(self.at), {})
        true = np.array(self.values)
        for name, model in bench.models.items():
            if name == self.truth:
                continue
            try:
                found = np.asarray(model.frequencies(q))
            except UnsupportedError as error:
                yield bench.skipped(self.quantity, (name, self.truth), str(error))
                continue
            if len(found) == 0:
                yield bench.row(
                    self.quantity, (name, self.truth), np.nan, self.allowed, why=self.why, note="no frequency"
                )
                continue
            nearest = found[np.abs(found[:, None] - true[None, :]).argmin(axis=0)]
            errors = np.abs(nearest - true) / true
            worst = int(np.argmax(np.nan_to_num(errors, nan=np.inf)))
            said, place = "", None
            if not errors[worst] <= self.allowed and np.isfinite(errors).all():
                said, place = by_frequencies(
                    bench.system, name, true, dict(enumerate(nearest / true)), mode=worst, at=q
                )
            yield bench.row(
                self.quantity,
                (name, self.truth),
                float(errors[worst]),
                self.allowed,
                why=self.why,
                note="; ".join(filter(None, [f"{nearest[worst]:.7g} Hz against {true[worst]:.7g} Hz", said])),
                first_divergence=place,
                source=self.cites,
            )
