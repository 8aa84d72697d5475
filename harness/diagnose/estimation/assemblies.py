"""Where a closed mechanism begins, when the joints that were recorded leave several ways to close its loops (assemblies).

Of a four-bar's rocker two places of the crank are left, of its crank two of the coupler, and a motion through a dead point leads
from one to the other. They are found by Newton's method from many places of the joints that follow. At every beginning the nominal
model then runs freely from each, and the one that follows the recording clearly better is taken: accelerations differ at once, and
what the model leaves out takes time to lead away, so that the shortest stretch that decides is judged. Where none decides, it is
where the model places itself, if its file places it with its loops closed.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from harness.denoc.lanes.closed import NEAR
from harness.diagnose.estimation.constants import (
    ASSEMBLY_STARTS,
    ASSEMBLY_SWINGS,
    FEWEST_ASSEMBLY_SAMPLES,
    MOST_ASSEMBLIES,
    OUTSIDE_RANGE_SHARE,
    SAME_ASSEMBLY,
    WORSE_ASSEMBLY_RATIO,
)
from harness.diagnose.prediction.assembly import Assembly
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import Run
from harness.diagnose.problem.windows import Window
from harness.effects.scale import swings
from harness.system.closure import opening, size, stated_position, worst
from harness.system.kinematics import poses
from harness.system.lowering import lower

Array = NDArray[np.float64]


def closed_as_recorded(predictor: Predictor, window: Window, state: Array) -> Array:
    """The state (2n,) read off a recording where a window begins, with loops closed in the way that follows the recording best."""
    followers = set(predictor.mechanism(Hypothesis()).model.dependent)
    read = {c.site for c in predictor.problem.channels if c.quantity == "position"}
    if followers <= read:
        return predictor.closed(state)
    known = predictor.assemblies.get((window.run, window.first))
    if known is None:
        known = predictor.assemblies[window.run, window.first] = _begun(predictor, window, state)
        return known.state
    if known.ways == 1:
        return predictor.closed(state)
    # The same way for a state that was read otherwise.
    places = _followers(predictor)
    near = state.copy()
    near[places] = known.state[places]
    found = _closed(predictor, near[None])[0]
    return found if np.isfinite(found).all() else known.state


def assemblies(predictor: Predictor, state: Array) -> Array:
    """States (A, 2n) with loops closed and the coordinates that lead as they are; the first as the model places itself."""
    stated = predictor.closed(state)
    places, system = _followers(predictor), predictor.system
    mechanism = predictor.mechanism(Hypothesis())
    joints = [system.joint(mechanism.names[k]) for k in places]
    placed = mechanism.model.placed[places]
    sliding = np.array([joint.prismatic for joint in joints])
    reach = np.where(sliding, 2.0 * size(system), np.pi)
    tried = np.repeat(state[None], ASSEMBLY_STARTS, axis=0)
    # The same places every time.
    tried[:, places] = placed + np.random.default_rng(7).uniform(-1.0, 1.0, (ASSEMBLY_STARTS, len(places))) * reach
    found = _unwound(predictor, _closed(predictor, tried), placed, sliding)
    low, high = (np.array([getattr(joint, end) for joint in joints]) for end in ("lower", "upper"))
    slack = OUTSIDE_RANGE_SHARE * np.where(np.isfinite(high - low), high - low, 0.0)
    q = found[:, places]
    found = found[np.isfinite(found).all(axis=1) & (q >= low - slack).all(axis=1) & (q <= high + slack).all(axis=1)]
    found = found[np.argsort(np.abs((found - stated)[:, places] / reach).max(axis=1), kind="stable")]
    kept, seen = [stated], [_shape(predictor, stated)]
    turned = [_turns(stated[places], sliding)]
    for other in found:
        turns = _turns(other[places], sliding)
        if any(np.abs(turns - known).max() < 0.1 * SAME_ASSEMBLY for known in turned):
            continue
        turned.append(turns)
        # Angles of a ball may differ where no body does.
        shape = _shape(predictor, other)
        if len(kept) < MOST_ASSEMBLIES and all(np.abs(shape - known).max() > SAME_ASSEMBLY for known in seen):
            kept.append(other)
            seen.append(shape)
    if len(kept) > 1 and stated is state:
        # What leads cannot be reached from where the model places itself.
        kept = kept[1:]
    return np.array(kept)


def told(predictor: Predictor, runs: Iterable[Run]) -> tuple[str, ...]:
    """What an answer says of the beginnings of recordings that several assemblies fit."""
    names = predictor.mechanism(Hypothesis()).names
    places = _followers(predictor) if predictor.assemblies else []
    said = []
    for k, run in enumerate(runs):
        beginning = predictor.assemblies.get((k, 0))
        if beginning is None or beginning.ways == 1:
            continue
        at = ", ".join(f"{names[i]} {beginning.state[i]:.3g}" for i in places)
        where = f"{run.name} at {at}{', not where the model places it' if beginning.elsewhere else ''}"
        if beginning.alike > 1:
            where += f" ({beginning.alike} of {beginning.ways} ways cannot be told apart over the first swing)"
        said.append(where)
    if not said:
        return ()
    leads = ", ".join(name for name in names if name not in {names[i] for i in places})
    return (f"with {leads} as recorded the loops close in more than one way; runs begin: {'; '.join(said)}",)


def _begun(predictor: Predictor, window: Window, state: Array) -> Assembly:
    found = assemblies(predictor, state)
    stated = found[0]
    if len(found) == 1:
        return Assembly(stated, stated)
    costs = _misfits(predictor, window, found)
    best = int(np.argmin(costs))
    if not _placed(predictor):
        stated = found[best]
    elif costs[0] <= WORSE_ASSEMBLY_RATIO * costs[best]:
        best = 0
    alike = int((costs <= WORSE_ASSEMBLY_RATIO * costs[best]).sum())
    if predictor.closed(state) is state:
        # The model's place leads to none of them.
        stated, best = found[best], 0
    return Assembly(stated if best == 0 else found[best], stated, len(found), max(alike, 1))


def _placed(predictor: Predictor) -> bool:
    """Whether the model itself says how its loops close: one that stands open where its file places it does not."""
    system = predictor.system
    return worst(system, opening(system, stated_position(system))) < NEAR


def _misfits(predictor: Predictor, window: Window, states: Array) -> Array:
    """Mean squares (A,) of what free runs leave, in units of the noise's and one more, over the shortest stretch that decides."""
    run = predictor.problem.runs[window.run]
    swing = 2.0 * np.pi / min(swings(predictor.system))
    whole = int(np.clip(round(swing / run.interval) + 1, FEWEST_ASSEMBLY_SAMPLES, len(run.time) - window.first))
    stretch = Window(window.run, window.first, window.first + whole)
    x = np.zeros((1, len(predictor.nominal)))
    runs = np.array(predictor.predict(Hypothesis(), x, [(0, stretch, state) for state in states]))
    values = run.values[:, stretch.first : stretch.last]
    extent = np.nanmax(values, axis=1, initial=0.0) - np.nanmin(values, axis=1, initial=0.0)
    noise = np.fmax(run.roughness, 1e-9 * extent + 1e-12)
    with np.errstate(over="ignore", invalid="ignore"):
        squares = ((runs - values) / noise[:, None]) ** 2
    squares[:, ~np.isfinite(values)] = np.nan
    costs = np.ones(len(states))
    for share in ASSEMBLY_SWINGS:
        first = squares[:, :, : max(round(share * whole), FEWEST_ASSEMBLY_SAMPLES)]
        lost = ~np.isfinite(runs[:, :, : first.shape[2]]).all(axis=(1, 2))
        read = np.isfinite(values[:, : first.shape[2]]).any()
        costs = 1.0 + (np.nanmean(first, axis=(1, 2)) if read else np.zeros(len(states)))
        costs[lost] = np.inf
        low = np.sort(costs)
        if low[1] > WORSE_ASSEMBLY_RATIO * low[0]:
            break
    return costs


