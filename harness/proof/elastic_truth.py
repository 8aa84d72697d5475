"""What hides in springs alone, run by MuJoCo itself: fourth-order Runge-Kutta in steps that resolve the fastest vibration.

A method with error control written in Python takes a hundred times as long, for such motion is stiff.
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from mujoco import rollout
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Steps times the fastest vibration's rate: the method is stable up to 2.8, and what is seen of vibrations is far slower.
FASTEST = 1.0
LONGEST = 1e-4  # s; the error of a swing's step is then 1e-14 of it
EVEN = 1e-9  # s
PARTS = 16  # of a step, whose efforts its mean is made of: one that is held may change anywhere


def has_springs(model: mujoco.MjModel) -> bool:
    """Whether the mechanism has springs."""
    return bool(np.any(model.jnt_stiffness > 0.0))


def even(time: Array) -> bool:
    """Whether times follow one another evenly."""
    return len(time) > 2 and float(np.ptp(np.diff(time))) < EVEN


def fastest(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Angular rate [rad/s] of the fastest vibration about the reference position; inertia is about the same in all others."""
    mujoco.mj_resetData(model, data)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    stiffness = np.zeros(model.nv)
    stiffness[model.jnt_dofadr] = model.jnt_stiffness
    return float(np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(mass, np.diag(stiffness)))).max()))


def run(
    model: mujoco.MjModel, q0: Array, v0: Array, time: Array, effort: Callable[[Array], Array] | None
) -> tuple[Array, Array]:
    """Position and velocity (T, n) at even times.

    effort: times (T,) -> generalized forces (T, n); within a step it is its mean, which is right to second order.
    """
    data = mujoco.MjData(model)
    interval = float(time[1] - time[0])
    parts = int(np.ceil(interval / min(LONGEST, FASTEST / max(fastest(model, data), 1e-300))))
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    model.opt.timestep = interval / parts
    steps = parts * (len(time) - 1)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    begin = np.concatenate([[0.0], q0, v0])
    assert size == len(begin)
    applied = np.zeros((1, steps, model.nv))
    if effort is not None:
        within = (np.arange(PARTS) + 0.5) / PARTS
        for part in within:
            applied[0] += effort(time[0] + (np.arange(steps) + part) * model.opt.timestep) / PARTS
    states, _ = rollout.rollout(
        model, data, begin[None], applied, control_spec=int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)
    )
    kept = np.vstack([begin, states[0, parts - 1 :: parts]])
    return kept[:, 1 : 1 + model.nq], kept[:, 1 + model.nq :]
