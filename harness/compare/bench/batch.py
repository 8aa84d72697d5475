"""Many states at once on one thread: native lanes against Pinocchio's pool, and how two threads scale."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any

import numpy as np

from harness.compare.bench.measure import side_by_side
from harness.compare.bench.peers import Array, Options, States, chain, native, or_skipped, peer_model, robots, states
from harness.compare.bench.row import Row
from harness.compare.bench.single_call import faster
from harness.compare.bench.two_threads import two_threads
from harness.system import System

SIZES = (1, 7, 50, 200)
WANTED = {1: 8.0, 7: 10.0, 50: 10.0, 200: 8.0}
# So many link updates a call that the call itself costs nothing.
WORK = 40_000
# Bytes of matrices a call: those that whoever works on with them would take at once, since they stay in a nearby cache, and
# those that no cache holds.
CACHED, LARGE = 4_000_000, 64_000_000
_LARGE = "_large"
# Joints and states of what two threads share.
SHARED_N, SHARED = 7, 200_000
SHARED_METHODS = ("forward_dynamics", "inverse_dynamics", "mass_matrix")


def run(options: Options) -> Iterator[Row]:
    """Rows for chains and for real robots."""
    mechanisms: list[tuple[str, System, float | None]] = [
        ("chain with general axes", chain(n), WANTED[n]) for n in options.sizes(SIZES)
    ]
    mechanisms += [(name, system, 10.0) for name, system in robots()]
    for case, system, wanted in mechanisms:
        n = len(system.joint_names)
        yield from or_skipped(
            "forward_dynamics_batch", n, "pinocchio", partial(_rows, case, system, wanted, options), case=case
        )
    for what in SHARED_METHODS:
        yield from or_skipped(
            f"{what}_batch_two_threads", SHARED_N, "denoc on one thread", partial(_threads, what, options)
        )


def _threads(what: str, options: Options) -> Iterable[Row]:
    """What a second thread gains, for many states of a chain of seven."""
    from harness.denoc.batch.model import BatchModel

    system = chain(SHARED_N)
    at = states(SHARED_N, SHARED)
    given = (at.q,) if what == "mass_matrix" else (at.q, at.qd, at.tau)
    shape = (SHARED, SHARED_N, SHARED_N) if what == "mass_matrix" else at.q.shape
    one, two = (
        partial(getattr(BatchModel(system, threads=threads), what), *given, out=np.empty(shape)) for threads in (1, 2)
    )
    yield two_threads(
        f"{what}_batch_two_threads",
        SHARED_N,
        one,
        two,
        items=SHARED,
        rounds=options.rounds,
        note=f"a state, {SHARED} states a call",
    )


def pinocchio_batch(system: System, at: States) -> dict[str, Callable[[], object]]:
    """Pinocchio's pool with one thread; there is none for the mass matrix, which is called state by state, the faster way."""
    import pinocchio as pin

    peer = peer_model("pinocchio", system)
    pool = pin.ModelPool(peer.model, 1)
    # Columns are states, and Fortran order makes each contiguous.
    q, qd, tau = (np.asfortranarray(x[:, peer.axes.order].T) for x in (at.q, at.qd, at.tau))
    out = np.zeros_like(q, order="F")
    rows = np.ascontiguousarray(at.q[:, peer.axes.order])

    def forward() -> Array:
        pin.abaInParallel(1, pool, q, qd, tau, out)
        return out

    def inverse() -> Array:
        pin.rneaInParallel(1, pool, q, qd, tau, out)
        return out

    def mass_matrix(convention: pin.Convention) -> None:
        for row in rows:
            pin.crba(peer.model, peer.data, row, convention)

    return {
        "forward_dynamics_batch": forward,
        "inverse_dynamics_batch": inverse,
        "mass_matrix_batch": faster(
            partial(mass_matrix, pin.Convention.LOCAL), partial(mass_matrix, pin.Convention.WORLD)
        ),
    }


def native_batch(system: System, at: States) -> dict[str, Callable[[], object]]:
    """The public methods over (B, n), which write over their first results, as the peer does."""
    model: Any = native(system)
    calls = {
        "forward_dynamics_batch": partial(model.forward_dynamics_batch, at.q, at.qd, at.tau),
        "inverse_dynamics_batch": partial(model.inverse_dynamics_batch, at.q, at.qd, at.tau),
        "mass_matrix_batch": partial(model.mass_matrix_batch, at.q),
    }
    return {what: partial(call, out=call()) for what, call in calls.items()}


def _rows(case: str, system: System, wanted: float | None, options: Options) -> Iterable[Row]:
    n = len(system.joint_names)
    most = max(16, WORK // n // 8 * 8)
    few, many = (max(8, size // (8 * n * n) // 8 * 8) for size in (CACHED, LARGE))
    rows: list[tuple[str, int, float | None]] = [
        ("forward_dynamics_batch", most, wanted),
        ("inverse_dynamics_batch", most, wanted),
        ("mass_matrix_batch", min(most, few), wanted),
    ]
    if n >= 50:
        rows.append(("mass_matrix_batch" + _LARGE, many, None))
    for what, count, ratio in rows:
        at, call = states(n, count), what.removesuffix(_LARGE)
        timings = side_by_side(
            {"ours": native_batch(system, at)[call], "theirs": pinocchio_batch(system, at)[call]}, rounds=options.rounds
        )
        timings = {name: timing.per(count) for name, timing in timings.items()}
        yield Row.timed(
            what,
            n,
            "pinocchio",
            timings["ours"],
            timings["theirs"],
            case=case,
            note=f"a state, {count} states a call, one thread, results overwritten",
            wanted=ratio,
        )
