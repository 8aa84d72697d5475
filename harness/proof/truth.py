"""The concealing engine: MuJoCo's equations of motion, integrated by DOP853 with located events.

MuJoCo gives mass matrix, bias and reaction forces; the concealed laws act as generalized forces written here
independently of the catalogue; SciPy integrates, or MuJoCo itself where springs are all that hides. Dry friction is
set-valued at rest: a joint whose velocity has come to zero is locked until more than the static limit is needed to hold
it. Reversals, sticking and slipping are events of the integrator, so the truth is far more accurate (about 1e-9) than
any sensor.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg.lapack import dposv

from harness.proof.elastic_truth import even, has_springs, run
from harness.proof.rigs import Rig, Segment

Array = NDArray[np.float64]
Torque = Callable[[float, Array, Array], Array]
# (position, velocity, acceleration without it, mobility: acceleration by a unit force) -> force
Constraint = Callable[[float, float, float, float], float]

RELATIVE_TOLERANCE = 1e-9
ABSOLUTE_TOLERANCE = 1e-11
LOAD_ITERATIONS = 4  # friction that depends on the reaction force, which depends on friction: a contraction


@dataclass(frozen=True)
class _Ending:
    """An event that ends a run of ``solve_ivp``: where the function of time and state crosses zero in a direction."""

    function: Callable[[float, Array], float]
    direction: float
    terminal: bool = True

    def __call__(self, t: float, y: Array) -> float:
        return self.function(t, y)


class NoSolutionError(RuntimeError):
    """There is no such rig, or no motion of it: dry friction that depends on the reaction force may have no consistent one."""


@dataclass(frozen=True)
class DryFriction:
    """Dry friction in one degree of freedom: limits [N·m] as functions of speed [rad/s] and reaction force [N].

    loaded: whether they depend on the reaction force.
    """

    dof: int
    sliding: Callable[[float, float, float], float]  # (speed, reaction, position) -> limit
    static: Callable[[float, float], float]  # (reaction, position) -> limit
    loaded: bool = False


@dataclass(frozen=True)
class Hidden:
    """What is concealed in the dynamics.

    torques: generalized forces (t, q, v) -> (n,).
    dry: dry friction by degree of freedom.
    states: internal states as (size, rate(t, q, v, z), torque(t, q, v, z)).
    gravity: acceleration of free fall at time t, shape (3,).
    edit: changes the compiled model at time t (a leak, a moving mass).
    breaks: times where a law is not smooth.
    kicks: at a time, (q, v) -> (q, v).
    constraint: of one degree of freedom, where nothing rubs dry beside it.
    """

    torques: Sequence[Torque] = ()
    dry: Sequence[DryFriction] = ()
    states: Sequence[tuple[int, Callable[..., Array], Callable[..., Array]]] = ()
    gravity: Callable[[float], Array] | None = None
    edit: Callable[[float, mujoco.MjModel], None] | None = None
    breaks: Sequence[float] = ()
    kicks: dict[float, Callable[[Array, Array], tuple[Array, Array]]] = field(default_factory=dict)
    constraint: tuple[int, Constraint] | None = None


def as_floats(s: Segment) -> Segment:
    """The segment with plain floats, whose ``repr`` MJCF understands."""
    plain: dict[str, Any] = {k: v if isinstance(v, str) else float(v) for k, v in asdict(s).items()}
    return Segment(**plain)


def mechanism_xml(
    rig: Rig,
    *,
    inserts: dict[int, str] | None = None,
    base: str = "",
    extra: dict[int, str] | None = None,
    splits: Mapping[int, Sequence[tuple[float, str]]] | None = None,
) -> str:
    """MJCF of the rig.

    inserts: joints put between a segment's hinge and its body (spring hinges), by segment index.
    base: joints of a moving base with its inertia.
    extra: further elements (hidden bodies) inside a segment's body.
    splits: joints down a segment, as (fraction of its length, joint element): a link that bends there.
    """
    ax = " ".join(repr(float(a)) for a in rig.axis)
    inserts, extra, splits = inserts or {}, extra or {}, splits or {}
    inner = ""
    for k in reversed(range(len(rig.segments))):
        s = rig.segments[k]
        s = as_floats(s)
        top = 0.0 if k == 0 else -float(rig.segments[k - 1].length)
        beside = " ".join(repr(float(x) * s.side) for x in np.cross(rig.axis, (0.0, 0.0, -1.0))[:2])
        inertial = (
            f'<inertial pos="{beside} {-s.com!r}" mass="{s.mass!r}" '
            f'diaginertia="{s.inertia!r} {s.inertia!r} {s.inertia!r}"/>'
        )
        hinge = f'<joint name="{s.joint}" type="hinge" axis="{ax}" damping="{s.damping!r}" armature="{s.armature!r}"/>'
        body = inertial + extra.get(k, "") + inner
        if k in splits:
            body = _split(s, splits[k], extra.get(k, "") + inner)
        if k in inserts:
            body = (
                f'{hinge}<inertial pos="0 0 0" mass="1e-9" diaginertia="1e-12 1e-12 1e-12"/>'
                f'<body name="{s.link}">{inserts[k]}{body}</body>'
            )
            inner = f'<body name="{s.link}_hub" pos="0 0 {top!r}">{body}</body>'
        else:
            inner = f'<body name="{s.link}" pos="0 0 {top!r}">{hinge}{body}</body>'
    if base:
        inner = f'<body name="moving_base">{base}{inner}</body>'
    return (
        '<mujoco><compiler angle="radian" inertiafromgeom="false" boundmass="0" boundinertia="0"/>'
        f'<option gravity="0 0 {-rig.gravity!r}"><flag contact="disable" constraint="disable"/></option>'
        f"<worldbody>{inner}</worldbody></mujoco>"
    )


def _split(s: Segment, bends: Sequence[tuple[float, str]], rest: str) -> str:
    """The inside of a segment cut in pieces: a rod with a bob at its end, of the segment's mass, centre and inertia.

    What the three numbers leave over after a uniform rod and its bob is shared among the pieces so as to change them least.
    Raises NoSolutionError where that takes pieces of negative mass, as a centre far beside the rod's does.
    """
    edges = np.array([0.0, *(fraction for fraction, _ in bends), 1.0]) * s.length
    widths = np.diff(edges)
    places = np.append(edges[:-1] + widths / 2, s.length)
    own = np.append(widths**2 / 12, 0.0)
    bob = s.mass * (2.0 * s.com / s.length - 1.0)
    masses = np.append((s.mass - bob) * widths / s.length, bob)
    wanted = np.array([s.mass, s.mass * s.com, s.inertia + s.mass * s.com**2])
    held = np.array([np.ones(len(places)), places, places**2 + own])
    masses = masses + np.linalg.pinv(held) @ (wanted - held @ masses)
    # The bob goes with the last piece; what hangs on the segment is placed from its joint.
    pieces, tips = masses[:-1], np.append(np.zeros(len(bends)), masses[-1])
    if not np.all(pieces + tips > 0.0):
        raise NoSolutionError(f"no rod that bends has the mass, centre and inertia of {s.link}")
    inside = (
        f'<body name="{s.link}_end" pos="0 0 {float(edges[-2])!r}"><inertial pos="0 0 0" mass="1e-9" '
        f'diaginertia="1e-12 1e-12 1e-12"/>{rest}</body>'
    )
    for k in reversed(range(len(widths))):
        width, mass = widths[k], pieces[k] + tips[k]
        centre = (pieces[k] * width / 2 + tips[k] * width) / mass
        inertia = pieces[k] * (own[k] + (width / 2 - centre) ** 2) + tips[k] * (width - centre) ** 2
        inside = (
            f'<inertial pos="0 0 {-float(centre)!r}" mass="{float(mass)!r}" '
            f'diaginertia="{float(inertia)!r} {float(inertia)!r} {float(inertia)!r}"/>{inside}'
        )
        if k > 0:
            inside = f'<body name="{s.link}_{k}" pos="0 0 {-float(widths[k - 1])!r}">{bends[k - 1][1]}{inside}</body>'
    return inside


def _solved(mass: Array, force: Array) -> Array:
    """M⁻¹ f for a mass matrix, positive definite; the short way where there is one, taken a million times."""
    if len(force) == 1:
        return np.asarray(force / mass[0, 0])
    if len(force) == 2:
        a, b, d = float(mass[0, 0]), float(mass[0, 1]), float(mass[1, 1])
        f, g = float(force[0]), float(force[1])
        return np.array([d * f - b * g, a * g - b * f]) / (a * d - b * b)
    return np.asarray(dposv(mass, force)[1]) if len(force) else force


class Truth:
    """A mechanism with something concealed in it, ready to be released."""

    def __init__(self, xml: str, hidden: Hidden) -> None:
        self.model = mujoco.MjModel.from_xml_string(xml)
        self.data = mujoco.MjData(self.model)
        self.xml, self.hidden = xml, hidden
        self.n = self.model.nv
        self.dof = {
            mujoco.mj_id2name(self.model, mujoco.mjtObj.mjOBJ_JOINT, j): int(self.model.jnt_dofadr[j])
            for j in range(self.model.njnt)
        }
        self._mass = np.zeros((self.n, self.n))
        self._loaded = any(friction.loaded for friction in hidden.dry)
        self._states = sum(size for size, _, _ in hidden.states)

    def _solve(
        self, t: float, q: Array, v: Array, z: Array, mode: Array, effort: Callable[[float], Array] | None
    ) -> tuple[Array, Array]:
        """Accelerations, and for every locked degree of freedom the force that holds it."""
        m, d, hidden = self.model, self.data, self.hidden
        if hidden.gravity is not None:
            m.opt.gravity[:] = hidden.gravity(t)
        if hidden.edit is not None:
            hidden.edit(t, m)
        d.qpos[:] = q
        d.qvel[:] = v
        mujoco.mj_forward(m, d)
        mujoco.mj_fullM(m, d, self._mass)
        force = d.qfrc_passive - d.qfrc_bias
        for torque in hidden.torques:
            force = force + torque(t, q, v)
        if effort is not None:
            force = force + effort(t)
        offset = 0
        for size, _, torque in hidden.states:
            force = force + torque(t, q, v, z[offset : offset + size])
            offset += size
        if not hidden.dry:
            return self._constrained(q, v, _solved(self._mass, force)), np.zeros(self.n)
        free = np.ones(self.n, dtype=bool)
        for friction in hidden.dry:
            free[friction.dof] = mode[friction.dof] != 0
        acceleration = np.zeros(self.n)
        rubbing = force.copy()
        load = dict.fromkeys((f.dof for f in hidden.dry), 0.0)
        for _ in range(LOAD_ITERATIONS):
            rubbing = force.copy()
            for friction in hidden.dry:
                s = mode[friction.dof]
                if s != 0:
                    limit = friction.sliding(abs(v[friction.dof]), load[friction.dof], q[friction.dof])
                    rubbing[friction.dof] -= s * limit
            if free.all():
                acceleration = _solved(self._mass, rubbing)
            else:
                acceleration[free] = _solved(self._mass[np.ix_(free, free)], rubbing[free])
            if not self._loaded:
                break
            d.qacc[:] = acceleration
            mujoco.mj_rnePostConstraint(m, d)
            for friction in hidden.dry:
                body = m.dof_bodyid[friction.dof]
                load[friction.dof] = float(np.linalg.norm(d.cfrc_int[body, 3:]))
        self._load = load
        return acceleration, force - self._mass @ acceleration

    def _constrained(self, q: Array, v: Array, acceleration: Array) -> Array:
        """Accelerations with the constraint, given those without it."""
        if self.hidden.constraint is None:
            return acceleration
        dof, law = self.hidden.constraint
        gives = _solved(self._mass, np.eye(self.n)[dof])
        return acceleration + gives * law(float(q[dof]), float(v[dof]), float(acceleration[dof]), float(gives[dof]))

    def release(
        self,
        q0: Array,
        v0: Array,
        time: Array,
        *,
        effort: Callable[[Any], Array] | None = None,
        jumps: Sequence[float] | Array = (),
        tolerance: float = RELATIVE_TOLERANCE,
    ) -> tuple[Array, Array]:
        """Position and velocity of every degree of freedom at ``time``, each shape (T, n).

        effort: times of any shape -> generalized forces, shape (*shape, n). jumps: times where it changes, if it is held in
        between. tolerance: relative, of a step.
        """
        if self.hidden == Hidden() and has_springs(self.model) and even(time):
            return run(self.model, q0, v0, time, effort)
        n = self.n
        rub = [f.dof for f in self.hidden.dry]
        mode = np.zeros(n, dtype=int)
        for f in self.hidden.dry:
            mode[f.dof] = int(np.sign(v0[f.dof]))
        z = np.zeros(self._states)
        t = float(time[0])
        end = float(time[-1])
        out_q, out_v = (np.zeros((len(time), n)) for _ in range(2))
        q, v = np.array(q0, float), np.array(v0, float)
        stops = sorted({float(b) for b in (*self.hidden.breaks, *self.hidden.kicks, *jumps) if t < b < end} | {end})
        ahead = 0
        filled = 0
        static = {f.dof: f for f in self.hidden.dry}

        def settle() -> None:
            """Give every resting degree of freedom its mode: locked, or sliding the way it is pushed."""
            for j in rub:
                if v[j] != 0.0:
                    continue
                mode[j] = 0
            for j in rub:
                if mode[j] == 0:
                    _, hold = self._solve(t, q, v, z, mode, acting)
                    if abs(hold[j]) > static[j].static(self._load[j], q[j]):
                        mode[j] = int(np.sign(hold[j]))

        # What acts until the next jump: at its ends a step would see the neighbours' efforts.
        held: list[Array] = []
        acting = None if effort is None else lambda tt: held[0] if held else effort(tt)
        turns_taken = 0
        while t < end:
            while stops[ahead] <= t:
                ahead += 1
            stop = stops[ahead]
            if len(jumps) and effort is not None:
                held[:] = [effort(0.5 * (t + stop))]
            if t == float(time[0]) or len(jumps):
                settle()

            def rate(tt: float, y: Array) -> Array:
                a, _ = self._solve(tt, y[:n], y[n : 2 * n], y[2 * n :], mode, acting)
                vel = y[n : 2 * n].copy()
                vel[[j for j in rub if mode[j] == 0]] = 0.0
                zdot = []
                offset = 0
                for size, f, _ in self.hidden.states:
                    zdot.append(f(tt, y[:n], y[n : 2 * n], y[2 * n + offset : 2 * n + offset + size]))
                    offset += size
                return np.concatenate([vel, a, *zdot])

            events: list[_Ending] = []
            for j in rub:
                if mode[j] != 0:

                    def turns(tt: float, y: Array, j: int = j, s: int = int(mode[j])) -> float:
                        return float(s * y[n + j])

                    events.append(_Ending(turns, -1))
                else:

                    def slips(tt: float, y: Array, j: int = j) -> float:
                        _, hold = self._solve(tt, y[:n], y[n : 2 * n], y[2 * n :], mode, acting)
                        return float(abs(hold[j]) - static[j].static(self._load[j], y[j]))

                    events.append(_Ending(slips, 1))
            y0 = np.concatenate([q, v, z])
            solution = solve_ivp(
                rate, (t, stop), y0, method="DOP853", rtol=tolerance, atol=ABSOLUTE_TOLERANCE / RELATIVE_TOLERANCE * tolerance,
                events=events or None, dense_output=True, max_step=0.05,
            )  # fmt: skip
            reached = float(solution.t[-1])
            if filled < len(time):
                upto = int(np.searchsorted(time, reached, side="right"))
                if upto > filled:
                    span = solution.sol(time[filled:upto])
                    out_q[filled:upto], out_v[filled:upto] = span[:n].T, span[n : 2 * n].T
                    filled = upto
            q, v, z = solution.y[:n, -1].copy(), solution.y[n : 2 * n, -1].copy(), solution.y[2 * n :, -1].copy()
            t = reached
            if solution.status == 1:
                for j, found in zip(rub, solution.t_events, strict=True):
                    if len(found):
                        if mode[j] != 0:
                            v[j] = 0.0
                            mode[j] = 0
                            _, hold = self._solve(t, q, v, z, mode, acting)
                            if abs(hold[j]) > static[j].static(self._load[j], q[j]):
                                mode[j] = int(np.sign(hold[j]))
                        else:
                            _, hold = self._solve(t, q, v, z, mode, acting)
                            mode[j] = int(np.sign(hold[j]))
            for when, kick in self.hidden.kicks.items():
                if abs(t - when) < 1e-12:
                    q, v = kick(q, v)
                    for j in rub:
                        mode[j] = int(np.sign(v[j]))
                    settle()
            turns_taken += solution.status == 1
            if turns_taken > 3_000:
                raise NoSolutionError("the concealed truth chatters; its friction laws have no solution")
        return out_q, out_v
