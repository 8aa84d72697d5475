"""Exudyn loaded, kept quiet and kept from writing files, and the solver settings that work on thin beams."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from harness.compiled_packages import loaded
from harness.engines.protocol import Array, EngineError
from harness.errors import cannot_be_loaded, install

_RENAMED = {
    "mass",
    "inertia",
    "centerOfMass",
    "length",
    "massPerLength",
    "bendingStiffness",
    "axialStiffness",
    "bendingDamping",
    "axialDamping",
}


def exudyn_package() -> Any:
    """The package ``exudyn``; EngineUnavailableError if it cannot be loaded."""
    try:
        return loaded("exudyn", "exudyn.itemInterface", "exudyn.solver")
    except ImportError as error:
        raise cannot_be_loaded("Exudyn", error, install("engines")) from None


@contextmanager
def quiet(exudyn: Any) -> Iterator[None]:
    """Nothing on the console, whatever happens; failures are told by exceptions."""
    config = getattr(exudyn, "config", None)
    before = getattr(config, "printToConsole", True)
    _console(exudyn, config, False)
    try:
        yield
    finally:
        _console(exudyn, config, before)


def _console(exudyn: Any, config: Any, on: bool) -> None:
    if hasattr(config, "printToConsole"):
        config.printToConsole = on
    else:  # before 1.10
        exudyn.SetWriteToConsole(on)


def item(kind: Any, **parameters: Any) -> Any:
    """An Exudyn item; parameters that were called ``physics…`` up to 1.12 are tried by that name too."""
    try:
        return kind(**parameters)
    except TypeError:
        return kind(**{("physics" + k[0].upper() + k[1:] if k in _RENAMED else k): v for k, v in parameters.items()})


def settings(exudyn: Any, duration: float, steps: int, write_every: float, *, relative: float, absolute: float) -> Any:
    """Solver settings: generalized-α, no files, sensors in memory every ``write_every`` [s].

    The Newton tolerances are the residual's; Exudyn's defaults lie below the rounding of a thin beam's axial force and
    never converge.
    """
    made = exudyn.SimulationSettings()
    solution: Any = getattr(made, "solution", None)
    if hasattr(solution, "file"):
        solution.file.write = False
        solution.sensors.writePeriod = write_every
    else:  # up to 1.11
        made.solutionSettings.writeSolutionToFile = False
        made.solutionSettings.sensorsWritePeriod = write_every
    integration = made.timeIntegration
    integration.startTime = 0.0
    integration.endTime = duration
    integration.numberOfSteps = steps
    integration.verboseMode = 0
    integration.newton.useModifiedNewton = True
    for newton in (integration.newton, made.staticSolver.newton):
        newton.relativeTolerance = relative
        newton.absoluteTolerance = absolute
    made.staticSolver.verboseMode = 0
    return made


def solve_dynamic(exudyn: Any, mbs: Any, made: Any) -> None:
    """Run the time integration; EngineError if it gives up."""
    try:
        success = mbs.SolveDynamic(made)
    except Exception as error:
        raise EngineError(f"exudyn gave up: {_first_line(error)}; use a smaller step") from None
    if success is False:
        raise EngineError("exudyn gave up: use a smaller step")


def solve_static(mbs: Any, made: Any) -> None:
    """Find the static equilibrium and make it the initial state; EngineError if there is none."""
    try:
        mbs.SolveStatic(made, updateInitialValues=True)
    except Exception as error:
        raise EngineError(f"exudyn found no static equilibrium: {_first_line(error)}") from None


def squared_frequencies(exudyn: Any, mbs: Any, made: Any) -> Array:
    """Squared angular frequencies of small motion [rad²/s²], ascending, those of the constraints taken out."""
    squares, _ = exudyn.solver.ComputeODE2Eigenvalues(mbs, made, useAbsoluteValues=False, singularValuesTolerance=1e-9)
    return np.sort(np.real(np.asarray(squares)))


def node_sensors(items: Any, mbs: Any, wanted: Iterable[tuple[Any, Any]]) -> list[Any]:
    """A sensor that keeps its samples in memory for each pair of a node and what is to be known of it."""
    return [
        mbs.AddSensor(items.SensorNode(nodeNumber=node, storeInternal=True, writeToFile=False, outputVariableType=kind))
        for node, kind in wanted
    ]


def _first_line(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip(" =*")]
    return lines[0] if lines else type(error).__name__


def stored(mbs: Any, sensor: Any, time: Array) -> Array:
    """What a sensor stored, at ``time`` (from zero), shape (T, k); EngineError if it ends early or is not finite."""
    table = np.asarray(mbs.GetSensorStoredData(sensor))
    if len(table) == 0 or table[-1, 0] < time[-1] * (1.0 - 1e-9) or not np.all(np.isfinite(table)):
        raise EngineError("exudyn did not reach the end of the run: use a smaller step")
    if len(table) == len(time) and np.allclose(table[:, 0], time, rtol=0.0, atol=1e-9 * max(time[-1], 1e-30)):
        return table[:, 1:]
    from scipy.interpolate import CubicSpline

    values: Array = CubicSpline(table[:, 0], table[:, 1:])(time)
    return values


def grid(time: Array, step: float) -> tuple[int, float]:
    """Number of steps no longer than ``step`` over the span, and the period of writing [s].

    Evenly spaced samples fall on steps; for others every step is written and the samples are interpolated.
    """
    span = float(time[-1] - time[0])
    gaps = np.diff(time)
    if np.ptp(gaps) <= 1e-9 * span:
        gap = span / len(gaps)
        inside = max(1, int(np.ceil(gap / step * (1.0 - 1e-9))))
        return inside * len(gaps), gap
    steps = max(1, int(np.ceil(span / step * (1.0 - 1e-9))))
    return steps, span / steps
