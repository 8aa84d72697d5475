"""Whole simulations: 10 s at 1 kHz against ``mujoco.rollout`` with RK4, on one thread, at no less accuracy."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np

from harness.compare.bench.measure import side_by_side
from harness.compare.bench.peers import Options, chain, native, or_skipped, peer_model
from harness.compare.bench.row import Row
from harness.compare.bench.two_threads import two_threads
from harness.system import System

SIZES = (1, 7)
DURATION, STEP = 10.0, 1e-3
COPIES = 16
# Of the lanes' error estimate [rad]; and what ten thousand steps leave of sixteen digits [rad].
TOLERANCES = (1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13)
ROUNDING = 1e-12
# Of one run, by Denoc.simulate.
RELATIVE = (1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
WANTED = 5.0

Settings = dict[str, Any]
"""Of a simulation: keywords of ``Denoc.simulate`` and of ``LaneModel.simulate``."""


def run(options: Options) -> Iterator[Row]:
    """One run, and many runs at once."""
    for n in SIZES:
        yield from or_skipped("simulation_many", n, "mujoco", partial(_many, n, options))
        yield from or_skipped("simulation_one", n, "mujoco", partial(_one, n, options))
    yield from or_skipped("simulation_two_threads", 7, "denoc on one thread", partial(_threads, options))


def start(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Initial states of the copies, (COPIES, n): gentle swings, so that trajectories can be compared."""
    rng = np.random.default_rng(n)
    return 0.3 * rng.normal(size=(COPIES, n)), np.zeros((COPIES, n))


def damped(n: int) -> System:
    """A chain with joint damping, so that its motion is not chaotic over ten seconds."""
    from harness.system.random_systems import random_chain

    return random_chain(n, 1, prismatic=0.0, armature=True, damping=True)


def rollout(system: System, q0: np.ndarray, qd0: np.ndarray) -> Any:
    """A call that runs all copies in ``mujoco.rollout`` on one thread and returns positions (B, T, n)."""
    import mujoco
    from mujoco import rollout as rolling

    peer = peer_model("mujoco", system)
    model, data = peer.model, mujoco.MjData(peer.model)
    model.opt.timestep = STEP
    initial = np.hstack([np.zeros((len(q0), 1)), q0[:, peer.order], qd0[:, peer.order]])
    steps = round(DURATION / STEP)

    def call() -> np.ndarray:
        state, _ = rolling.rollout(model, [data], initial, nstep=steps)
        positions = np.empty((len(q0), steps, len(peer.order)))
        positions[:, :, peer.order] = state[:, :, 1 : 1 + len(peer.order)]
        return positions

    return call


def reference(system: System, q0: np.ndarray, qd0: np.ndarray) -> np.ndarray:
    """Positions of the first copy every 0.1 s by MuJoCo's RK4 at a tenth of the step, (T, n)."""
    return np.asarray(peer_model("mujoco", system).simulate(q0, qd0, _coarse(), step=STEP / 10.0).position)


def _coarse() -> np.ndarray:
    return np.linspace(0.0, DURATION, 101)


def _fine() -> np.ndarray:
    return np.linspace(0.0, DURATION, round(DURATION / STEP) + 1)


def _many(n: int, options: Options) -> Iterable[Row]:
    from harness.denoc.lanes.model import LaneModel

    system = damped(n)
    q0, qd0 = start(n)
    lanes = LaneModel(system)
    rows = np.repeat(lanes.row(system)[None], COPIES, axis=0)

    def ours(settings: Settings) -> np.ndarray:
        return np.asarray(lanes.simulate(rows, q0, qd0, _fine(), **settings)[0])

    adaptive = [Settings(tolerance=tolerance) for tolerance in TOLERANCES]
    how = f"a run of {DURATION:g} s sampled at 1 kHz, {COPIES} at once, one thread"
    return _rows("simulation_many", system, (q0, qd0), ours, adaptive, how, options)


def _one(n: int, options: Options) -> Iterable[Row]:
    system = damped(n)
    q0, qd0 = (x[:1] for x in start(n))
    model = native(system)

    def ours(settings: Settings) -> np.ndarray:
        return np.asarray(model.simulate(q0[0], qd0[0], _fine(), **settings).position)[None]

    adaptive = [Settings(rtol=rtol, atol=0.01 * rtol) for rtol in RELATIVE]
    how = f"one run of {DURATION:g} s sampled at 1 kHz"
    return _rows("simulation_one", system, (q0, qd0), ours, adaptive, how, options)


def _rows(
    what: str,
    system: System,
    begun: tuple[np.ndarray, np.ndarray],
    ours: Callable[[Settings], np.ndarray],
    adaptive: Sequence[Settings],
    how: str,
    options: Options,
) -> Iterator[Row]:
    """A row for the loosest of the adaptive settings that is no less accurate than the peer, and one for the peer's own method.

    begun: positions and velocities (B, n). ours: positions (B, T, n) by settings. The peer's own method stands for the adaptive one
    too, if no setting of that is accurate enough.
    """
    theirs = rollout(system, *begun)
    truth = reference(system, begun[0][0], begun[1][0])
    their_error = float(np.abs(theirs()[0, 99::100] - truth[1:]).max())

    def error(settings: Settings) -> float:
        return float(np.abs(ours(settings)[0, ::100] - truth).max())

    same = Settings(method="rk4", step=STEP)
    loosest = next((s for s in adaptive if error(s) <= max(their_error, ROUNDING)), same)
    copies = len(begun[0])
    for name, chosen in ((what, loosest), (f"{what}_rk4", same)):
        timings = side_by_side({"ours": partial(ours, chosen), "theirs": theirs}, rounds=max(3, options.rounds // 3))
        per = {side: timing.per(copies) for side, timing in timings.items()}
        method = "RK4 at 1 kHz" if chosen is same else "adaptive, " + ", ".join(f"{k} {v:g}" for k, v in chosen.items())
        yield Row.timed(
            name,
            len(system.joint_names),
            "mujoco",
            per["ours"],
            per["theirs"],
            case="damped chain with general axes",
            note=f"{how}; {method}, error {error(chosen):.0e} rad, against RK4 at 1 ms, {their_error:.0e} rad",
            wanted=WANTED,
        )


def _threads(options: Options) -> Iterable[Row]:
    from harness.denoc.lanes.model import LaneModel

    system = chain(7)
    lanes = LaneModel(system)
    copies = 64
    rng = np.random.default_rng(7)
    rows = np.repeat(lanes.row(system)[None], copies, axis=0)
    q0, time = 0.3 * rng.normal(size=(copies, 7)), np.linspace(0.0, 2.0, 201)
    still = np.zeros_like(q0)
    yield two_threads(
        "simulation_two_threads",
        7,
        lambda: lanes.simulate(rows, q0, still, time, threads=1),
        lambda: lanes.simulate(rows, q0, still, time, threads=2),
        items=1,
        rounds=max(3, options.rounds // 3),
        note=f"{copies} runs of 2 s",
    )
