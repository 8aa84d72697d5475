"""Whether the positions of a motion go where its velocities say: an integrator may err in that alone."""

from __future__ import annotations

import numpy as np

from harness.system import System, Trajectory
from harness.system.manifold import difference

# Share of a velocity by which the positions may go otherwise: a difference over two samples knows it no better.
ENOUGH = 0.1


def astray(system: System, run: Trajectory) -> tuple[str, float] | None:
    """The coordinate whose positions leave its velocity furthest, and how fast they go as a share of it; None where all follow.

    run: with at least three even samples, close enough together that velocities change little from one to the next.
    """
    if len(run.time) < 3 or not (np.isfinite(run.position).all() and np.isfinite(run.velocity).all()):
        return None
    span = run.time[2:] - run.time[:-2]
    pairs = zip(run.position[:-2], run.position[2:], strict=True)
    gone = np.array([difference(system, before, after) for before, after in pairs]) / span[:, None]
    # As Simpson's rule has it: exact where velocities change with the cube of time.
    said = (run.velocity[:-2] + 4.0 * run.velocity[1:-1] + run.velocity[2:]) / 6.0
    size = np.sqrt(np.mean(said**2, axis=0))
    apart = np.sqrt(np.mean((gone - said) ** 2, axis=0)) / np.maximum(size, 1e-3 * size.max(initial=1e-300))
    worst = int(np.argmax(apart))
    if not apart[worst] > ENOUGH:
        return None
    return run.names[worst], float(gone[:, worst] @ said[:, worst] / (said[:, worst] @ said[:, worst]))
