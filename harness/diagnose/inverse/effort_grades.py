"""How firmly what is found in efforts stands, and how its numbers repeat from recording to recording.

The same grades as those of free runs (``claims.grades``), by fits of efforts: with every recording left out in turn.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.claims.grades import ESTABLISHED, LIKELY, POSSIBLE, beside_a_remainder, no_smooth_force
from harness.diagnose.estimation.constants import FEWEST_CLUSTERS, NORMAL_95, WIDEST_INTERVAL
from harness.diagnose.estimation.intervals import Estimate
from harness.diagnose.inverse.constants import SURELY_OFF_SIGMAS
from harness.diagnose.inverse.effort_fit import EffortData, EffortFit, fit_effort, spread
from harness.diagnose.inverse.effort_model import EffortModel
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.problem.hypothesis import Candidate
from harness.effects.effect import Family

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
        parameters = {
            key: {"value": e.value, "ci95": [e.low, e.high]}
            for key, e in estimates(fitted, nominal, k).items()
            if np.isfinite(e.low + e.high)
        }
        rows.append({"recording": name, "left_out": True, "parameters": parameters})
    return rows


def estimates(fitted: EffortFit, nominal: int, k: int) -> dict[str, Estimate]:
    """The parameters of member ``k``; nominal: how many nominal quantities stand before them."""
    member = fitted.hypothesis.members[k]
    first, sigma = nominal + fitted.hypothesis.span(k).start, spread(fitted, nominal)
    out = {}
    for j, parameter in enumerate(member.effect.parameters):
        value = float(fitted.x[first + j])
        # What the efforts do not turn on has an information of nothing, and a deviation of any size.
        s = min(float(sigma[first + j]), WIDEST_INTERVAL * float(member.scales[j]))
        span = 1e-6 * float(member.scales[j])
        bound = value <= parameter.lower + span or value >= parameter.upper - span
        low, high = max(value - NORMAL_95 * s, parameter.lower), min(value + NORMAL_95 * s, parameter.upper)
        out[parameter.name] = Estimate(value, None if bound else s, low, high)
    return out


def grade(
    study: EffortStudy, best: EffortFit, k: int, smaller: EffortFit, rows: Rows, *, rivals: bool | None, remainder: bool
) -> str:
    """How firmly member ``k`` of a set stands.

    smaller: the set without it; rows: see ``repeatability``; rivals: whether something else may be in its place, None where
    there was no time to ask; remainder: whether more than noise is left. Where nothing but noise is, it is established. What has a
    special case that was not asked about is possible. Where nominal quantities lie far outside their tolerance, the model is wrong
    elsewhere, and what bodies carry may be no more than possible, all else no more than likely: numbers lean on what is wrong.
    """
    if rivals is None and best.hypothesis.members[k].effect.simpler:
        # A plainer law may do as well, and nobody has asked.
        return POSSIBLE
    if not remainder:
        return LIKELY if rivals is None else ESTABLISHED
    data, values = study.data, estimates(best, study.nominal, k)
    own, other = (data.of_each(data.rows(f.hypothesis, f.x)) for f in (best, smaller))
    gains = np.maximum(other - own, 0.0)
    # What is left at joints that an effect does nothing at says nothing of it.
    beside = gains / max(float(gains.max()), 1e-300)
    gain, excess = float(np.sum(other - own)), float(beside @ (own - data.counts))
    found = beside_a_remainder(
        best.hypothesis.members[k],
        values,
        rows,
        gain=gain,
        excess=excess,
        itself=rivals is False,
        whole=no_smooth_force(waves_seen(data, best.hypothesis.members[k], values), gain, excess),
    )
    if np.max(np.abs(best.x[: study.nominal]), initial=0.0) <= SURELY_OFF_SIGMAS:
        return found
    if best.hypothesis.members[k].effect.family is Family.INERTIA:
        return POSSIBLE
    return LIKELY if found == ESTABLISHED else found


def waves_seen(data: EffortData, member: Candidate, values: Mapping[str, Estimate]) -> float:
    """How many whole waves of a member were seen at least, if it is a wave over the angle; 0 of what is none."""
    if "periods" not in values:
        return 0.0
    j = data.model.system.joint_names.index(member.site)
    turned = [run.q[run.usable, j] for run in data.model.runs if run.usable.any()]
    seen = max(float(q.max()) for q in turned) - min(float(q.min()) for q in turned)
    return values["periods"].low * seen / (2.0 * np.pi)
