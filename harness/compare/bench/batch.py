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
from harness.system import System

SIZES = (1, 7, 50, 200)
WANTED = {1: 8.0, 7: 10.0, 50: 10.0, 200: 8.0}
# So many link updates a call that the call itself costs nothing.
WORK = 40_000


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


def pinocchio_batch(system: System, at: States) -> dict[str, Callable[[], object]]:
    """Pinocchio's pool with one thread; there is none for the mass matrix, which is called state by state, the faster way."""
    import pinocchio as pin

    peer = peer_model("pinocchio", system)
    pool = pin.ModelPool(peer.model, 1)
    # Columns are states, and Fortran order makes each contiguous.
    q, qd, tau = (np.asfortranarray(x[:, peer.order].T) for x in (at.q, at.qd, at.tau))
    out = np.zeros_like(q, order="F")
    rows = np.ascontiguousarray(at.q[:, peer.order])

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
    """The public methods over (B, n)."""
    model: Any = native(system)
    return {
        "forward_dynamics_batch": lambda: model.forward_dynamics_batch(at.q, at.qd, at.tau),
        "inverse_dynamics_batch": lambda: model.inverse_dynamics_batch(at.q, at.qd, at.tau),
        "mass_matrix_batch": lambda: model.mass_matrix_batch(at.q),
    }


def _rows(case: str, system: System, wanted: float | None, options: Options) -> Iterable[Row]:
    n = len(system.joint_names)
    count = max(16, WORK // n // 8 * 8)
    at = states(n, count)
    ours, theirs = native_batch(system, at), pinocchio_batch(system, at)
    for what in ours:
        if what == "mass_matrix_batch" and n * n * count > 2e7:
            continue
        timings = side_by_side({"ours": ours[what], "theirs": theirs[what]}, rounds=options.rounds)
        timings = {name: timing.per(count) for name, timing in timings.items()}
        yield Row(
            what,
            n,
            "pinocchio",
            timings["ours"].median,
            timings["theirs"].median,
            ours_spread=timings["ours"].spread,
            theirs_spread=timings["theirs"].spread,
            case=case,
            note=f"a state, {count} states a call, one thread",
            wanted=wanted if what != "mass_matrix_batch" else None,
        )
