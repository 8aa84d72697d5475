"""Whether positions go where velocities say, and velocities where accelerations say: an integrator may err in one alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.system import System, Trajectory
from harness.system.manifold import difference

Array = NDArray[np.float64]

# Share of a velocity by which the positions may go otherwise: a difference over two samples knows it no better.
ENOUGH = 0.1
# Of the square of what they leave it by, what a factor may leave.
BY_A_FACTOR = 0.1


def astray(system: System, run: Trajectory) -> tuple[str, float | None] | None:
    """The coordinate whose positions leave its velocity furthest, and how fast they go as a share of it; None where all follow.

    The share is None where it is not by a factor that they leave it, as where they jump.

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
    # The mean of a velocity lies between its least and its largest; what dry friction stops within a sample goes by no rule of
    # quadrature, and is none the less right.
    three = np.array([run.velocity[:-2], run.velocity[1:-1], run.velocity[2:]])
    beyond = np.maximum(np.maximum(gone - three.max(axis=0), three.min(axis=0) - gone), 0.0)
    apart = np.sqrt(np.mean(beyond**2, axis=0)) / np.maximum(size, 1e-3 * size.max(initial=1e-300))
    worst = int(np.argmax(apart))
    if not apart[worst] > ENOUGH:
        return None
    went, due = gone[:, worst], said[:, worst]
    share = float(went @ due / (due @ due)) if due.any() else 0.0
    left, whole = went - share * due, went - due
    return run.names[worst], share if left @ left < BY_A_FACTOR * (whole @ whole) else None


@dataclass(frozen=True)
class Broken:
    """What an integrator does not carry on as it should.

    term: ``position_rates`` (positions from velocities) or ``velocity_rates`` (velocities from accelerations). coordinate: the
    worst. left: what the motion lacks of the integral at most [rad or m; rad/s or m/s]. order: by which power of the step that
    falls.
    """

    term: str
    coordinate: str
    left: float
    order: float

    def sentence(self) -> str:
        a, b = ("positions", "velocities") if self.term == "position_rates" else ("velocities", "accelerations")
        return (
            f"the {a} of {self.coordinate} do not go where its {b} say: off by {self.left:.1e}, which falls by the step's "
            f"power {max(self.order, 0.0):.1f} where it is halved"
        )


def broken(
    system: System,
    run: Callable[[float], Trajectory],
    acceleration: Callable[[Array, Array], Array],
    step: float,
    *,
    order: float,
    allowed: float,
) -> Broken | None:
    """Which of the two quadratures of an integrator with a fixed step is wrong; None where each is of the order that is due.

    Of a method of order p the motion lacks of the integral of its own velocities, by Simpson's rule over two steps at a time, what
    falls by the step's power p, or 4 where p is larger, for so does Simpson's error (Hairer, Nørsett & Wanner, Solving Ordinary
    Differential Equations I, § II.8: what a method gives is the flow of an equation that is off by the step's power p). A wrong
    weight leaves more, which falls slower; the one that falls slowest is wrong, the other follows it.

    run: of the motion with that step, sampled at every one. acceleration: at a position and velocity, of forces that act in the
    run. allowed: what is not worth a word.
    """
    due = min(order, 4.0)
    lacks = []
    for length in (step, 0.5 * step):
        motion = run(length)
        if len(motion.time) < 3 or not (np.isfinite(motion.position).all() and np.isfinite(motion.velocity).all()):
            return None
        pushed = np.array([acceleration(q, v) for q, v in zip(motion.position, motion.velocity, strict=True)])
        ends = range(0, len(motion.time) - 2, 2)
        gone = np.array([difference(system, motion.position[k], motion.position[k + 2]) for k in ends])
        sped = motion.velocity[2::2][: len(gone)] - motion.velocity[:-2:2]
        lacks.append([_drift(gone, motion.velocity, length), _drift(sped, pushed, length)])
    found = []
    for term, coarse, fine in zip(("position_rates", "velocity_rates"), *lacks, strict=True):
        worst = int(np.argmax(coarse))
        if coarse[worst] <= allowed:
            continue
        falls = float(np.log2(coarse[worst] / max(fine[worst], 1e-300)))
        # Halfway to an order less, so that higher terms, which still show at this step, are not taken for one.
        if falls < due - 0.5:
            found.append(Broken(term, motion.names[worst], float(coarse[worst]), falls))
    return min(found, key=lambda one: one.order, default=None)


def _drift(gone: Array, rate: Array, step: float) -> Array:
    """Largest sum of what each pair of steps lacks of the integral of its rate, by coordinate."""
    said = step / 3.0 * (rate[:-2:2] + 4.0 * rate[1:-1:2] + rate[2::2])
    return np.abs(np.cumsum(gone - said[: len(gone)], axis=0)).max(axis=0)
