"""One call from Python: forward dynamics, inverse dynamics, mass matrix of chains with general joint axes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any

import numpy as np

from harness.compare.bench.measure import side_by_side
from harness.compare.bench.peers import Options, States, chain, native, or_skipped, peer_model, states
from harness.compare.bench.row import Row
from harness.system import System

SIZES = (1, 7, 50, 200, 500, 1000)
# Ratios aimed at against pin.aba: 1/0.8 for n = 1, 1/0.4 above.
WANTED = {1: 1.25}
WANTED_ABOVE = 2.5


def pinocchio_calls(system: System, at: States) -> dict[str, Callable[[], object]]:
    """The bare calls, in both of its conventions where it has two; none of our adapter is in them."""
    import pinocchio as pin

    peer = peer_model("pinocchio", system)
    model, data, order = peer.model, peer.data, peer.axes.order
    q, qd, tau = at.q[0][order], at.qd[0][order], at.tau[0][order]
    return {
        "forward_dynamics": faster(
            lambda: pin.aba(model, data, q, qd, tau, pin.Convention.LOCAL),
            lambda: pin.aba(model, data, q, qd, tau, pin.Convention.WORLD),
        ),
        "inverse_dynamics": lambda: pin.rnea(model, data, q, qd, tau),
        "mass_matrix": faster(
            lambda: pin.crba(model, data, q, pin.Convention.LOCAL),
            lambda: pin.crba(model, data, q, pin.Convention.WORLD),
        ),
    }


def mujoco_calls(system: System, at: States) -> dict[str, Callable[[], object]]:
    """The bare calls; the state stands in MjData already."""
    import mujoco

    peer = peer_model("mujoco", system)
    model, data = peer.model, peer.data
    data.qpos[:], data.qvel[:] = at.q[0][peer.order], at.qd[0][peer.order]
    data.qfrc_applied[:] = at.tau[0][peer.order]
    full = np.zeros((model.nv, model.nv))

    def mass_matrix() -> None:
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fullM(model, data, full)

    return {
        "forward_dynamics": lambda: mujoco.mj_forward(model, data),
        "inverse_dynamics": lambda: mujoco.mj_inverse(model, data),
        "mass_matrix": mass_matrix,
    }


def native_calls(system: System, at: States) -> dict[str, Callable[[], object]]:
    """The public methods, checks of the arguments included."""
    model: Any = native(system)
    q, qd, tau = (np.ascontiguousarray(x[0]) for x in (at.q, at.qd, at.tau))
    return {
        "forward_dynamics": lambda: model.forward_dynamics(q, qd, tau),
        "inverse_dynamics": lambda: model.inverse_dynamics(q, qd, tau),
        "mass_matrix": lambda: model.mass_matrix(q),
    }


PEERS = {"pinocchio": pinocchio_calls, "mujoco": mujoco_calls}


def run(options: Options) -> Iterator[Row]:
    """Rows for every size, quantity and peer."""
    for n in options.sizes(SIZES):
        for peer in PEERS:
            yield from or_skipped("forward_dynamics", n, peer, partial(_rows, n, peer, options))


def _rows(n: int, peer: str, options: Options) -> Iterable[Row]:
    system, at = chain(n), states(n, 1)
    ours, theirs = native_calls(system, at), PEERS[peer](system, at)
    for what in ours:
        if n > 200 and what != "forward_dynamics":
            continue
        timings = side_by_side({"ours": ours[what], "theirs": theirs[what]}, rounds=options.rounds)
        wanted = WANTED.get(n, WANTED_ABOVE) if peer == "pinocchio" and what == "forward_dynamics" else None
        yield Row.timed(
            what,
            n,
            peer,
            timings["ours"],
            timings["theirs"],
            case="chain with general axes",
            note="one call from Python",
            wanted=wanted,
        )


def faster(first: Callable[[], object], second: Callable[[], object]) -> Callable[[], object]:
    """The faster of two ways that a peer has for the same thing."""
    timings = side_by_side({"first": first, "second": second}, rounds=5, round_seconds=0.005)
    return first if timings["first"].median <= timings["second"].median else second
