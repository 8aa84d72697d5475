"""A planar four-bar mechanism's motion against Exudyn's and MuJoCo's, ours at no greater error."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from typing import Any

import numpy as np

from harness.compare.bench.measure import side_by_side
from harness.compare.bench.peers import Options, native, or_skipped, peer_model
from harness.compare.bench.row import Row
from harness.system import Frame, Joint, JointType, Link, Loop, System
from harness.system.description import constant

DURATION, SAMPLES = 1.0, 101
# Steps [s] of the peers' runs.
STEPS = {"exudyn": 1e-3, "mujoco": 1e-4}
WANTED = {"exudyn": 20.0, "mujoco": None}
RELATIVE = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)


def run(options: Options) -> Iterator[Row]:
    """One run of one second."""
    for peer in STEPS:
        yield from or_skipped("four_bar", 3, peer, partial(_rows, peer, options))


def four_bar() -> System:
    """Rods of 0.1, 0.3 and 0.2 m on a base of 0.3 m, in the plane x, z; the first goes right round."""

    def rod(name: str, length: float, along: int) -> Link:
        com, turn = np.zeros(3), np.full(3, length**2 / 12.0)
        com[along], turn[along] = 0.5 * length, 1e-6
        return Link(name, mass=length, com=constant(com), inertia=constant(np.diag(length * turn)))

    def hinge(name: str, parent: str, child: str, x: float) -> Joint:
        axis, place = constant([0.0, 1.0, 0.0]), constant([x, 0.0, 0.0])
        return Joint(name, JointType.REVOLUTE, parent, child, xyz=place, axis=axis)

    still = constant(np.eye(3))
    joints = (hinge("a", "base", "crank", 0.0), hinge("b", "crank", "coupler", 0.1), hinge("c", "base", "rocker", 0.3))
    frames = Frame("coupler", constant([0.3, 0, 0]), still), Frame("rocker", constant([0, 0, 0.2]), still)
    links = (rod("crank", 0.1, 0), rod("coupler", 0.3, 0), rod("rocker", 0.2, 2))
    return System("four-bar", joints, links, loops=(Loop("pin", *frames, ("x", "z")),))


def _rows(peer: str, options: Options) -> Iterable[Row]:
    system = four_bar()
    theirs, model = peer_model(peer, system), native(system)
    q = model.assemble(np.array([0.3, 0.0, 0.0]), held=["a"])
    qd = model.closed_velocity(q, np.array([10.0, 0.0, 0.0]))
    time = np.linspace(0.0, DURATION, SAMPLES)
    truth = model.simulate(q, qd, time, rtol=1e-13, atol=1e-14).position

    def ours(rtol: float) -> Any:
        return model.simulate(q, qd, time, rtol=rtol, atol=0.01 * rtol).position

    def by_peer() -> Any:
        return theirs.simulate(q, qd, time, step=STEPS[peer]).position

    error = float(np.abs(by_peer() - truth).max())
    good = [rtol for rtol in RELATIVE if np.abs(ours(rtol) - truth).max() <= error]
    rtol = good[0] if good else RELATIVE[-1]
    own = float(np.abs(ours(rtol) - truth).max())
    timings = side_by_side({"ours": partial(ours, rtol), "theirs": by_peer}, rounds=options.rounds)
    yield Row.timed(
        "four_bar",
        3,
        peer,
        timings["ours"],
        timings["theirs"],
        case="planar four-bar mechanism",
        note=f"{DURATION:g} s, errors {own:.0e} and {error:.0e} rad, {peer} at {1e3 * STEPS[peer]:g} ms",
        wanted=WANTED[peer],
    )
