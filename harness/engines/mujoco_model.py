"""MuJoCo: composite-body dynamics by sparse factorization, built through ``MjSpec`` (XML nesting ends near n = 500).

Integrated by RK4, the only one of its integrators that converges fast enough to be compared with; contacts and equalities are
off, and so are limits but where the effect ``stop_inertia`` makes a stop the soft constraint that they are. Dry friction is
MuJoCo's ``frictionloss``, a soft constraint too: it turns over not where the velocity v does but where v + a τ does, a being the
acceleration without it and τ the constraint's time constant (10 ms by default), and creeps where a joint should stick. It is made
as sudden and as stiff here as MuJoCo allows, τ being two steps, unless the effect ``friction_softness`` says how soft it is.
Friction and limits act in ``simulate`` alone, so that accelerations stay comparable.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.compiled_packages import loaded
from harness.engines.checked import (
    finite_result,
    held_forces,
    positive_step,
    sample_times,
    vector,
)
from harness.engines.expressed import JointForces, Shaking
from harness.engines.protocol import Array, EngineError
from harness.engines.small_motion import frequencies, jacobian
from harness.errors import UnsupportedError, cannot_be_loaded
from harness.system import JointType, System, Trajectory
from harness.system.mjcf_names import body_names

# At 1 ms a pendulum swung to 120° is within 5e-10 rad of the exact solution over ten seconds.
DEFAULT_STEP = 1e-3
# Where a joint runs into a limit the force jumps, and where a drive leaves its range it bends: steps that this falls into err more.
STEP_WITH_BLOWS = 1e-4
# Below this MuJoCo's compiler refuses the mass or inertia of a moving body (its mjMINVAL is 1e-15).
SMALLEST = 1e-14
# Time constant [s] and damping ratio of dry friction: MuJoCo raises the first to two steps by itself.
SUDDEN_FRICTION = (1e-6, 1.0)
# Impedance of dry friction: the largest that MuJoCo takes, at any violation.
STIFF_FRICTION = (0.9999, 0.9999, 1e-3, 0.5, 2.0)
# MuJoCo treats positions and velocities above 1e10 as broken and resets them.
HUGE = 1e10


def _mujoco() -> Any:
    try:
        return loaded("mujoco")
    except ImportError as error:
        raise cannot_be_loaded("MuJoCo", error, "pip install mujoco") from None


def quaternion(rotation: Array) -> Array:
    """Unit quaternion (w, x, y, z) of a rotation matrix, shape (4,)."""
    x, y, z, w = Rotation.from_matrix(rotation).as_quat(canonical=True)
    return np.array([w, x, y, z])


def principal(inertia: Array) -> tuple[Array, Array]:
    """Principal moments, shape (3,), and the quaternion of their axes; rounding is kept from breaking A + B ≥ C.

    LAPACK does this rather than MuJoCo's ``fullinertia``, whose iteration stops at a relative 1e-12.
    """
    if np.count_nonzero(inertia - np.diag(np.diagonal(inertia))) == 0:
        return np.diagonal(inertia).copy(), np.array([1.0, 0.0, 0.0, 0.0])
    moments, axes = np.linalg.eigh(inertia)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    return moments, quaternion(axes)


def mujoco_spec(system: System, step: float = DEFAULT_STEP, forces: JointForces | None = None) -> Any:
    """The rigid system as an ``MjSpec``; inertias too small for MuJoCo's compiler stand in as SMALLEST.

    Conventions, all of them: the link frame is MuJoCo's body frame, and the joint sits at its origin with our axis;
    body ``pos`` and ``quat`` are our ``xyz`` and ``rotation``; angles are radians; inertias are given about the centre
    of mass by principal moments and axes. ``springref`` is our rest position and ``ref`` stays zero, so that
    positions mean the same. Quadratic drag is the second coefficient of ``damping``, a cubic spring the third of
    ``stiffness``; polynomials are all of them. A ball joint has our positions and velocities; a free joint is three
    slides and a ball, which have them too (MuJoCo's own free joint is of the world alone). Free fall is ``option.gravity``.
    MuJoCo numbers joints depth first; ``MujocoModel.order`` and ``places`` map by name.
    """
    mujoco = _mujoco()
    spec = mujoco.MjSpec()
    spec.modelname = system.name
    spec.compiler.degree = False
    spec.compiler.boundmass = 0.0
    spec.compiler.boundinertia = 0.0
    spec.compiler.balanceinertia = False
    spec.compiler.fusestatic = False
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.timestep = step
    spec.option.gravity = np.array(system.gravity)
    spec.option.disableflags = int(_silent_flags(mujoco))
    places = {name: k for k, name in enumerate(system.coordinate_names)}
    carriers = {system.base: spec.worldbody}
    bodies = body_names(system)
    for joint, link in zip(system.joints, system.links, strict=True):
        moments, axes = principal(np.asarray(link.inertia))
        body = carriers[joint.parent].add_body(
            name=bodies[joint.child],
            pos=np.array(joint.xyz),
            quat=quaternion(joint.rotation),
            mass=max(float(link.mass), SMALLEST),
            ipos=np.array(link.com),
            # What compiles does not matter: `mujoco_model` writes the true values afterwards.
            inertia=np.full(3, max(float(np.max(moments)), SMALLEST)),
            iquat=axes,
            gravcomp=link.gravcomp,
            explicitinertial=True,
        )
        carriers[joint.child] = body
        if joint.turns_in_space:
            if joint.type is JointType.FREE:
                for k, letter in enumerate("xyz"):
                    body.add_joint(
                        name=f"{joint.name}.{letter}",
                        type=mujoco.mjtJoint.mjJNT_SLIDE,
                        axis=np.eye(3)[k],
                        damping=np.array([joint.damping, 0.0, 0.0]),
                        armature=joint.armature,
                    )
            body.add_joint(
                name=joint.name,
                type=mujoco.mjtJoint.mjJNT_BALL,
                damping=np.array([joint.damping, 0.0, 0.0]),
                armature=joint.armature,
            )
        elif joint.movable:
            kind = mujoco.mjtJoint.mjJNT_SLIDE if joint.prismatic else mujoco.mjtJoint.mjJNT_HINGE
            k = places[joint.name]
            drag, thick, square, cubic, slack = 0.0, 0.0, 0.0, 0.0, joint.rest_position if joint.stiffness else 0.0
            if forces is not None:
                drag, thick, square = forces.drag[k], forces.thick[k], forces.square[k]
                cubic = forces.cubic[k] + forces.cube[k]
                slack = forces.slack[k] if square or forces.cube[k] else slack
            body.add_joint(
                name=joint.name,
                type=kind,
                pos=np.zeros(3),
                axis=np.array(joint.axis),
                damping=np.array([joint.damping, drag, thick]),
                stiffness=np.array([joint.stiffness, square, cubic]),
                springref=slack,
                armature=joint.armature,
                frictionloss=joint.friction,
                solref_friction=np.array(SUDDEN_FRICTION),
                solimp_friction=np.array(STIFF_FRICTION),
            )
    return spec


def _silent_flags(mujoco: Any) -> Any:
    """Everything off that is not rigid-body dynamics, and the silent reset of broken states."""
    off = mujoco.mjtDisableBit
    return off.mjDSBL_CONSTRAINT | off.mjDSBL_CONTACT | off.mjDSBL_LIMIT | off.mjDSBL_EQUALITY | off.mjDSBL_AUTORESET


def mujoco_model(
    system: System,
    step: float = DEFAULT_STEP,
    forces: JointForces | None = None,
    close: Callable[[Any, Any], None] | None = None,
) -> Any:
    """The rigid system as a compiled ``MjModel`` with exactly our masses and inertias; UnsupportedError if refused.

    close: adds to the ``MjSpec`` what closes loops.
    """
    mujoco = _mujoco()
    try:
        spec = mujoco_spec(system, step, forces)
        if close is not None:
            close(mujoco, spec)
        model = spec.compile()
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise UnsupportedError(f"MuJoCo refuses the system: {reason}", source=system.source) from None
    bodies = body_names(system)
    for link in system.links:
        body = model.body(bodies[link.name]).id
        model.body_mass[body] = link.mass
        model.body_inertia[body] = principal(np.asarray(link.inertia))[0]
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


@dataclass(frozen=True, eq=False)
class MujocoModel:
    """A system in MuJoCo; see ``EngineModel``. ``order`` [k] is our index of MuJoCo's velocity k, ``places`` of its position k.

    local: where the positions stand that joint laws see, by velocity, -1 for none.
    """

    names: tuple[str, ...]
    position_names: tuple[str, ...]
    places: NDArray[np.intp]
    local: NDArray[np.int64]
    system: System
    model: Any
    data: Any
    order: NDArray[np.intp]
    fixed_potential: float
    forces: JointForces
    shaking: Shaking | None

    @property
    def compensated(self) -> bool:
        """Whether part of the weight of single bodies is carried."""
        return bool(np.any(self.model.body_gravcomp))

    def _set(self, q: Array, qd: Array | None = None) -> Any:
        n = len(self.names)
        self.data.qpos[:] = vector("q", q, len(self.position_names))[self.places]
        self.data.qvel[:] = 0.0 if qd is None else vector("qd", qd, n)[self.order]
        return _mujoco()

    def _extra(self, q: Array, qd: Array) -> Array:
        """What MuJoCo's joints have no words for: constant torques, cogging, stops."""
        return self.forces.constant + self.forces.rest(self._angles(q), qd)

    def _angles(self, q: Array) -> Array:
        """Positions by velocity, zero for spins, as joint laws want them."""
        return q if len(q) == len(self.names) else np.where(self.local >= 0, q[self.local], 0.0)

    def _positions(self) -> Array:
        result = np.empty(len(self.position_names))
        result[self.places] = self.data.qpos
        return result

    def _out(self, value: Array) -> Array:
        result = np.empty(len(self.names))
        result[self.order] = value
        return result

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        mujoco = self._set(q, qd)
        self.data.qfrc_applied[:] = (vector("tau", tau, len(self.names)) + self._extra(q, qd))[self.order]
        mujoco.mj_forward(self.model, self.data)
        return finite_result("mujoco", "forward dynamics", self._out(self.data.qacc))

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        mujoco = self._set(q, qd)
        self.data.qacc[:] = vector("qdd", qdd, len(self.names))[self.order]
        mujoco.mj_inverse(self.model, self.data)
        return self._out(self.data.qfrc_inverse) - self._extra(q, qd)

    def mass_matrix(self, q: Array) -> Array:
        mujoco = self._set(q)
        mujoco.mj_fwdPosition(self.model, self.data)
        theirs = np.zeros((self.model.nv, self.model.nv))
        try:
            mujoco.mj_fullM(self.model, self.data, theirs)
        except TypeError:  # before 4.0 the sparse matrix itself was passed
            mujoco.mj_fullM(self.model, theirs, self.data.qM)
        result = np.empty_like(theirs)
        result[np.ix_(self.order, self.order)] = theirs
        return result

    def bias(self, q: Array, qd: Array) -> Array:
        mujoco = self._set(q, qd)
        mujoco.mj_fwdPosition(self.model, self.data)
        mujoco.mj_fwdVelocity(self.model, self.data)
        force = self.data.qfrc_bias
        return self._out(force - self.data.qfrc_gravcomp if self.compensated else force)

    def gravity(self, q: Array) -> Array:
        return self.bias(q, np.zeros(len(self.names)))

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        mujoco = self._set(q, qd)
        return self._energy(mujoco)

    def _energy(self, mujoco: Any) -> tuple[float, float]:
        mujoco.mj_fwdPosition(self.model, self.data)
        mujoco.mj_energyPos(self.model, self.data)
        mujoco.mj_energyVel(self.model, self.data)
        # MuJoCo counts what is welded to the world as well, and not what compensates weight.
        potential = float(self.data.energy[0]) - self.fixed_potential
        if self.compensated:
            carried = self.model.body_gravcomp * self.model.body_mass * (self.model.body_weldid != 0)
            potential += float(carried @ self.data.xipos @ self.model.opt.gravity)
        return float(self.data.energy[1]), potential

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """RK4 with steps of at most ``step`` [s] (1 ms if None, 0.1 ms with limits or drives that have a range of force).

        EngineError where the motion breaks down.
        """
        n = len(self.names)
        time = sample_times(time)
        forces = held_forces(tau, time.size, n)
        sudden = np.any(self.model.jnt_limited) or self.system.drives
        largest = positive_step(step) or (STEP_WITH_BLOWS if sudden else DEFAULT_STEP)
        mujoco = _mujoco()
        mujoco.mj_resetData(self.model, self.data)
        self._set(q0, qd0)
        position, velocity = np.empty((time.size, len(self.position_names))), np.empty((time.size, n))
        energy = np.empty(time.size)
        with self._constraints(mujoco), self._laws(mujoco), _unlogged(mujoco):
            for k, now in enumerate(time):
                if k:
                    span = now - time[k - 1]
                    # A hair of slack, so that a sample spacing equal to the step is one step in spite of rounding.
                    count = max(1, int(np.ceil(span / largest * (1.0 - 1e-9))))
                    self.model.opt.timestep = span / count
                    applied = self.forces.constant if forces is None else forces[k - 1] + self.forces.constant
                    self.data.qfrc_applied[:] = applied[self.order]
                    mujoco.mj_step(self.model, self.data, nstep=count)
                    self._check(mujoco, now)
                position[k] = self._positions()
                velocity[k] = self._out(self.data.qvel)
                energy[k] = sum(self._energy(mujoco))
        self.data.qfrc_applied[:] = 0.0
        return Trajectory(
            time=time,
            names=self.names,
            position=position,
            velocity=velocity,
            energy=energy,
            position_names=self.position_names,
        )

    def _check(self, mujoco: Any, now: float) -> None:
        broken = {
            name: int(self.data.warning[int(kind)].number)
            for name, kind in mujoco.mjtWarning.__members__.items()
            if name in ("mjWARN_BADQPOS", "mjWARN_BADQVEL", "mjWARN_BADQACC", "mjWARN_INERTIA")
        }
        state = np.concatenate([self.data.qpos, self.data.qvel])
        if any(broken.values()) or not np.all(np.abs(state) < HUGE):
            said = ", ".join(name for name, number in broken.items() if number) or "a huge or non-finite state"
            raise EngineError(f"mujoco broke down before t = {now} s ({said}): use a smaller step")

    @contextmanager
    def _constraints(self, mujoco: Any) -> Iterator[None]:
        """Constraints on while a system with dry friction or limits is simulated."""
        kept = int(self.model.opt.disableflags)
        if np.any(self.model.dof_frictionloss) or np.any(self.model.jnt_limited):
            off = mujoco.mjtDisableBit
            self.model.opt.disableflags = kept & ~int(off.mjDSBL_CONSTRAINT | off.mjDSBL_LIMIT)
        try:
            yield
        finally:
            self.model.opt.disableflags = kept

    @contextmanager
    def _laws(self, mujoco: Any) -> Iterator[None]:
        """Cogging, stops and the shaking base, evaluated at every stage of every step by MuJoCo's callback."""
        if not self.forces.irregular and self.shaking is None:
            yield
            return
        still = self.model.opt.gravity.copy()
        self.data.time = 0.0

        def passive(model: Any, data: Any) -> None:
            data.qfrc_passive[:] += self.forces.rest(self._angles(self._positions()), self._out(data.qvel))[self.order]
            if self.shaking is not None:
                # In the base's own axes everything falls the other way. MuJoCo applies gravity after this call.
                model.opt.gravity[:] = still - self.shaking(data.time)

        mujoco.set_mjcb_passive(passive)
        try:
            yield
        finally:
            mujoco.set_mjcb_passive(None)
            self.model.opt.gravity[:] = still

    def frequencies(self, q: Array) -> Array:
        q = vector("q", q, len(self.position_names))
        if len(q) != len(self.names):
            raise UnsupportedError("frequencies beside joints that turn in space are not asked of MuJoCo")
        springs = np.array([joint.stiffness for joint in self.system.movable_joints])
        stiffness = jacobian(lambda x: self.gravity(x) - self.forces(x, np.zeros_like(x)), q)
        return frequencies(self.mass_matrix(q), stiffness + np.diag(springs))


@contextmanager
def _unlogged(mujoco: Any) -> Iterator[None]:
    """Keeps MuJoCo from writing MUJOCO_LOG.TXT into the working directory; its warnings are read from counters."""
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(None)
