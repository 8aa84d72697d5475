"""A simulation beside a recording: begun as it begins, driven by its efforts."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from harness.cases.single_run import run_once
from harness.errors import InputError
from harness.recording import Recording
from harness.report.animation.scene import Motion
from harness.report.figures.before_after import AFTER
from harness.system import System

Array = NDArray[np.float64]

BEGINNING, FEWEST = 0.1, 9  # s, and samples, from which the velocity at the start is read


def simulated(
    system: System, time: Array, position: Mapping[str, float], velocity: Mapping[str, float], engine: str
) -> tuple[Array, list[Motion]]:
    """A simulation alone; time: [s], shape (T,)."""
    run = run_once(system, time, position, velocity, engine=engine)
    return time, [Motion(f"simulated ({engine})", AFTER, _positions(run.columns, system))]


def beside(
    system: System,
    recording: Recording,
    position: Mapping[str, float],
    velocity: Mapping[str, float],
    duration: float | None,
    engine: str,
) -> tuple[Array, list[Motion], tuple[str, ...]]:
    """Times, the simulation and the recording, and what a reader has to know of them.

    position, velocity: what the simulation starts from instead of the recording's own beginning.
    Raises InputError for a recording without any joint's position.
    """
    keep = recording.time <= (np.inf if duration is None else duration)
    time = recording.time[keep]
    measured = {
        c.site: _filled(time, c.values[keep])
        for c in recording.channels
        if c.quantity == "position" and c.site in system.joint_names and np.isfinite(c.values[keep]).any()
    }
    if not measured or len(time) < 2:
        raise InputError(
            "has no position of a joint to show", source=recording.source, mend="name a column <joint>.position"
        )
    told = [f"{joint} is not measured: drawn at zero." for joint in system.joint_names if joint not in measured]
    begun = {joint: float(values[0]) for joint, values in measured.items()} | dict(position)
    speed = {joint: _speed(time, values) for joint, values in measured.items()} | dict(velocity)
    tau = None
    if recording.efforts:
        tau = np.zeros((len(time), len(system.coordinate_names)))
        for effort in recording.efforts:
            tau[:, system.coordinate_names.index(effort.site)] = _filled(time, effort.values[keep])
    run = run_once(system, time, begun, speed, engine=engine, tau=tau)
    motions = [
        Motion(f"simulated ({engine})", AFTER, _positions(run.columns, system)),
        Motion("measured", "ink", measured),
    ]
    return time, motions, tuple(told)


def _positions(columns: Mapping[str, Array], system: System) -> dict[str, Array]:
    return {joint: columns[f"{joint}.position"] for joint in system.joint_names}


def _filled(time: Array, values: Array) -> Array:
    """Gaps joined by straight lines."""
    good = np.isfinite(values)
    return np.asarray(np.interp(time, time[good], values[good])) if good.any() else np.zeros(len(time))


def _speed(time: Array, values: Array) -> float:
    """Velocity at the start: the slope there of a parabola through the first samples."""
    count = min(max(int(np.searchsorted(time, time[0] + BEGINNING)), FEWEST), len(time))
    if count < 3:
        return float((values[1] - values[0]) / (time[1] - time[0]))
    return float(np.polynomial.Polynomial.fit(time[:count], values[:count], 2).deriv()(time[0]))
