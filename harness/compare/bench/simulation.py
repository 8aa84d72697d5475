"""Whole simulations: 10 s at 1 kHz against ``mujoco.rollout`` with RK4, on one thread, at no less accuracy."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from typing import Any

import numpy as np

from harness.compare.bench.measure import side_by_side
from harness.compare.bench.peers import Options, chain, native, or_skipped, peer_model
from harness.compare.bench.row import Row
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


def _many(n: int, options: Options) -> Iterable[Row]:
    from harness.denoc.lanes import LaneModel

    system = damped(n)
    q0, qd0 = start(n)
    lanes = LaneModel(system)
    row = lanes.row(system)[None]
    time = np.linspace(0.0, DURATION, round(DURATION / STEP) + 1)
    theirs = rollout(system, q0, qd0)

    rows = np.repeat(row, COPIES, axis=0)

    def ours(settings: dict[str, Any]) -> np.ndarray:
        return np.asarray(lanes.simulate(rows, q0, qd0, time, **settings)[0])

    truth = reference(system, q0[0], qd0[0])
    their_error = float(np.abs(theirs()[0, 99::100] - truth[1:]).max())
    # The lanes adapt their step: as loose as gives the peer's accuracy, or what rounding leaves of it.
    for tolerance in TOLERANCES:
        settings: dict[str, Any] = {"tolerance": tolerance}
        our_error = float(np.abs(ours(settings)[0, ::100] - truth).max())
        if our_error <= max(their_error, ROUNDING):
            break
    same: dict[str, Any] = {"method": "rk4", "step": STEP}
    for what, chosen in (("simulation_many", settings), ("simulation_many_rk4", same)):
        call = partial(ours, chosen)
        our_error = float(np.abs(call()[0, ::100] - truth).max())
        timings = side_by_side({"ours": call, "theirs": theirs}, rounds=max(3, options.rounds // 3))
        per = {name: timing.per(COPIES) for name, timing in timings.items()}
        how = "RK4 at 1 kHz" if chosen is same else "adaptive"
        yield Row(
            what,
            n,
            "mujoco",
            per["ours"].median,
            per["theirs"].median,
            ours_spread=per["ours"].spread,
            theirs_spread=per["theirs"].spread,
            case="damped chain with general axes",
            note=f"a run of {DURATION:g} s sampled at 1 kHz, {COPIES} at once, one thread; {how}, error {our_error:.0e} "
            f"rad, against RK4 at 1 ms, {their_error:.0e} rad",
            wanted=WANTED,
        )


def _one(n: int, options: Options) -> Iterable[Row]:
    system = damped(n)
    q0, qd0 = (x[:1] for x in start(n))
    model = native(system)
    time = np.linspace(0.0, DURATION, round(DURATION / STEP) + 1)
    theirs = rollout(system, q0, qd0)

    def ours(settings: dict[str, Any]) -> np.ndarray:
        return np.asarray(model.simulate(q0[0], qd0[0], time, **settings).position)

    truth = reference(system, q0[0], qd0[0])
    their_error = float(np.abs(theirs()[0, 99::100] - truth[1:]).max())
    same: dict[str, Any] = {"method": "rk4", "step": STEP}
    # The loosest of the adaptive method that is no less accurate; the peer's own method if there is none.
    for settings in [*({"rtol": rtol, "atol": 0.01 * rtol} for rtol in RELATIVE), same]:
        our_error = float(np.abs(ours(settings)[::100] - truth).max())
        if our_error <= max(their_error, ROUNDING):
            break
    for what, chosen in (("simulation_one", settings), ("simulation_one_rk4", same)):
        call = partial(ours, chosen)
        our_error = float(np.abs(call()[::100] - truth).max())
        timings = side_by_side({"ours": call, "theirs": theirs}, rounds=max(3, options.rounds // 3))
        how = "RK4 at 1 kHz" if chosen is same else f"adaptive, rtol {chosen['rtol']:g}"
        yield Row(
            what,
            n,
            "mujoco",
            timings["ours"].median,
            timings["theirs"].median,
            ours_spread=timings["ours"].spread,
            theirs_spread=timings["theirs"].spread,
            case="damped chain with general axes",
            note=f"one run of {DURATION:g} s sampled at 1 kHz; {how}, error {our_error:.0e} rad, against RK4 at 1 ms, "
            f"{their_error:.0e} rad",
            wanted=WANTED,
        )


def _threads(options: Options) -> Iterable[Row]:
    from harness.denoc.lanes import LaneModel

    system = chain(7)
    lanes = LaneModel(system)
    copies = 64
    rng = np.random.default_rng(7)
    rows = np.repeat(lanes.row(system)[None], copies, axis=0)
    q0, time = 0.3 * rng.normal(size=(copies, 7)), np.linspace(0.0, 2.0, 201)
    timings = side_by_side(
        {
            "two": lambda: lanes.simulate(rows, q0, np.zeros_like(q0), time, threads=2),
            "one": lambda: lanes.simulate(rows, q0, np.zeros_like(q0), time, threads=1),
        },
        rounds=max(3, options.rounds // 3),
    )
    yield Row(
        "simulation_two_threads",
        7,
        "denoc on one thread",
        timings["two"].median,
        timings["one"].median,
        ours_spread=timings["two"].spread,
        theirs_spread=timings["one"].spread,
        note=f"{copies} runs of 2 s; the ratio is the gain of the second thread",
        wanted=1.8,
    )
