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

from harness.diagnose.estimation.constants import (
    CLOSER_GAIN,
    CLOSER_ROUNDS,
    ENOUGH_SURPRISE,
    FAR_FROM_NOISE_RATIO,
    HELD_STIFFNESS,
    LOST,
    MOST_STEPS_BESIDE,
    PUSHING_ROUNDS,
    RANKING_GAIN,
    SHORTENED_STEP,
    SHORTEST_STEP,
    STUCK_ANSWER,
)
from harness.diagnose.estimation.discrepancy import profiled, responses
from harness.diagnose.estimation.least_squares import Fit, fit
from harness.diagnose.estimation.linear_response import over_each_step
from harness.diagnose.estimation.linearisation import Linearisation, linearise
from harness.diagnose.estimation.objective import Objective, States
from harness.diagnose.estimation.state_force import Force, Likeliest, Numbers, StateForce, Sums, over_the_state
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Beside:
    """A set beside the force that it leaves out.

    surprise: −2 log of how likely the recordings are, that of the nominal quantities' deviations included, up to a constant. x,
    states: where the set's numbers are likeliest; spread: the numbers' standard deviations there with the force free, (P,). nodes,
    shape: the force there, None where none is likelier. residuals: (M,) by window.
    """

    hypothesis: Hypothesis
    surprise: float
    x: Array
    spread: Array
    states: Mapping[Window, Array]
    predictor: Predictor
    residuals: tuple[Array, ...]
    nodes: Array | None = None
    shape: Force | None = None


def beside(
    force: StateForce, objective: Objective, fitted: Fit, held: NDArray[np.bool_], nears: Sequence[Beside] = ()
) -> Beside:
    """The set of a fit and the force that it leaves out, together. objective: of its windows under the sensors' noise.

    held: numbers that do not move, (P,). nears: where to begin: this set's numbers and states, and a force, each as beside another.
    """

    def fitted_at(nodes: Array, x: Array, states: States, force_there: Force) -> Point:
        there = _pushed(force, objective, nodes)
        loud = float(np.mean(force_there.louder * force.together))
        found = fit(there, x, states, fixed=held, most_steps=MOST_STEPS_BESIDE, enough=RANKING_GAIN * loud, louder=loud)
        return Point(there, nodes, found.x, found.states, found.linear)

    plain = looked_at(force, objective, None, fitted.x, fitted.states, held)
    if plain.at.cost >= LOST:
        return plain.weighed(np.inf, None)
    sums = plain.sums(force)
    alone = plain.weighed(force.without(sums), None)
    begun = []
    for near in nears:
        if near.nodes is not None and near.shape is not None:
            there = fitted_at(near.nodes, near.x, near.states, near.shape)
            begun.append((_held(force, there, [near.shape]), there))
    if begun:
        begun = [min([(alone, plain), *begun], key=lambda row: row[0].surprise)]
    else:
        begun = [(alone, plain)]
        if (
            np.any(sums.left > FAR_FROM_NOISE_RATIO * sums.counts)
            and (tracked := _tracking(force, objective, fitted)) is not None
        ):
            there = fitted_at(*tracked, force.likeliest(sums).force)
            if there.at.cost < plain.at.cost:
                # The force there is as rough as readings are; what it says is known after a step from there.
                begun.append((there.weighed(np.inf, None), there))
    ends = [(alone, plain), *(_descended(force, fitted, best, here, objective, held) for best, here in begun)]
    ended, there = min(ends, key=lambda row: row[0].surprise)
    return replace(ended, spread=force.spread(there.sums(force), ended.shape))


def _descended(
    force: StateForce, fitted: Fit, best: Beside, here: Point, objective: Objective, held: NDArray[np.bool_]
) -> tuple[Beside, Point]:
    """The mode that Gauss–Newton steps lead to from a point, and how it is weighed."""
    lower, upper = objective.bounds()
    share, own, slow = 1.0, False, False
    aim = force.likeliest(here.sums(force), best.shape)
    for _ in range(PUSHING_ROUNDS):
        if best.surprise - aim.value < ENOUGH_SURPRISE:
            break
        there = looked_at(force, objective, *here.towards(force, aim, share, lower, upper), held)
        shapes = [aim.force] if best.shape is None else [aim.force, best.shape]
        found = _held(force, there, shapes)
        if found.surprise < best.surprise:
            # Along a valley each step gains a little less than the one before: two in a row that gain nothing end it.
            before, slow = slow, best.surprise - found.surprise < ENOUGH_SURPRISE
            best, here, share = found, there, min(1.0, share / SHORTENED_STEP)
            if slow and before:
                break
        elif share >= SHORTEST_STEP:
            share *= SHORTENED_STEP
            continue
        elif not own:
            # This set moves otherwise than the one that answers are along.
            own, share = True, 1.0
            moving = replace(fitted, x=here.x, states=here.states, linear=here.at)
            force = force.along(here.objective.predictor, objective.likelihood, moving)
        else:
            break
        aim = force.likeliest(here.sums(force), best.shape)
    return best, here


