"""A motion once more, finer: what its integration errs by."""

from __future__ import annotations

import numpy as np

from harness.cases.case import NATIVE, Array
from harness.compare.parting import Finer
from harness.engines.denoc_native import NativeModel
from harness.engines.march import march
from harness.engines.protocol import EngineError, EngineModel
from harness.errors import InputError
from harness.system import System, Trajectory

# Engines that choose their steps by tolerance; a step asked for is meant for the others.
ADAPTIVE = ("denoc", "pinocchio", "analytic")
# Steps between two samples, of an engine whose own step is not known: no number that it could have by itself.
STEPS = 37
# Tolerances of the native runs that are held against one another, and of one over another engine's equations.
LOOSE, TIGHT, CLOSELY = 1e-10, 1e-12, 1e-9
# Asked so often, an engine's equations are too rough to be integrated closely.
MOST_ASKED = 50_000


def step_of(engine: str, step: float | None) -> float | None:
    """The step [s] asked for if the engine integrates with a fixed one, else None."""
    return None if engine in ADAPTIVE else step


def finer(
    system: System, engine: str, model: EngineModel, q0: Array, qd0: Array, run: Trajectory, step: float | None
) -> Finer | None:
    """A motion with finer integration; None of engines whose own is as fine as can be, or that cannot do it.

    run: the motion; step: what its engine was asked for [s], None for its own. Of the native engine a hundredth of the tolerance,
    of others half the step; of one that does not answer to it, its own equations as others integrate them.
    """
    try:
        if engine == NATIVE:
            return _tighter(system, model, q0, qd0, run)
        if engine in ADAPTIVE:
            return None
        smaller = float(np.diff(run.time).min()) / STEPS if step is None else 0.5 * step
        again = model.simulate(q0, qd0, run.time, step=smaller)
    except (InputError, EngineError):
        return None
    if np.array_equal(again.position, run.position, equal_nan=True) and np.ptp(run.position, axis=0).any():
        return _by_its_equations(system, model, q0, qd0, run)
    return Finer("half the step" if step is not None else f"a step of {smaller:.2g} s", again.position)


def _tighter(system: System, model: EngineModel, q0: Array, qd0: Array, run: Trajectory) -> Finer | None:
    if not isinstance(model, NativeModel) or system.loops:
        return None
    loose, tight = (model.model.simulate(q0, qd0, run.time, rtol=r, atol=1e-2 * r).position for r in (LOOSE, TIGHT))
    # Joint laws are no part of these two, and change little in how they differ.
    return Finer("a hundredth of the tolerance", run.position + (tight - loose))


def _by_its_equations(system: System, model: EngineModel, q0: Array, qd0: Array, run: Trajectory) -> Finer:
    """An engine that chooses its steps may err in them: held against its own accelerations, which know no steps."""
    how = "integrating its own equations closely"
    rubs = any(joint.friction for joint in system.joints)
    if system.loops or not system.simple or system.attachments or rubs:
        return Finer(how, None)
    asked = 0

    def acceleration(q: Array, qd: Array, tau: Array) -> Array:
        nonlocal asked
        asked += 1
        if asked > MOST_ASKED:
            raise EngineError("its equations are too rough to be integrated closely")
        return model.forward_dynamics(q, qd, tau)

    try:
        position, _ = march(acceleration, q0, qd0, run.time, None, None, rtol=CLOSELY, atol=1e-2 * CLOSELY)
    except (InputError, EngineError, ArithmeticError):
        return Finer(how, None)
    return Finer(how, position)
