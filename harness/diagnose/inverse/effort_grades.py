"""How firmly what is found in efforts stands, and how its numbers repeat from recording to recording.

The same grades as those of free runs (``claims.grades``), by fits of efforts: with every recording left out in turn.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.claims.constants import PLAIN_LAW_RATIO
from harness.diagnose.claims.grades import ESTABLISHED, LIKELY, POSSIBLE, vague
from harness.diagnose.criticism.constants import FAKED_RATIO
from harness.diagnose.estimation.constants import FEWEST_CLUSTERS, NORMAL_95
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.inverse.effort_fit import EffortData, EffortFit, fit_effort, spread
from harness.diagnose.inverse.effort_model import EffortModel
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.state_evidence import placed

Array = NDArray[np.float64]

Rows = list[dict[str, Any]]


def without_each(parts: Sequence[EffortData], fitted: EffortFit) -> list[tuple[str, EffortFit]]:
    """A set fitted again to the recordings of training and held-out data without each of them; nothing of fewer than three."""
    model = parts[0].model
    runs = [run for part in parts for run in part.model.runs]
    grids = [grid for part in parts for grid in part.grids]
    names = [run.name for run in runs]
    if len(set(names)) < FEWEST_CLUSTERS:
        return []
    out = []
    for name in dict.fromkeys(names):
        kept = [k for k, other in enumerate(names) if other != name]
        rest = EffortModel(model.system, [runs[k] for k in kept], model.deadline)
        data = EffortData(rest, tuple(grids[k] for k in kept), parts[0].noises)
        out.append((name, fit_effort(data, fitted.hypothesis, fitted.x)))
    return out


def repeatability(others: Sequence[tuple[str, EffortFit]], nominal: int, k: int) -> Rows:
    """The parameters of member ``k`` as they are without each of the recordings."""
    rows: Rows = []
    for name, fitted in others:
        member = fitted.hypothesis.members[k]
        first, sigma = nominal + fitted.hypothesis.span(k).start, spread(fitted, nominal)
        parameters = {}
        for j, parameter in enumerate(member.effect.parameters):
            value, std = float(fitted.x[first + j]), float(sigma[first + j])
            if np.isfinite(std):
                ends = np.clip([value - NORMAL_95 * std, value + NORMAL_95 * std], parameter.lower, parameter.upper)
                parameters[parameter.name] = {"value": value, "ci95": [float(end) for end in ends]}
        rows.append({"recording": name, "left_out": True, "parameters": parameters})
    return rows


def grade(
    member: Candidate,
    values: Mapping[str, Estimate],
    rows: Rows,
    *,
    share: float,
    rivals: bool,
    remainder: bool,
) -> str:
    """How firmly a finding stands.

    share: what it explains (squares of the training efforts), in units of what is left beyond the noise; rivals: whether
    something else may be in its place; remainder: whether more than noise is left. Possible: chosen among many places, as well
    absent, or less than what is left (a law that can be bent, not far more). Established: nothing left but noise, or else the
    same in at least three recordings whichever is left out, its size known, and nothing else in its place. Likely: all others.
    """
    effect = member.effect
    first = next(iter(effect.parameters), None)
    if not remainder:
        return ESTABLISHED
    absent = first is not None and _holds(first.neutral, values[first.name].low, values[first.name].high)
    if placed(member) or absent or share < (PLAIN_LAW_RATIO if effect.plain else FAKED_RATIO):
        return POSSIBLE
    unknown = first is not None and vague(first, values[first.name])
    stands = [
        first is None
        or first.name not in row["parameters"]
        or not _holds(first.neutral, *row["parameters"][first.name]["ci95"])
        for row in rows
    ]
    return ESTABLISHED if stands and all(stands) and not unknown and not rivals else LIKELY


def _holds(neutral: float, low: float, high: float) -> bool:
    return low <= neutral <= high
