"""Motion in time: which integrator, what goes in, what comes out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp

from harness.denoc.compiling import ahead
from harness.denoc.motion.channels import channels
from harness.denoc.motion.mechanism import Mechanism
from harness.denoc.recursion.rows import FIRST, FIXED, KIND
from harness.denoc.recursion.tree import Array
from harness.errors import InputError, UnsupportedError
from harness.system import Trajectory

Event = Callable[[float, Any, Any], float]

METHODS = {
    "rk4": "Runge-Kutta of order 4, fixed step",
    "dop853": "Dormand-Prince 8(5,3), adaptive",
    "gauss": "Gauss-Legendre of order 6, fixed step, symplectic",
}
STEP = 1e-3
# From here on an explicit method's stability would cost more than implicit stages [rad/s].
STIFF = 2e4


def simulate(
    model: Mechanism,
    q0: ArrayLike,
    qd0: ArrayLike,
    time: ArrayLike,
    *,
    tau: ArrayLike | None = None,
    hold: str = "zero",
    method: str | None = None,
    step: float | None = None,
    rtol: float = 1e-10,
    atol: float = 1e-12,
    events: Sequence[Event] = (),
) -> Trajectory:
    """Motion from (q0, qd0) at time[0], sampled at ``time``; see ``Denoc.simulate``."""
    start, speed = model.position("q0", q0), model.vector("qd0", qd0)
    times = _times(time)
    forces = _forces(model, times, tau)
    if hold not in ("zero", "linear"):
        raise InputError(f"hold {hold!r} is unknown", mend="'zero' holds forces between samples, 'linear' joins them")
    friction, row_of, armature = _friction(model)
    if model.system.attachments:
        names = ", ".join(sorted({a.effect for a in model.system.attachments}))
        raise UnsupportedError(
            f"the system has attached effects ({names}) that these equations do not hold",
            mend="simulate through harness.denoc.lanes.model.LaneModel, after harness.effects.apply",
        )
    chosen = method or _choose(model, start, friction)
    if chosen not in METHODS:
        raise InputError(f"method {chosen!r} is unknown", mend=f"choose from {', '.join(METHODS)}")
    if friction.any() and chosen != "dop853":
        raise InputError(
            f"method {chosen!r} does not locate where dry friction sticks", mend="leave method out, or take 'dop853'"
        )
    if step is not None and not (np.isfinite(step) and step > 0.0):
        raise InputError(f"step {step} is not positive", mend="give a step in seconds, such as 0.001")
    if not (rtol > 0.0 and atol > 0.0):
        raise InputError(f"rtol {rtol} and atol {atol} must be positive", mend="1e-10 and 1e-12 are usual")
    if chosen == "gauss" and len(start) != model.n:
        raise UnsupportedError(
            f"method {chosen!r} has no quaternions among the positions, joints that turn in space have",
            mend="leave method out, or take 'dop853'",
        )
    position, velocity = np.empty((len(times), len(start))), np.empty((len(times), model.n))
    position[0], velocity[0] = start, speed
    acceleration = np.empty_like(velocity)
    found: dict[str, Array] = {}
    said = METHODS[chosen]
    linear = hold == "linear"
    if events or model.by_calls:
        if friction.any() or chosen != "dop853":
            what = "events are" if events else "gravity compensation of single links is"
            raise UnsupportedError(
                f"{what} for the adaptive method and without dry friction",
                mend=f"take {'events' if events else 'gravcomp'} or friction out, leave method out",
            )
        found = _with_events(model, times, forces, linear, rtol, atol, events, position, velocity)
        if len(times) > 1 and "last" in found:
            kept = int(found.pop("last")[0])
            times, position, velocity = times[:kept], position[:kept], velocity[:kept]
    elif len(times) > 1:
        said += _integrate(
            model,
            chosen,
            times,
            forces,
            linear,
            step,
            rtol,
            atol,
            friction,
            row_of,
            armature,
            position,
            velocity,
            acceleration,
        )
    energy = model.energies(position, velocity).sum(axis=1)
    signals: dict[str, Array] = {}
    if model.beams:
        if not friction.any() or len(times) == 1:
            acceleration = model.accelerations(position, velocity, forces[: len(position)])
        signals = channels(model, position, velocity, acceleration)
    return Trajectory(times, model.names, position, velocity, signals, energy, said, found, model.position_names)


def _integrate(
    model: Mechanism,
    chosen: str,
    times: Array,
    forces: Array,
    linear: bool,
    step: float | None,
    rtol: float,
    atol: float,
    friction: Array,
    row_of: Any,
    armature: Array,
    position: Array,
    velocity: Array,
    acceleration: Array,
) -> str:
    """Run a compiled integrator; raises InputError where it fails, returns what to add about how it went."""
    # Joints that rest are locked by their rows.
    function = model.recursion_address if friction.any() else model.forward_address
    # Tasks are called as the methods are.
    ahead.ready(chosen)
    if chosen == "dop853":
        from harness.denoc.motion.adaptive import dormand_prince8

        counts = np.zeros(3, dtype=np.int64)
        status = dormand_prince8(
            function,
            model.header_address,
            model.tree.rows,
            row_of,
            armature,
            friction,
            times,
            forces,
            linear,
            rtol,
            atol,
            np.inf if step is None else step,
            position,
            velocity,
            acceleration,
            counts,
        )
        said = f", {counts[0]} steps" + (f", dry friction with {counts[2]} events" if friction.any() else "")
    elif chosen == "rk4":
        from harness.denoc.motion.fixed_step import runge_kutta4

        step = STEP if step is None else step
        status = runge_kutta4(function, model.header_address, times, step, forces, linear, position, velocity)
        said = f" of {step:g} s at most"
    else:
        from harness.denoc.motion.fixed_step import gauss_legendre6

        step = STEP if step is None else step
        probe = np.zeros((model.n, model.n))
        stiffness, damping = model.linear_passive()
        status = gauss_legendre6(
            function, model.header_address, times, step, forces, linear, probe, stiffness, damping, position, velocity
        )
        said = f" of {step:g} s at most"
    if status > 0:
        raise model.singular(status)
    if status < 0:
        raise InputError(
            f"the integration ({METHODS[chosen]}) did not get through",
            mend="check the parameters for stiffness or mass out of all proportion, take a smaller step, or another method",
        )
    return said


def _choose(model: Mechanism, q: Array, friction: Array) -> str:
    """The method for a system: event-located with dry friction, implicit where a mode is stiff, adaptive else."""
    if friction.any() or not model.beams or len(q) != model.n:
        return "dop853"
    stiffness, _ = model.linear_passive()
    fastest = np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(model.mass_matrix(q), stiffness))).max())
    return "gauss" if fastest > STIFF else "dop853"


def _times(time: ArrayLike) -> Array:
    times = np.ascontiguousarray(time, dtype=np.float64)
    if times.ndim != 1 or len(times) == 0 or not np.isfinite(times).all():
        raise InputError("time is not a vector of finite numbers", mend="give sample times in seconds, shape (T,)")
    if np.any(np.diff(times) <= 0.0):
        where = int(np.argmax(np.diff(times) <= 0.0)) + 1
        raise InputError(f"time does not increase at sample {where}", mend="sort the samples, drop repeated times")
    return times


def _forces(model: Mechanism, times: Array, tau: ArrayLike | None) -> Array:
    if tau is None:
        return np.zeros((0, model.n))
    forces = np.ascontiguousarray(tau, dtype=np.float64)
    if forces.shape == (model.n,):
        forces = np.tile(forces, (len(times), 1))
    if forces.shape != (len(times), model.n) or not np.isfinite(forces).all():
        raise InputError(
            f"tau has shape {forces.shape} or is not finite",
            mend=f"give a row of {model.n} forces for each of the {len(times)} samples",
        )
    return forces


def _friction(model: Mechanism) -> tuple[Array, Any, Array]:
    """Dry friction, row and armature of each coordinate, each (n,)."""
    tree = model.tree
    friction, armature = np.zeros(model.n), np.zeros(model.n)
    row_of = np.zeros(model.n, dtype=np.int64)
    for body, joint in enumerate(tree.joints, start=1):
        if tree.topology[body, KIND] != FIXED:
            own, share = model.velocity_share(int(tree.topology[body, FIRST]))
            # A joint that follows another rubs at that one, by as much more as it moves further.
            friction[own] += abs(share) * joint.friction
            if abs(share) == 1.0:
                armature[own], row_of[own] = joint.armature, body
    if (friction < 0.0).any():
        name = model.names[int(np.argmax(friction < 0.0))]
        raise InputError(f"joint {name!r} has negative friction", mend="give zero or a positive torque")
    return friction, row_of, armature


@dataclass(frozen=True)
class _OfState:
    """An event as SciPy's driver takes it: of the state (q, qd), q of n numbers, with what the event says of itself."""

    event: Event
    n: int

    @property
    def terminal(self) -> bool | int:
        return getattr(self.event, "terminal", False)

    @property
    def direction(self) -> float:
        return getattr(self.event, "direction", 0.0)

    def __call__(self, t: float, y: Array) -> float:
        return self.event(t, y[: self.n], y[self.n :])