def _pushed(force: StateForce, objective: Objective, nodes: Array) -> Objective:
    """The same with what a set leaves out pushed, the forces at the nodes less than nothing."""
    return replace(objective, predictor=objective.predictor.pushed(force.pushes(-nodes)))


def looked_at(
    force: StateForce, objective: Objective, nodes: Array | None, x: Array, states: States, held: NDArray[np.bool_]
) -> Point:
    """Runs of a set with the force at the nodes, if there is one, and a linear view of them. held: numbers that do not move."""
    if nodes is not None:
        objective = _pushed(force, objective, nodes)
    _, upper = objective.bounds()
    return Point(objective, nodes, x, states, linearise(objective, x, states, upper=upper, fixed=held))


@dataclass(frozen=True, eq=False)
class Point:
    """Where a set and the force at the nodes, if there is one, are looked at: runs with it, and a linear view of them."""

    objective: Objective
    nodes: Array | None
    x: Array
    states: States
    at: Linearisation

    def sums(self, force: StateForce) -> Sums:
        """What the linear view says of forces and numbers."""
        return _sums(force, self.objective, self.x, self.at, self.nodes)

    def weighed(self, surprise: float, shape: Force | None) -> Beside:
        """This surprise, spreads not known yet."""
        nodes, open_ = None if shape is None else self.nodes, np.full(len(self.x), np.inf)
        there = self.objective
        return Beside(
            there.hypothesis, surprise, self.x, open_, self.states, there.predictor, self.at.residuals, nodes, shape
        )

    def towards(
        self, force: StateForce, aim: Likeliest, share: float, lower: Array, upper: Array
    ) -> tuple[Array, Array, States]:
        """Nodes, numbers and initial states a share of the way to where a linear view is likeliest."""
        nodes = np.zeros(len(aim.nodes)) if self.nodes is None else self.nodes
        ahead = nodes + share * (aim.nodes - nodes)
        x = np.clip(self.x + share * aim.numbers, lower, upper)
        states = {}
        windows = self.objective.windows
        for window, basis, shared, residual in zip(
            windows, self.at.bases, self.at.shared, self.at.residuals, strict=True
        ):
            after = share * residual + shared @ (x - self.x) - force.answers[window] @ (ahead - nodes)
            states[window] = self.states[window] - np.linalg.lstsq(basis, after, rcond=1e-9)[0]
        return ahead, x, states


def along_the_recordings(
    objective: Objective, fitted: Fit, held: NDArray[np.bool_], torque: float, period: float
) -> StateForce | None:
    """Forces over the state along the motion of a fit with what it leaves out made up for; None where channels do not answer
    linearly.

    torque: natural size [N·m]; period: of the slowest swing [s].
    """
    force, cost = None, np.inf
    predictor, near = objective.predictor, fitted
    for _ in range(CLOSER_ROUNDS):
        found = responses(predictor, objective.likelihood, near, torque, period)
        again = None if found is None else over_the_state(found)
        if again is None:
            break
        force, moved = again, beside(again, objective, fitted, held)
        left = sum(float(r @ r) for r in moved.residuals)
        if moved.nodes is None or left > CLOSER_GAIN * cost:
            break
        predictor, near, cost = moved.predictor, replace(fitted, x=moved.x, states=moved.states), left
    return force


def _held(force: StateForce, there: Point, shapes: Sequence[Force]) -> Beside:
    """The set and the force at the nodes as runs with it leave them, under the likelier one of these shapes."""
    surprise, best = np.inf, None
    if there.at.cost < LOST and there.nodes is not None:
        sums = _sums(force, there.objective, there.x, there.at, None)
        # On the way there noise is as loud as what is left.
        louder = sums.louder
        rows = [
            (force.held(sums, there.nodes, own), own) for own in (replace(shape, louder=louder) for shape in shapes)
        ]
        surprise, best = min(rows, key=lambda row: row[0])
    return there.weighed(surprise, best)


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
    for window in objective.windows:
        motion = force.motions.get(window)
        if motion is None:
            continue
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
        moving = answering > STUCK_ANSWER * np.median(answering)
        if not moving.any():
            return None
        needed[window] = np.full(missing.shape, np.nan)
        needed[window][moving] = -np.linalg.solve(by_force[moving], missing[moving][..., None])[..., 0]
        states[window] = np.concatenate([motion.q[0], motion.qd[0]])
    return force.over(needed), x, states


def stiffness(size: int, nominal: int) -> Array:
    """How stiffly each of a set's numbers is held where it stands, (P,); the leading ``nominal`` ones by a unit normal prior."""
    return np.where(np.arange(size) < nominal, 1.0, HELD_STIFFNESS)


def _sums(force: StateForce, objective: Objective, x: Array, here: Linearisation, nodes: Array | None) -> Sums:
    """What a linear view says of forces and numbers, beside ``nodes`` that are pushed already."""
    nominal = np.arange(len(x)) < objective.nominal
    numbers = Numbers(here.shared, stiffness(len(x), objective.nominal), np.where(nominal, x, 0.0))
    return force.sums(objective.windows, profiled(here), nodes, numbers)
