"""Whether loops can be closed where joints were recorded: another unit, zero or sign of a column leads out of reach."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.denoc.lanes.model import LaneModel
from harness.diagnose.estimation.constants import REACH_SAMPLES, REACH_STARTS, UNREACHED_SHARE
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.errors import InputError
from harness.system.closure import size

Array = NDArray[np.float64]


def check_reach(predictor: Predictor) -> None:
    """Refuse recordings most of whose samples no assembly of the model takes; of the recorded joints those that lead are asked.

    Raises InputError naming recording, joint and time. Samples at the end of the reach may be beyond it by noise, or by what a
    sensor has added, so that some of them are no reason.
    """
    system, problem = predictor.system, predictor.problem
    if not system.loops:
        return
    mechanism = predictor.mechanism(Hypothesis())
    names, model = mechanism.names, mechanism.model
    row = predictor.row(Hypothesis(), np.zeros(len(predictor.nominal)))
    follow = [names.index(name) for name in model.dependent]
    read = [
        (c, names.index(channel.site))
        for c, channel in enumerate(problem.channels)
        if channel.quantity == "position" and channel.site in names and channel.site not in model.dependent
    ]
    if not read or not follow:
        return
    reach = np.array([2.0 * size(system) if system.joint(names[k]).prismatic else np.pi for k in follow])
    spread = np.random.default_rng(7).uniform(-1.0, 1.0, (REACH_STARTS, len(follow))) * reach
    spread[0] = 0.0
    for run in problem.runs:
        seen = np.flatnonzero(np.isfinite(run.values[[c for c, _ in read]]).all(axis=0))
        if not len(seen):
            continue
        taken = seen[np.unique(np.linspace(0, len(seen) - 1, REACH_SAMPLES).round().astype(int))]
        states = np.zeros((len(taken), REACH_STARTS, 2 * len(names)))
        states[..., : len(names)] = model.placed
        for c, k in read:
            states[..., k] = run.values[c, taken, None]
        states[:, :, follow] += spread
        reached, found = _reached(model, row, states)
        if found is not None and not reached.all():
            # From where other samples were reached, where no start of its own has led there.
            again = np.repeat(states[~reached][:, :1], len(found), axis=1)
            again[:, :, follow] = found[:, follow]
            reached[~reached] = _reached(model, row, again)[0]
        if np.mean(~reached) > UNREACHED_SHARE:
            first = int(taken[np.flatnonzero(~reached)[0]])
            at = ", ".join(
                f"{problem.channels[c].name} {run.values[c, first]:.3g} {problem.channels[c].unit}" for c, _ in read
            )
            raise InputError(
                f"{run.name}: the model's loops cannot be closed at most of its samples, as at {run.time[first]:.3g} s ({at})",
                mend="check the column's unit, zero and sign, and the lengths and frames of the model",
            )


def _reached(model: LaneModel, row: Array, states: Array) -> tuple[NDArray[np.bool_], Array | None]:
    """Which samples (S,) can be closed from any of their states (S, A, 2n), and a closed state of each that can be."""
    flat = states.reshape(-1, states.shape[-1])
    closed: Array = model.closed(np.repeat(row[None], len(flat), axis=0), flat, np.inf)
    good = np.isfinite(closed).reshape(*states.shape[:2], -1).all(axis=2)
    reached = np.asarray(np.any(good, axis=1), dtype=np.bool_)
    first = closed.reshape(states.shape)[np.arange(len(states)), good.argmax(axis=1)][reached]
    return reached, first if len(first) else None
