"""The augmented model run again, in the native engine and in every other one that can express what was found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.cases.case import NATIVE
from harness.cases.single_run import run_once
from harness.diagnose.answer.constants import FINE_REPLAY_STEP, REPLAY_STEP
from harness.diagnose.problem.payloads import carrying
from harness.effects import catalogue
from harness.engines.expressed import bends, realised
from harness.engines.registry import availability
from harness.errors import EngineUnavailableError, InputError
from harness.system import System

Array = NDArray[np.float64]

# A light drive side vibrates on its teeth at hundreds of hertz; blows fall into steps.
DEMANDING = ("backlash", "stop_inertia")
CLOSED_FORM = "analytic"
OF_BEAMS = ("exudyn_ancf", "exudyn_ffrf")


@dataclass(frozen=True, eq=False)
class Opening:
    """Where a recording begins, as the augmented model was fitted to it, and what drives it.

    position, velocity: by coordinate name, effects' own coordinates included [rad or m, rad/s or m/s]. time: of the samples [s],
    from 0, (T,). tau: efforts as recorded, (T, n) in the order of the nominal system's coordinates, or None. hold: how they act
    between samples, as the recordings showed. noise: standard deviation of a channel's sensor by name.
    payload: what links carry more in this recording than in the model.
    """

    recording: str
    position: Mapping[str, float]
    velocity: Mapping[str, float]
    time: Array
    tau: Array | None
    noise: Mapping[str, float]
    hold: str = "zero"
    payload: Mapping[str, Array] = field(default_factory=dict)


def replay(system: System, opening: Opening) -> tuple[dict[str, Any], ...]:
    """Motion of the augmented system in every other installed engine, held against the native one.

    Returns, per engine, the channel in which they differ most beside its noise, the RMS difference there and that noise, or why the
    engine was left out. Sensors and inputs are the same in all of them.
    """
    if system.gimbals:
        return ()  # in a chart of its own, which other engines do not know
    system = carrying(system, opening.payload)
    try:
        native = _columns(system, opening, NATIVE)
    except InputError as error:
        return (_left_out(NATIVE, error),)
    out: list[dict[str, Any]] = []
    for line in availability():
        if line.name in (NATIVE, CLOSED_FORM) or line.version is None:
            continue
        if line.name in OF_BEAMS and not bends(system):
            continue
        try:
            theirs = _columns(system, opening, line.name)
        except (InputError, EngineUnavailableError) as error:
            out.append(_left_out(line.name, error))
            continue
        apart = {
            name: float(np.sqrt(np.mean((theirs[name] - native[name]) ** 2)))
            for name in opening.noise
            if name in theirs
        }
        worst = max(apart, key=lambda name: apart[name] / max(opening.noise[name], 1e-300))
        note = "" if apart[worst] <= opening.noise[worst] else "apart by more than the noise"
        row = {"engine": line.name, "channel": worst, "difference": apart[worst], "noise": opening.noise[worst]}
        out.append(row | {"note": note})
    return tuple(out)


def replayable(system: System) -> bool:
    """Whether the system has effects of the dynamics that engines know, so that another one can check the native one."""
    kinds = [catalogue().get(attachment.effect) for attachment in system.attachments]
    return None not in kinds and any(kind is not None and kind.side == "dynamics" for kind in kinds)


def _columns(system: System, opening: Opening, engine: str) -> Mapping[str, Array]:
    known = realised(system).coordinate_names
    position, velocity = (
        {name: value for name, value in part.items() if name in known} for part in (opening.position, opening.velocity)
    )
    step = FINE_REPLAY_STEP if any(attachment.effect in DEMANDING for attachment in system.attachments) else REPLAY_STEP
    own = None if engine == NATIVE else step
    return run_once(
        system, opening.time, position, velocity, engine=engine, tau=opening.tau, hold=opening.hold, step=own
    ).columns


def _left_out(engine: str, error: Exception) -> dict[str, Any]:
    said = error.what if isinstance(error, InputError) else str(error)
    # The engine's name stands in the row already.
    note = said.split(" cannot run it: ", 1)[-1]
    return {"engine": engine, "channel": None, "difference": None, "noise": None, "note": note}
