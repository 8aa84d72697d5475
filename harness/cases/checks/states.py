"""The same quantity at the same random states in every engine."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Row, Series
from harness.cases.checks.equation_blame import blamed
from harness.compare import quantities
from harness.compare.attribution import Blame
from harness.compare.odd_one_out import vote
from harness.compare.scales import Terms, terms
from harness.compare.single_answer import blame_answer
from harness.engines.protocol import EngineError, EngineModel
from harness.errors import UnsupportedError
from harness.system import System
from harness.system.lowering import lower

# A quantity at one state, as a flat array: (model, q, qd, qdd, tau) -> values.
Quantity = Callable[[EngineModel, Array, Array, Array, Array], Array]

QUANTITIES: dict[str, Quantity] = {
    "acceleration": lambda m, q, qd, qdd, tau: m.forward_dynamics(q, qd, tau),
    "inverse_dynamics": lambda m, q, qd, qdd, tau: m.inverse_dynamics(q, qd, qdd),
    "mass_matrix": lambda m, q, qd, qdd, tau: np.asarray(m.mass_matrix(q)).ravel(),
    "bias": lambda m, q, qd, qdd, tau: m.bias(q, qd),
    "gravity": lambda m, q, qd, qdd, tau: m.gravity(q),
    "energy": lambda m, q, qd, qdd, tau: np.asarray(m.energy(q, qd)),
}


@dataclass(frozen=True)
class StateAgreement:
    """Largest relative difference of a quantity between the native dynamics and each other engine.

    quantity: a key of ``QUANTITIES``. allowed: relative. why: the reason for it. states: how many random states.
    speed: 1σ of joint velocities [rad/s or m/s]; effort: 1σ of accelerations asked of inverse dynamics [rad/s²],
    torques being of the size that inverse dynamics gives; elastic: 1σ of elastic coordinates.
    conditioned: (acceleration, mass_matrix) the mechanism may multiply rounding; where that alone explains more than
    ``allowed``, it is what is allowed, and the row says so.
    """

    quantity: str
    allowed: float
    why: str
    states: int = 8
    speed: float = 1.0
    effort: float = 1.0
    elastic: float = 1e-3
    conditioned: bool = False

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        states = random_states(bench, self.states, self.speed, self.effort, self.elastic)
        values: dict[str, Array] = {}
        reasons: dict[str, str] = {}
        for name, model in bench.models.items():
            try:
                values[name] = evaluate(self.quantity, model, states)
            except UnsupportedError as error:
                reasons[name] = str(error)
        if NATIVE not in values:
            yield bench.skipped(self.quantity, (NATIVE,), reasons.get(NATIVE, "the native engine was left out"))
            return
        mass = None
        if self.quantity in ("acceleration", "mass_matrix"):
            mass = np.array([bench.models[NATIVE].mass_matrix(q) for q in states.q])
        summed = summed_terms(bench.system, states, bench.models[NATIVE])
        measure = partial(difference_of, self.quantity, mass, terms=summed.get(self.quantity))
        differences = {name: measure(values[NATIVE], value) for name, value in values.items() if name != NATIVE}
        allowed, note = self.allowed, ""
        if mass is not None and self.conditioned and _beyond(differences, allowed):
            if self.quantity == "acceleration":
                explained = rounding(bench.models[NATIVE], states, mass, values[NATIVE], summed.get("each"))
                what = "ill-conditioned: rounding of the mass matrix and the forces"
            else:
                explained = normwise(mass)
                what = "inertias of very different size: rounding of the largest, summed about a common point,"
            if explained > allowed:
                allowed = explained
                note = f"{what} alone explains {explained:.0e}"
        if _beyond(differences, allowed):
            verdict = vote(values, allowed, lambda a, b: float(measure(a, b).max()))
            note = "; ".join(filter(None, [note, verdict.sentence]))
        for name, difference in differences.items():
            worst = int(np.argmax(difference))
            remark, divergence = note, None
            if not difference[worst] <= allowed:
                divergence = where(bench.system, self.quantity, worst, values[NATIVE][worst], values[name][worst])
                said, place = self._blame(bench, name, states)
                divergence |= place
                remark = "; ".join(filter(None, [note, said]))
            yield bench.row(
                self.quantity,
                (NATIVE, name),
                float(difference[worst]),
                allowed,
                why=self.why,
                note=remark,
                first_divergence=divergence,
            )
        for name, reason in reasons.items():
            yield bench.skipped(self.quantity, (NATIVE, name), reason)

    def _blame(self, bench: Bench, name: str, states: States) -> tuple[str, dict[str, object]]:
        told = blamed(bench, name, states.q, states.qd, states.tau, self.allowed)
        if not told.agree:
            return told.words, told.place
        # The equation of motion is right, so that what fails is this answer alone.
        said = f"the accelerations agree, so it is the answer to {self.quantity.replace('_', ' ')} alone"
        # A closed mechanism has no answer at accelerations that would open it.
        found = None if bench.system.loops else self._in_answer(bench, name, states)
        if found is None:
            return said, {"term": self.quantity}
        return f"{said}: {found.words}", {"term": found.term, "at": found.coordinate}

    def _in_answer(self, bench: Bench, name: str, states: States) -> Blame | None:
        try:
            return blame_answer(self.quantity, bench.models[name], bench.models[NATIVE], states.q, states.qd)
        except (UnsupportedError, EngineError, np.linalg.LinAlgError):
            return None


def _beyond(differences: dict[str, Array], allowed: float) -> bool:
    return any(not (difference.max() <= allowed) for difference in differences.values())


def summed_terms(system: System, states: States, model: EngineModel) -> dict[str, Array]:
    """Sizes of the terms that forces and energies are sums of, by quantity, shape (B,); ``each`` those of the bias, (B, n).

    Nothing for a flexible system, whose quantities no engine shares. See ``harness.compare.scales``.
    """
    if system.flexible:
        return {}
    lowered = lower(system)
    joints = lowered.system.movable_joints
    damping, stiffness = (np.array([getattr(joint, key) for joint in joints]) for key in ("damping", "stiffness"))
    rest = np.array([joint.rest_position for joint in joints])
    # Terms of the lowered joints, at angles of balls that are zero, add up to those of what is independent.
    local = np.array([lowered.position(q) for q in states.q])
    rates = states.qd @ lowered.rates.T
    at: list[Terms] = [terms(lowered.recentred(q), x, v) for q, x, v in zip(states.q, local, rates, strict=True)]
    gathered = np.abs(lowered.rates)
    each = np.array([one.gravity + one.motion for one in at]) @ gathered
    passive = (damping * np.abs(rates) + stiffness * np.abs(local - rest)) @ gathered
    driven = np.array([np.abs(model.mass_matrix(q)) @ np.abs(qdd) for q, qdd in zip(states.q, states.qdd, strict=True)])
    return {
        "gravity": (np.array([one.gravity for one in at]) @ gathered).max(axis=1),
        "bias": each.max(axis=1),
        "inverse_dynamics": (each + passive + driven).max(axis=1),
        "energy": np.array([one.potential for one in at]),
        "each": each,
    }


def difference_of(quantity: str, mass: Array | None, a: Array, b: Array, terms: Array | None = None) -> Array:
    """How far two engines' values of a quantity are apart at each state, relative, shape (B,).

    Accelerations in the norm of the mass matrix (B, n, n), its own entries over √(M_ii M_jj), all else over the largest
    entry of the state or the terms (B,) that cancel in it: see ``harness.compare.quantities`` and ``scales``.
    """
    if quantity == "acceleration" and mass is not None:
        return quantities.accelerations(mass, a, b)
    if quantity == "mass_matrix" and mass is not None:
        return quantities.mass_matrices(a.reshape(mass.shape), b.reshape(mass.shape))
    return quantities.relative(a, b, terms=terms)


@dataclass(frozen=True)
class States:
    """Random states: position, velocity, acceleration and force, each shape (B, n)."""

    q: Array  # (B, nq)
    qd: Array
    qdd: Array
    tau: Array


def random_states(bench: Bench, count: int, speed: float, effort: float, elastic: float) -> States:
    """States inside the joints' limits (whole turns without limits), the same ones for every engine.

    Torques are those that the native engine (or the first one there is) needs for the random accelerations, so that
    accelerations stay of a sane size on every mechanism.
    """
    system = bench.system
    rng = bench.rng()
    low, high, soft = [], [], []
    joints = {name: joint for joint in system.movable_joints for name in joint.position_names}
    rigid = {name for joint in system.movable_joints for name in joint.velocity_names}
    for name in system.position_names:
        joint = joints.get(name)
        soft.append(joint is None)
        least, most = -np.pi, np.pi
        if joint is not None:
            # Shifts in space, and of quaternions what random directions are made of.
            if joint.prismatic or joint.turns_in_space or name.endswith((".x", ".y")):
                least, most = -1.0, 1.0
            if np.isfinite(joint.lower) and np.isfinite(joint.upper) and joint.lower < joint.upper:
                least, most = joint.lower, joint.upper
        low.append(least)
        high.append(most)
    n = system.nv
    elastic_ones = np.array(soft)
    elastic_rates = np.array([name not in rigid for name in system.coordinate_names])
    # Not up to the very limits: engines that know them as constraints would push there.
    q = np.array(low) + (np.array(high) - np.array(low)) * rng.uniform(0.05, 0.95, (count, len(low)))
    qd = speed * rng.standard_normal((count, n))
    qdd = effort * rng.standard_normal((count, n))
    q[:, elastic_ones] = elastic * rng.standard_normal((count, int(elastic_ones.sum())))
    qd[:, elastic_rates] *= elastic
    for joint in system.joints:
        if joint.turns_in_space:
            first = system.position_names.index(joint.position_names[-4])
            quaternion = rng.standard_normal((count, 4))
            q[:, first : first + 4] = quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)
    asked = bench.models.get(NATIVE) or next(iter(bench.models.values()))
    if system.loops:
        q, qd, qdd = _closed(asked, q, qd, qdd)
    tau = np.array([asked.inverse_dynamics(q[k], qd[k], qdd[k]) for k in range(count)])
    return States(q, qd, qdd, tau)


def _closed(model: EngineModel, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array, Array]:
    """The states brought to where loops are closed, and accelerations that keep them so under random forces."""
    close = getattr(model, "closed_state", None)
    if close is None:
        raise UnsupportedError("states of closed mechanisms are those of the native dynamics")
    states = [close(*row) for row in zip(q, qd, strict=True)]
    q, qd = np.array([state[0] for state in states]), np.array([state[1] for state in states])
    forces = [model.inverse_dynamics(x, v, model.forward_dynamics(x, v, np.zeros_like(v))) for x, v in states]
    moved = [np.diag(model.mass_matrix(x)) * a for x, a in zip(q, qdd, strict=True)]
    pairs = zip(q, qd, forces, moved, strict=True)
    return q, qd, np.array([model.forward_dynamics(x, v, f + m) for x, v, f, m in pairs])


def evaluate(quantity: str, model: EngineModel, states: States) -> Array:
    """The quantity at every state, shape (B, k)."""
    function = QUANTITIES[quantity]
    count = len(states.q)
    return np.array(
        [
            np.asarray(function(model, states.q[k], states.qd[k], states.qdd[k], states.tau[k]), dtype=np.float64)
            for k in range(count)
        ]
    )


def rounding(model: EngineModel, states: States, mass: Array, acceleration: Array, terms: Array | None = None) -> float:
    """Relative error of accelerations that rounding of mass matrix and forces to double precision brings.

    First-order componentwise bound √n ε |M⁻¹| (|M| |qdd| + |bias| + |tau| + |passive forces|) (Bauer-Skeel; Higham,
    Accuracy and Stability of Numerical Algorithms, §7.2; √n for sums of n roundings, Higham & Mary 2019), twice because
    each of two engines rounds, in the norm that accelerations are compared in, at the worst of the states.
    terms: of the bias, where they may cancel, shape (B, n).
    """
    errors = []
    for k, qdd in enumerate(acceleration):
        bias, tau = model.bias(states.q[k], states.qd[k]), states.tau[k]
        # Springs a radian off balance what was drawn to move them: two large terms whose difference is what counts.
        passive = mass[k] @ qdd + bias - tau
        summed = np.abs(bias) if terms is None else np.maximum(np.abs(bias), terms[k])
        forces = np.abs(mass[k]) @ np.abs(qdd) + summed + np.abs(tau) + np.abs(passive)
        errors.append(np.abs(np.linalg.inv(mass[k])) @ forces)
    unit = 2.0 * np.sqrt(states.q.shape[1]) * np.finfo(np.float64).eps
    return float(quantities.accelerations(mass, acceleration, acceleration + unit * np.array(errors)).max())


def normwise(mass: Array) -> float:
    """Relative error of a mass matrix's entries that rounding brings to engines that sum inertia about a common point.

    MuJoCo does so about the centre of mass of the whole tree: a wrist's inertia is what is left of terms of the size of
    the arm's. 2 √n ε max M_jj / min M_ii, at the worst of the states; mass (B, n, n).
    """
    diagonal = np.diagonal(mass, axis1=1, axis2=2)
    unit = 2.0 * np.sqrt(mass.shape[1]) * np.finfo(np.float64).eps
    return float(unit * (diagonal.max(axis=1) / diagonal.min(axis=1)).max())


def where(system: System, quantity: str, state: int, a: Array, b: Array) -> dict[str, object]:
    """The coordinate at which two values of a quantity differ most."""
    names = system.coordinate_names
    flat = np.abs(a - b)
    worst = int(np.argmax(np.where(np.isfinite(flat), flat, np.inf)))
    place: dict[str, object] = {"state": state}
    if quantity == "energy":
        place["part"] = ("kinetic", "potential")[worst]
    elif quantity == "mass_matrix":
        place["entry"] = [names[worst // len(names)], names[worst % len(names)]]
    else:
        place["coordinate"] = names[worst]
    return place
