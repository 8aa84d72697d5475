"""Many states of floating robots at once on one thread, against Pinocchio's pool and ``mujoco.rollout``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from harness.compare.bench.measure import side_by_side
from harness.compare.bench.peers import Array, Options, States, native, or_skipped, peer_model
from harness.compare.bench.row import Row
from harness.system import System
from harness.system.load import load

ROBOTS = {"quadruped": "anymal.urdf", "humanoid": "talos_reduced.urdf"}
COUNT = 512
WANTED = 10.0


def run(options: Options) -> Iterator[Row]:
    """A quadruped and a humanoid of example-robot-data."""
    for case, file in ROBOTS.items():
        for peer in PEERS:
            measure = partial(_rows, f"floating {case}, {file}", file, peer, options)
            yield from or_skipped("floating_forward_dynamics_batch", None, peer, measure, case=file)


def floating_robot(name: str) -> System:
    """A robot of example-robot-data whose root is free."""
    found = [file for file in metadata.files("example-robot-data") or [] if file.name == name]
    return load(Path(str(found[0].locate())), physical=False, floating=True)


def floating_states(model: Any, count: int) -> States:
    """``count`` states, the same at every call."""
    rng = np.random.default_rng(0)
    q = np.array([model.integrate(model.neutral, rng.normal(size=model.n)) for _ in range(count)])
    return States(q, rng.normal(size=(count, model.n)), rng.normal(size=(count, model.n)))


def pinocchio_accelerations(system: System, at: States) -> Callable[[], Array]:
    """By its pool of one thread, written over the results of the call before."""
    import pinocchio as pin

    peer = peer_model("pinocchio", system)
    pool = pin.ModelPool(peer.model, 1)
    q = np.asfortranarray(at.q[:, peer.axes.places].T)
    qd, tau = (np.asfortranarray(x[:, peer.axes.order].T) for x in (at.qd, at.tau))
    out = np.zeros_like(qd, order="F")

    def call() -> Array:
        pin.abaInParallel(1, pool, q, qd, tau, out)
        return out

    return call


def mujoco_accelerations(system: System, at: States) -> Callable[[], Array]:
    """By a step of Euler's from every state in ``mujoco.rollout`` on one thread, as MuJoCo has no call for accelerations alone."""
    import mujoco
    from mujoco import rollout

    peer = peer_model("mujoco", system)
    model, data = peer.model, mujoco.MjData(peer.model)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP  # a step by the acceleration and nothing else
    initial = np.hstack([np.zeros((len(at.q), 1)), at.q[:, peer.places], at.qd[:, peer.order]])
    forces = at.tau[:, None, peer.order].copy()
    applied = int(mujoco.mjtState.mjSTATE_QFRC_APPLIED)

    def call() -> Array:
        state, _ = rollout.rollout(model, [data], initial, forces, control_spec=applied, nstep=1)
        return np.asarray((state[:, 0, 1 + model.nq :] - initial[:, 1 + model.nq :]) / model.opt.timestep)

    return call


PEERS = {"pinocchio": pinocchio_accelerations, "mujoco": mujoco_accelerations}
HOW = {"pinocchio": "theirs a pool", "mujoco": "theirs a step of Euler's in a rollout"}


def _rows(case: str, name: str, peer: str, options: Options) -> Iterable[Row]:
    system = floating_robot(name)
    model = native(system)
    at = floating_states(model, COUNT)
    out = np.empty_like(at.qd)
    timings = side_by_side(
        {
            "ours": partial(model.forward_dynamics_batch, at.q, at.qd, at.tau, out=out),
            "theirs": PEERS[peer](system, at),
        },
        rounds=options.rounds,
    )
    yield Row.timed(
        "floating_forward_dynamics_batch",
        model.n,
        peer,
        timings["ours"].per(COUNT),
        timings["theirs"].per(COUNT),
        case=case,
        note=f"a state, {COUNT} states a call, one thread; ours eight at once, {HOW[peer]}",
        wanted=WANTED,
    )
