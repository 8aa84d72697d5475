"""Motion with limits of joints and dry friction as soft constraints, over any engine's mass matrix and forces.

The accelerations a minimize ½ (a − a₀)ᵀ M (a − a₀) + Σ s(a), a₀ those without constraints. A limit, passed by δ, costs
½ (K δ + C δ̇ + J δ̈)² / J where that pushes; dry friction J ẍ + J ẋ/τ, but no more than its level, costs Huber's function of it.
That is MuJoCo's problem for constraints of one joint each, and its solution by Newton's method with the constraints that act.
Source: Todorov, Convex and analytically-invertible dynamics with contacts and constraints, Proc. IEEE ICRA (2014) 6054–6061.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.engines.checked import finite_result
from harness.engines.march import adaptive
from harness.engines.protocol import Array, EngineError, EngineModel
from harness.system import System
from harness.system.lowering import followed

# MuJoCo's defaults for dry friction, solreffriction and solimpfriction: τ = timeconst · dmax / 2, J = d / (1 − d) of the inertia.
FRICTION_TIME, FRICTION_SHARE = 0.5 * 0.02 * 0.95, 9.0
# So short that a joint is not past a limit and back unseen [s].
LONGEST_STEP = 5e-3
_ROUNDS = 50


@dataclass(frozen=True, eq=False)
class SoftJoints:
    """Soft constraints of c joints in a system with n velocities; those that are none have infinite ends and a level of zero.

    rows: velocity of each as a combination of ours, (c, n). take, factor, shift: its position, factor · q[take] + shift.
    lower, upper, stiffness, damping, inertia: of its limits. level, hold, time: of its dry friction, the inertia that it adds while
    it holds and the time by which it turns round.
    """

    rows: Array
    take: Array
    factor: Array
    shift: Array
    lower: Array
    upper: Array
    stiffness: Array
    damping: Array
    inertia: Array
    level: Array
    hold: Array
    time: Array

    def acceleration(self, mass: Array, free: Array, q: Array, v: Array, basis: Array | None = None) -> Array:
        """Accelerations (n,) under the constraints; ``free`` are those without.

        basis: (n, m), the directions that joints coupled to one another leave; all if None.
        """
        x, speed = self.factor * q[self.take] + self.shift, self.rows @ v
        side = np.where(x > self.upper, 1.0, np.where(x < self.lower, -1.0, 0.0))
        depth = np.where(side > 0.0, x - self.upper, np.where(side < 0.0, self.lower - x, 0.0))
        resting = self.stiffness * depth + self.damping * side * speed
        touching, rubbing = side != 0.0, self.level > 0.0
        if not (touching.any() or rubbing.any()):
            return free
        if basis is None:
            inverse = np.linalg.solve(mass, self.rows.T)
        else:
            inverse = basis @ np.linalg.solve(basis.T @ mass @ basis, basis.T @ self.rows.T)

        def pushes(a: Array) -> tuple[Array, Array, Array]:
            """Forces of the constraints on their joints, and the inertia that each adds."""
            rate = self.rows @ a
            contact = np.where(touching, resting + self.inertia * side * rate, 0.0)
            held = np.where(rubbing, self.hold * (rate + speed / self.time), 0.0)
            acting = np.where(contact > 0.0, self.inertia, 0.0) + np.where(np.abs(held) < self.level, self.hold, 0.0)
            return -side * np.maximum(contact, 0.0), -np.clip(held, -self.level, self.level), acting

        a = free
        for _ in range(_ROUNDS):
            contact, friction, acting = pushes(a)
            wrong = a - free - inverse @ (contact + friction)
            if np.abs(wrong).max() <= 1e-13 * (1.0 + np.abs(a).max() + np.abs(free).max()):
                return a
            # (1 + M⁻¹ Rᵀ diag(acting) R) step = −wrong, and no longer a step than brings both closer.
            step = np.linalg.solve(np.eye(len(a)) + inverse @ (acting[:, None] * self.rows), -wrong)
            share, size = 1.0, wrong @ mass @ wrong
            while share > 1e-3:
                again = a + share * step
                there = again - free - inverse @ np.sum(pushes(again)[:2], axis=0)
                if there @ mass @ there < size:
                    break
                share *= 0.5
            a = a + share * step
        raise EngineError("accelerations under limits and dry friction were not found")


def soft_joints(system: System, inverse: Array, *, rubbing: bool) -> SoftJoints | None:
    """The limits that act in a system and, if ``rubbing``, its dry friction; None if there are none.

    inverse: inverse mass matrix about where the system starts, which says how soft friction is that states nothing of it, (n, n).
    """
    stops = {stop.joint: stop for stop in system.stops}
    softness = {a.site: a.parameters for a in system.attachments if a.effect == "friction_softness"}
    names, positions = list(system.coordinate_names), system.position_names
    table: list[tuple[float, ...]] = []
    rows = []
    for joint in system.movable_joints:
        level = joint.friction if rubbing and not joint.turns_in_space else 0.0
        stop = stops.get(joint.name)
        if stop is None and not level:
            continue
        leader, multiplier, offset = followed(system, joint)
        row = np.zeros(len(names))
        row[names.index(leader)] = multiplier
        rows.append(row)
        limits = (-np.inf, np.inf, 0.0, 0.0, 0.0)
        if stop is not None:
            limits = (stop.lower, stop.upper, stop.stiffness, stop.damping, stop.inertia)
        stated = softness.get(joint.name)
        hold = FRICTION_SHARE / float(row @ inverse @ row) if stated is None else stated["inertia"]
        time = FRICTION_TIME if stated is None else stated["time"]
        table.append((positions.index(leader), multiplier, offset, *limits, level, hold, time))
    if not table:
        return None
    columns = list(np.array(table, dtype=np.float64).T)
    return SoftJoints(np.array(rows), columns[0].astype(np.intp), *columns[1:])


def soft_march(
    model: EngineModel,
    soft: SoftJoints | None,
    q0: Array,
    v0: Array,
    time: Array,
    tau: Array | None,
    rates: Callable[[Array, Array], Array] | None = None,
    *,
    step: float | None = None,
    rtol: float = 1e-10,
    atol: float = 1e-12,
) -> tuple[Array, Array]:
    """Positions (T, nq) and velocities (T, n) at ``time`` [s], by DOP853 over the model's accelerations.

    tau: (T, n), each held until the next sample, or None. rates: (q, v) -> rates of the positions, where those are not v.
    step: longest step [s]. Raises EngineError where the motion cannot be followed.
    """
    nq = len(q0)

    def slope(y: Array, force: Array) -> Array:
        q, v = y[:nq], y[nq:]
        a = model.forward_dynamics(q, v, force)
        if soft is not None:
            a = soft.acceleration(model.mass_matrix(q), a, q, v)
        return np.concatenate([v if rates is None else rates(q, v), finite_result("the run", "motion", a)])

    longest = min(step or np.inf, LONGEST_STEP if soft is not None else np.inf)
    start = np.concatenate([q0, v0])
    states = adaptive(slope, start, time, tau, np.zeros(len(v0)), rtol=rtol, atol=atol, longest=longest)
    return states[:, :nq], states[:, nq:]
