"""Many states of floating robots at once on one thread, against Pinocchio's pool."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from importlib import metadata
from pathlib import Path

import numpy as np

from harness.compare.bench.measure import side_by_side
from harness.compare.bench.peers import Options, native, or_skipped, peer_model
from harness.compare.bench.row import Row
from harness.system.load import load

ROBOTS = {"quadruped": "anymal.urdf", "humanoid": "talos_reduced.urdf"}
COUNT = 512
WANTED = 10.0


def run(options: Options) -> Iterator[Row]:
    """A quadruped and a humanoid of example-robot-data."""
    for case, file in ROBOTS.items():
        measure = partial(_rows, f"floating {case}, {file}", file, options)
        yield from or_skipped("floating_forward_dynamics_batch", None, "pinocchio", measure, case=file)


def _rows(case: str, name: str, options: Options) -> Iterable[Row]:
    import pinocchio as pin

    found = [file for file in metadata.files("example-robot-data") or [] if file.name == name]
    system = load(Path(str(found[0].locate())), physical=False, floating=True)
    model, peer = native(system), peer_model("pinocchio", system)
    rng = np.random.default_rng(0)
    q = np.array([model.integrate(model.neutral, rng.normal(size=model.n)) for _ in range(COUNT)])
    qd, tau = rng.normal(size=(COUNT, model.n)), rng.normal(size=(COUNT, model.n))
    out = np.empty_like(qd)
    pool = pin.ModelPool(peer.model, 1)
    positions = np.asfortranarray(q[:, peer.axes.places].T)
    speeds, forces = (np.asfortranarray(x[:, peer.axes.order].T) for x in (qd, tau))
    theirs = np.zeros_like(speeds, order="F")
    timings = side_by_side(
        {
            "ours": partial(model.forward_dynamics_batch, q, qd, tau, out=out),
            "theirs": partial(pin.abaInParallel, 1, pool, positions, speeds, forces, theirs),
        },
        rounds=options.rounds,
    )
    yield Row.timed(
        "floating_forward_dynamics_batch",
        model.n,
        "pinocchio",
        timings["ours"].per(COUNT),
        timings["theirs"].per(COUNT),
        case=case,
        note=f"a state, {COUNT} states a call, one thread; ours eight at once",
        wanted=WANTED,
    )
