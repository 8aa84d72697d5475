"""The zeros that recordings have where a sensor has another one in each."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.diagnose.fit import Fit
from harness.diagnose.investigate import Outcome


def zeros_of(outcome: Outcome, fitted: Fit, k: int) -> list[dict[str, Any]]:
    """What member ``k`` of a fit adds to its channel in every recording: ``recording``, ``zero``, ``unit``.

    None if it is no zero of a recording's own.
    """
    member = fitted.hypothesis.members[k]
    if not member.zeros:
        return []
    (c,) = (c for c, channel in enumerate(outcome.problem.channels) if channel.name == member.site)
    without = fitted.hypothesis.without(k)
    found: dict[str, list[float]] = {}
    for window in fitted.windows:
        run = outcome.problem.runs[window.run]
        lanes = [(0, window, fitted.states[window])]
        bare = outcome.predictor.predict(without, fitted.x[None, :], lanes)[0]
        whole = outcome.predictor.predict(fitted.hypothesis, fitted.x[None, :], lanes)[0]
        found.setdefault(run.name, []).append(float(np.mean(whole[c] - bare[c])))
    unit = outcome.problem.channels[c].unit
    return [{"recording": name, "zero": float(np.mean(values)), "unit": unit} for name, values in found.items()]
