"""Bending frequencies of a mounted beam against a closed form, mode by mode in every engine."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import NATIVE, Bench, Row, Series
from harness.cases.checks.beam_blame import by_frequencies
from harness.compare.spectrum import match_modes
from harness.errors import UnsupportedError


@dataclass(frozen=True)
class BeamFrequencyTruth:
    """Largest relative difference between an engine's bending frequencies and the true ones, modes matched.

    values: true frequencies [Hz]. allowed: native. peers: by engine name, what its discretization leaves, and why;
    an engine that is not named is not asked.
    """

    values: tuple[float, ...]
    allowed: float
    why: str
    peers: tuple[tuple[str, float, str], ...] = ()
    cites: str = ""
    quantity: str = "frequency"
    truth: str = "analytic"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        limits = {NATIVE: (self.allowed, self.why)} | {name: (limit, why) for name, limit, why in self.peers}
        true = np.array(self.values)
        for name, (allowed, why) in limits.items():
            model = bench.models.get(name)
            if model is None:
                continue
            try:
                found = np.asarray(model.frequencies(np.zeros(len(bench.system.coordinate_names))))
            except UnsupportedError as reason:
                yield bench.skipped(self.quantity, (name, self.truth), str(reason))
                continue
            found = found[found > 1e-3 * true[0]]
            pairs = match_modes(true, found)
            if len(pairs) < len(true):
                missing = [float(f) for i, f in enumerate(true) if i not in dict(pairs)]
                yield bench.row(
                    self.quantity, (name, self.truth), np.nan, allowed, why=why, note=f"no mode at {missing} Hz"
                )
                continue
            errors = np.array([abs(found[j] - true[i]) / true[i] for i, j in pairs])
            worst = int(np.argmax(errors))
            i, j = pairs[worst]
            said, place = "", None
            if not errors[worst] <= allowed:
                ratios = {i: found[j] / true[i] for i, j in pairs}
                said, place = by_frequencies(bench.system, name, true, ratios, mode=i)
            yield bench.row(
                self.quantity,
                (name, self.truth),
                float(errors[worst]),
                allowed,
                why=why,
                note="; ".join(filter(None, [f"mode {i + 1}: {found[j]:.8g} Hz against {true[i]:.8g} Hz", said])),
                first_divergence=place,
                source=self.cites,
            )