def _with_events(
    model: Mechanism,
    times: Array,
    forces: Array,
    linear: bool,
    rtol: float,
    atol: float,
    events: Sequence[Event],
    position: Array,
    velocity: Array,
) -> dict[str, Array]:
    """Events located by SciPy's driver; each is a function (t, q, qd) with optional ``terminal`` and ``direction``."""
    n = len(position[0])

    def rates(t: float, y: Array) -> Array:
        force = None
        if len(forces):
            k = min(int(np.searchsorted(times, t, side="right")) - 1, len(times) - 2)
            share = (t - times[k]) / (times[k + 1] - times[k]) if linear else 0.0
            force = forces[k] + share * (forces[k + 1] - forces[k])
        return np.concatenate([model.position_rates(y[:n], y[n:]), model.forward_dynamics(y[:n], y[n:], force)])

    longest = float(np.diff(times).min()) if len(forces) else np.inf
    result = solve_ivp(
        rates,
        (times[0], times[-1]),
        np.concatenate([position[0], velocity[0]]),
        method="DOP853",
        t_eval=times,
        events=[_OfState(event, n) for event in events],
        rtol=max(rtol, 3e-14),
        atol=atol,
        max_step=longest,
    )
    if result.status < 0:
        raise InputError(
            f"the integration did not get through: {result.message}", mend="loosen rtol, or check the state"
        )
    kept = len(result.t)
    position[:kept], velocity[:kept] = result.y[:n].T, result.y[n:].T
    named = {
        getattr(e, "__name__", f"event{k + 1}"): t for k, (e, t) in enumerate(zip(events, result.t_events, strict=True))
    }
    if kept < len(times):
        named["last"] = np.array([kept])
    return named
