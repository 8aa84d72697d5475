"""How the cost of closed mechanisms' accelerations grows: with the tree around one loop, and with how many loops there are."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from time import process_time
from typing import Any

import numpy as np

from harness.compare.bench.measure import side_by_side
from harness.compare.bench.peers import Array, Options, chain, native, or_skipped, peer_model
from harness.compare.bench.row import Row
from harness.compare.bench.scaling import exponent
from harness.compare.four_bars import four_bars
from harness.system import Frame, Loop, System
from harness.system.description import constant
from harness.system.kinematics import poses
from harness.system.lowering import lower

PEER = "pinocchio"
# Links of a chain that its loop goes around.
AROUND = 4


def ring(n: int) -> System:
    """A chain of ``n`` revolute joints whose last link is held by a ball joint to the link four before it: three conditions."""
    tree = chain(n)
    at = poses(lower(tree), np.zeros(n))
    first, second = tree.links[-1].name, tree.links[-1 - AROUND].name
    still, place = constant(np.eye(3)), constant([0.1, 0.05, 0.02])
    met = at[first].at(np.asarray(place), np.eye(3)).origin - at[second].origin
    frames = Frame(first, place, still), Frame(second, constant(at[second].rotation.T @ met), still)
    return replace(tree, loops=(Loop("ring", *frames, ("x", "y", "z")),))


def leaning(system: System) -> Array:
    """Positions of four-bars side by side whose cranks lean by 0.3 rad and whose bars stay level."""
    return np.array([0.3 if name.startswith("crank") else -0.3 for name in system.coordinate_names])


@dataclass(frozen=True)
class Growth:
    """What grows: its row, mechanism by size, sizes, and a closed position of it."""

    row: str
    title: str
    build: Callable[[int], System]
    sizes: tuple[int, ...]
    position: Callable[[System], Array]
    note: str


GROWTHS = (
    Growth(
        "loop_tree_exponent",
        "a chain of n joints with one loop",
        ring,
        (10, 30, 50, 100, 200),
        lambda system: np.zeros(system.nq),
        "three conditions at the cut, whatever n is",
    ),
    Growth(
        "loop_count_exponent",
        "N four-bars side by side",
        four_bars,
        (2, 5, 10, 20, 40),
        leaning,
        "two conditions at each of N cuts, 2 N + 1 joints; theirs with the third that says nothing in a plane",
    ),
)


def run(options: Options) -> Iterator[Row]:
    """Exponents, and the cost at each size."""
    for growth in GROWTHS:
        yield from or_skipped(growth.row, None, PEER, partial(_rows, growth, options), case=growth.title)


def _calls(system: System, q: Array) -> dict[str, Callable[[], Any]]:
    """Accelerations of both from the same closed state, without what their adapters add."""
    import pinocchio as pin

    model, peer = native(system), peer_model(PEER, system)
    qd = model.closed_velocity(q, np.full(model.n, 0.1))
    tau = np.zeros(model.n)
    theirs = peer._q(q), peer.axes.into(q, qd), tau.copy()
    exact = pin.ProximalSettings(1e-12, 1e-9, 20)
    return {
        "ours": partial(model.forward_dynamics, q, qd, tau),
        "theirs": lambda: pin.constraintDynamics(peer.model, peer.data, *theirs, peer.constraints, peer.states, exact),
    }


def _rows(growth: Growth, options: Options) -> Iterable[Row]:
    taken: dict[int, dict[str, float]] = {}
    for size in growth.sizes[:3] if options.quick else growth.sizes:
        system = growth.build(size)
        timings = side_by_side(_calls(system, growth.position(system)), rounds=options.rounds, clock=process_time)
        taken[system.nv] = {name: timing.median for name, timing in timings.items()}
    ours, theirs = ([each[name] for each in taken.values()] for name in ("ours", "theirs"))
    yield Row(
        growth.row,
        None,
        PEER,
        exponent(taken, ours),
        exponent(taken, theirs),
        unit="1",
        case=growth.title,
        note=f"cost grows as n to this power, n = {min(taken)}…{max(taken)} joints; {growth.note}",
    )
    for n, each in taken.items():
        yield Row("loop_scaling", n, PEER, each["ours"], each["theirs"], case=growth.title, note=growth.note)
