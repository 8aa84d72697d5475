"""How the cost of forward dynamics grows with the number of coordinates, in time and in memory."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial

import numpy as np

from harness.compare.bench.measure import in_child, side_by_side
from harness.compare.bench.peers import Options, chain, or_skipped, states
from harness.compare.bench.row import Row
from harness.compare.bench.single_call import mujoco_calls, native_calls, pinocchio_calls

SIZES = {"denoc": (10, 30, 100, 300, 1000), "pinocchio": (10, 30, 100, 200), "mujoco": (10, 30, 100, 300, 1000)}

_MANY = """
import numpy as np
from time import perf_counter
from harness.denoc import Denoc
from harness.system.random_systems import random_chain
n = {n}
model = Denoc(random_chain(n, 1, prismatic=0.0, armature=True))
rng = np.random.default_rng(n)
q, qd, tau = rng.uniform(-3, 3, n), 0.01 * rng.normal(size=n), rng.normal(size=n)
model.forward_dynamics(q, qd, tau)
before = _peak()
start = perf_counter()
for _ in range({calls}):
    qdd = model.forward_dynamics(q, qd, tau)
answer = dict(call=(perf_counter() - start) / {calls}, grew=_peak() - before, finite=bool(np.all(np.isfinite(qdd))))
"""


def run(options: Options) -> Iterator[Row]:
    """The exponents side by side, then n = 10 000 and what it takes in memory."""
    for peer in ("pinocchio", "mujoco"):
        yield from or_skipped("forward_dynamics_exponent", None, peer, partial(_exponent, peer, options))
    yield from or_skipped("forward_dynamics_memory", 10_000, "denoc at n = 1", _memory)


def exponent(sizes: Iterable[int], seconds: Iterable[float]) -> float:
    """Slope of log(seconds) over log(n), by least squares."""
    return float(np.polyfit(np.log(list(sizes)), np.log(list(seconds)), 1)[0])


def cost(calls: Callable[..., dict[str, Callable[[], object]]], sizes: Iterable[int], rounds: int) -> dict[int, float]:
    """Median seconds of one forward dynamics call by size."""
    return {
        n: side_by_side({"it": calls(chain(n), states(n, 1))["forward_dynamics"]}, rounds=rounds)["it"].median
        for n in sizes
    }


def _exponent(peer: str, options: Options) -> Iterable[Row]:
    theirs_calls = pinocchio_calls if peer == "pinocchio" else mujoco_calls
    ours = cost(native_calls, options.sizes(SIZES["denoc"]), options.rounds)
    theirs = cost(theirs_calls, options.sizes(SIZES[peer]), options.rounds)
    yield Row(
        "forward_dynamics_exponent",
        None,
        peer,
        exponent(ours, ours.values()),
        exponent(theirs, theirs.values()),
        unit="1",
        note=f"cost grows as n to this power; n = {min(ours)}…{max(ours)}, {peer} n = {min(theirs)}…{max(theirs)}",
    )
    for n, seconds in ours.items():
        yield Row("forward_dynamics_scaling", n, peer, seconds, theirs.get(n), note="for the plot of cost over size")


def _memory() -> Iterable[Row]:
    small, large = (in_child(_MANY.format(n=n, calls=calls)) for n, calls in ((1, 200), (10_000, 20)))
    if not large.answer["finite"]:
        raise RuntimeError("n = 10 000 did not give finite accelerations")
    yield Row(
        "forward_dynamics_memory",
        10_000,
        "denoc at n = 1",
        large.memory,
        small.memory,
        unit="MB",
        note=f"peak of a whole process; grew by {large.answer['grew']:.2f} MB over 20 calls; one call "
        f"{large.answer['call'] * 1e3:.2f} ms",
    )