def _unwound(predictor: Predictor, states: Array, placed: Array, sliding: NDArray[np.bool_]) -> Array:
    """States less whole turns of what follows, as far as loops stay closed so: springs know them, and all windows count alike."""
    places = _followers(predictor)
    q = states[:, places]
    turns = np.where(sliding, 0.0, np.round((q - placed) / (2.0 * np.pi)))
    turned = states.copy()
    turned[:, places] -= 2.0 * np.pi * turns
    again = _closed(predictor, turned)
    with np.errstate(invalid="ignore"):
        same = np.abs(again - turned).max(axis=1) < SAME_ASSEMBLY
    return np.where(same[:, None], again, states)


def _followers(predictor: Predictor) -> list[int]:
    mechanism = predictor.mechanism(Hypothesis())
    return [mechanism.names.index(name) for name in mechanism.model.dependent]


def _closed(predictor: Predictor, states: Array) -> Array:
    """States (B, 2n) closed from where they are, nan where they cannot be."""
    model = predictor.mechanism(Hypothesis()).model
    row = predictor.row(Hypothesis(), np.zeros(len(predictor.nominal)))
    return model.closed(np.repeat(row[None], len(states), axis=0), states, np.inf)


def _turns(q: Array, sliding: NDArray[np.bool_]) -> Array:
    """Coordinates that are the same after a whole turn."""
    return np.concatenate([np.where(sliding, q, np.cos(q)), np.where(sliding, 0.0, np.sin(q))])


def _shape(predictor: Predictor, state: Array) -> Array:
    """Where all bodies are, turned and placed in the mechanism's size."""
    system = predictor.system.rigid()
    length = size(system)
    at = poses(lower(system), state[: len(state) // 2])
    return np.concatenate([np.append(pose.rotation.ravel(), pose.origin / length) for pose in at.values()])
