"""The zeros that recordings have where a sensor has another one in each."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.outcome import Outcome

Zero = dict[str, Any]
"""``recording``, ``zero`` [unit], ``unit``."""


def zeros_of(outcome: Outcome, fitted: Fit, k: int) -> list[Zero]:
    """What member ``k`` of a fit adds to its channel in every recording: ``recording``, ``zero``, ``unit``.

    None if it is no zero of a recording's own.
    """
    member = fitted.hypothesis.members[k]
    if member.effect.sensor is None or not member.effect.sensor.own_zero:
        return []
    (c,) = (c for c, channel in enumerate(outcome.problem.channels) if channel.name == member.site)
    lanes = [(0, window, fitted.states[window]) for window in fitted.windows]
    whole = outcome.predictor.predict(fitted.hypothesis, fitted.x[None, :], lanes)
    bare = outcome.predictor.predict(fitted.hypothesis.without(k), fitted.x[None, :], lanes)
    found: dict[str, list[float]] = {}
    for window, with_, without in zip(fitted.windows, whole, bare, strict=True):
        found.setdefault(outcome.problem.runs[window.run].name, []).append(float(np.mean(with_[c] - without[c])))
    unit = outcome.problem.channels[c].unit
    return [{"recording": name, "zero": float(np.mean(values)), "unit": unit} for name, values in found.items()]
