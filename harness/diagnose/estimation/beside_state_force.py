"""A set of laws and a force over the state fitted together, by free runs with the force acting in them.

How likely recordings are with the force integrated out (``estimation.state_force``) is known where channels answer to it linearly.
They do along the motion that was recorded, and a set that leaves much out moves otherwise. So the likeliest force is pushed, the
set fitted beside it, and what these runs leave is looked at again: Gauss–Newton steps to the mode of forces and numbers together,
about which the likelihood is integrated (Laplace's method; Tierney and Kadane, J. Am. Stat. Assoc. 81 (1986) 82).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.discrepancy import profiled, responses
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.linear_response import over_each_step
from harness.diagnose.estimation.linearisation import Linearisation, linearise
from harness.diagnose.estimation.objective import LOST, Objective, States
from harness.diagnose.estimation.state_force import Force, Likeliest, Numbers, StateForce, Sums, over_the_state
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]

ROUNDS = 8  # of pushing the likeliest force and looking again
FAR = 2.0  # times the noise's variance left, from which on a set is begun where it follows the recorded motion
ENOUGH = 1.0  # of the surprise, that a further round has to promise
MOST_STEPS = 6  # of a fit beside a force that is not the last one yet
CLOSER = 6  # times that the motion which forces act along is brought nearer to the recordings
CLOSELY = 0.9  # of what is left (squares), above which that has come to an end
STUCK = 1e-2  # of what joints usually answer to a force, below which they do not
SHORTER = 0.3  # of a step that has led nowhere
NEAR = 1e-2  # how stiffly numbers of effects are held where they stand, in the fit's own coordinates: what is not told stays


@dataclass(frozen=True, eq=False)
class Beside:
    """A set beside the force that it leaves out.

    surprise: −2 log of how likely the recordings are, that of the nominal quantities' deviations included, up to a constant. x,
    states: where the set's numbers are likeliest; nodes, shape: the force there, None where none is likelier. residuals: (M,) by
    window.
    """

    surprise: float
    x: Array
    states: Mapping[Window, Array]
    predictor: Predictor
    residuals: tuple[Array, ...]
    nodes: Array | None = None
    shape: Force | None = None


def beside(force: StateForce, objective: Objective, fitted: Fit, held: NDArray[np.bool_]) -> Beside:
    """The set of a fit and the force that it leaves out, together. objective: of its windows under the sensors' noise.

    held: numbers that do not move, (P,).
    """
    predictor = objective.predictor
    at = linearise(objective, fitted.x, fitted.states, upper=objective.bounds()[1], fixed=held)
    if at.cost >= LOST:
        return Beside(np.inf, fitted.x, fitted.states, predictor, at.residuals)
    sums = _sums(force, objective, fitted.x, at, None)
    alone = best = Beside(force.without(sums), fitted.x, fitted.states, predictor, at.residuals)
    nodes, aim = np.zeros(len(force.joint)), force.likeliest(sums)

    def pushed(nodes: Array, x: Array, states: States) -> tuple[Objective, Fit]:
        with_force = replace(objective, predictor=predictor.pushed(force.pushes(-nodes)))
        loud = float(np.mean(aim.force.louder * force.together))
        return with_force, fit(with_force, x, states, fixed=held, most_steps=MOST_STEPS, enough=0.2 * loud, louder=loud)

    def aimed() -> Likeliest:
        here = replace(objective, predictor=best.predictor)
        return force.likeliest(_sums(force, here, best.x, at, nodes), best.shape)

    if np.any(sums.left > FAR * sums.counts) and (begun := _tracking(force, objective, fitted)) is not None:
        there, after = pushed(*begun)
        if after.cost < at.cost:
            # The force there is as rough as readings are; what it says is known after a step from there.
            best = Beside(np.inf, after.x, after.states, there.predictor, after.linear.residuals)
            at, nodes = after.linear, begun[0]
            aim = aimed()
    share, own = 1.0, False
    for _ in range(ROUNDS):
        if best.surprise - aim.value < ENOUGH:
            break
        ahead = nodes + share * (aim.nodes - nodes)
        there, after = pushed(ahead, best.x, best.states)
        shapes = [aim.force] if best.shape is None else [aim.force, best.shape]
        found = _held(force, there, after, ahead, shapes)
        if found.surprise < best.surprise:
            best, at, nodes, share = found, after.linear, ahead, 1.0
            aim = aimed()
        elif not own:
            # This set moves otherwise than the one that answers are along.
            own, moving = True, replace(fitted, x=best.x, states=best.states, linear=at)
            force = force.along(best.predictor, objective.likelihood, moving)
            aim = aimed()
        else:
            share *= SHORTER
    return min(alone, best, key=lambda b: b.surprise)


def along_the_recordings(
    objective: Objective, fitted: Fit, held: NDArray[np.bool_], torque: float, period: float
) -> StateForce | None:
    """Forces over the state along the motion of a fit with what it leaves out made up for; None where channels do not answer
    linearly.

    torque: natural size [N·m]; period: of the slowest swing [s].
    """
    force, cost = None, np.inf
    predictor, near = objective.predictor, fitted
    for _ in range(CLOSER):
        found = responses(predictor, objective.likelihood, near, torque, period)
        again = None if found is None else over_the_state(found)
        if again is None:
            break
        force, moved = again, beside(again, objective, fitted, held)
        left = sum(float(r @ r) for r in moved.residuals)
        if moved.nodes is None or left > CLOSELY * cost:
            break
        predictor, near, cost = moved.predictor, replace(fitted, x=moved.x, states=moved.states), left
    return force


def _held(force: StateForce, pushed: Objective, after: Fit, nodes: Array, shapes: Sequence[Force]) -> Beside:
    """The set and the force at the nodes as runs with it leave them, under the likelier one of these shapes."""
    surprise, best = np.inf, None
    if after.cost < LOST:
        sums = _sums(force, pushed, after.x, after.linear, None)
        # On the way there noise is as loud as what is left.
        louder = np.maximum(sums.left / sums.counts, 1.0)
        rows = [(force.held(sums, nodes, own), own) for own in (replace(shape, louder=louder) for shape in shapes)]
        surprise, best = min(rows, key=lambda row: row[0])
    return Beside(surprise, after.x, after.states, pushed.predictor, after.linear.residuals, nodes, best)


def _tracking(force: StateForce, objective: Objective, fitted: Fit) -> tuple[Array, Array, States] | None:
    """The force at the nodes, less than nothing, with which a set as stated follows the motions that answers are along: where to
    begin for one that moves otherwise by itself. With its numbers and initial states; None where it has other coordinates.

    One step at a time from the states of the motion, and what is missing at its end (an inverse simulation).
    """
    predictor, hypothesis = objective.predictor, objective.hypothesis
    mechanism = predictor.mechanism(hypothesis)
    model = mechanism.model
    x = fitted.x.copy()
    x[: objective.nominal] = 0.0
    shaken = predictor.row_in(hypothesis, x, 0)[model.slot("base", "excitation_amplitude")] != 0.0
    if shaken or tuple(mechanism.names) != force.coordinates:
        return None
    places = [mechanism.names.index(name) for name in force.names]
    needed: dict[Window, Array] = {}
    states = dict(fitted.states)
    for window, motion in force.motions.items():
        points, copies = len(motion.time) - 1, 1 + len(places)
        row = predictor.row_in(hypothesis, x, window.run)
        tau = predictor.acting(hypothesis, x[None], mechanism, [(0, window, states[window])], motion.time)
        acting = over_each_step(predictor, tau, (points, len(mechanism.names)), copies)
        for k, place in enumerate(places):
            acting[1 + k :: copies, :, place] += force.torque
        q, qd = (np.repeat(own[:-1], copies, axis=0) for own in (motion.q, motion.qd))
        _, ends, _ = model.simulate(
            np.tile(row, (points * copies, 1)), q, qd, np.array([0.0, motion.time[1]]), tau=acting, hold=predictor.hold,
            tolerance=predictor.tolerance, threads=predictor.threads,
        )  # fmt: skip
        speed = ends[:, 1][:, places].reshape(points, copies, len(places))
        by_force = np.swapaxes(speed[:, 1:] - speed[:, :1], 1, 2) / force.torque
        missing = motion.qd[1:][:, places] - speed[:, 0]
        if not (np.isfinite(by_force).all() and np.isfinite(missing).all()):
            return None
        # What sticks answers to no force, and does not say which one is needed.
        answering = np.linalg.svd(by_force, compute_uv=False)[:, -1]
        moving = answering > STUCK * np.median(answering)
        if not moving.any():
            return None
        needed[window] = np.full(missing.shape, np.nan)
        needed[window][moving] = -np.linalg.solve(by_force[moving], missing[moving][..., None])[..., 0]
        states[window] = np.concatenate([motion.q[0], motion.qd[0]])
    return force.over(needed), x, states


def _sums(force: StateForce, objective: Objective, x: Array, here: Linearisation, nodes: Array | None) -> Sums:
    """What a linear view says of forces and numbers, beside ``nodes`` that are pushed already."""
    nominal = np.arange(len(x)) < objective.nominal
    numbers = Numbers(here.shared, np.where(nominal, 1.0, NEAR), np.where(nominal, x, 0.0))
    return force.sums(objective.windows, profiled(here), nodes, numbers)
