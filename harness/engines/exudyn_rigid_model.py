"""Exudyn: rigid trees in minimal coordinates by its ``ObjectKinematicTree`` (composite-body algorithm).

Its own time integration is RK4. Exudyn has no dry friction that sticks, so systems with it are not simulated.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from harness.engines.checked import (
    finite_result,
    held_forces,
    no_dry_friction,
    positive_step,
    sample_times,
    vector,
    vectors,
)
from harness.engines.expressed import JointForces, express
from harness.engines.exudyn_run import exudyn_package, quiet, settings
from harness.engines.folded import bodies
from harness.engines.protocol import Array, EngineError
from harness.engines.small_motion import frequencies, jacobian
from harness.errors import UnsupportedError
from harness.system import System, Trajectory
from harness.system.rotation import skew

DEFAULT_STEP = 1e-3
# Its mass matrix is dense and built link by link; longer trees take seconds a call.
LARGEST = 100


def aligned(axis: Array) -> Array:
    """The smallest rotation that takes z to ``axis``, shape (3, 3)."""
    z = np.array([0.0, 0.0, 1.0])
    cosine = float(axis @ z)
    if cosine < -0.5:
        # Near the antipode the formula below loses digits: turn half round x first.
        half = np.diag([1.0, -1.0, -1.0])
        return half @ aligned(half @ axis)
    s = skew(np.cross(z, axis))
    return np.eye(3) + s + s @ s / (1.0 + cosine)


@dataclass(frozen=True, eq=False)
class ExudynModel:
    """A system in Exudyn; see ``EngineModel``. tree, node: item numbers in ``mbs``."""

    names: tuple[str, ...]
    system: System
    mbs: Any
    tree: Any
    node: Any
    sensors: tuple[Any, Any]
    damping: Array
    stiffness: Array
    rest: Array
    forces: JointForces

    def _passive(self, q: Array, qd: Array) -> Array:
        return -self.damping * qd - self.stiffness * (q - self.rest) + self.forces(q, qd)

    def _set(self, q: Array, qd: Array) -> None:
        kinds = exudyn_package().ConfigurationType
        for configuration in (kinds.Initial, kinds.Current):
            self.mbs.systemData.SetODE2Coordinates(q, configuration)
            self.mbs.systemData.SetODE2Coordinates_t(qd, configuration)

    def _terms(self, q: Array, qd: Array) -> tuple[Array, Array]:
        """Mass matrix and right-hand side without applied forces, from the solver's own routines."""
        exudyn = exudyn_package()
        self._set(q, qd)
        made = settings(exudyn, 1.0, 1, 1.0, relative=1e-8, absolute=1e-10)
        solver = exudyn.MainSolverImplicitSecondOrder()
        with quiet(exudyn):
            if not solver.InitializeSolver(self.mbs, made):
                raise EngineError("exudyn could not initialize its solver")
            solver.ComputeMassMatrix(self.mbs)
            mass = np.array(solver.GetSystemMassMatrix())
            solver.ComputeODE2RHS(self.mbs)
            right = np.array(solver.GetSystemResidual())[: len(self.names)]
            solver.FinalizeSolver(self.mbs, made)
        return mass, right

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        q, qd, tau = vectors(len(self.names), q=q, qd=qd, tau=tau)
        mass, right = self._terms(q, qd)
        return finite_result("exudyn", "forward dynamics", np.linalg.solve(mass, right + tau))

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        q, qd, qdd = vectors(len(self.names), q=q, qd=qd, qdd=qdd)
        mass, right = self._terms(q, qd)
        return mass @ qdd - right

    def mass_matrix(self, q: Array) -> Array:
        q = vector("q", q, len(self.names))
        return self._terms(q, np.zeros_like(q))[0]

    def bias(self, q: Array, qd: Array) -> Array:
        q, qd = vectors(len(self.names), q=q, qd=qd)
        return -self._free._terms(q, qd)[1]

    @cached_property
    def _free(self) -> ExudynModel:
        """The system without passive forces, which a stiff spring would leave nothing but rounding of to take off again."""
        if not (self.forces.any or self.damping.any() or self.stiffness.any()):
            return self
        joints = tuple(replace(j, damping=0.0, stiffness=0.0, rest_position=0.0) for j in self.system.joints)
        return rigid_model(replace(self.system, joints=joints))

    def gravity(self, q: Array) -> Array:
        return self.bias(q, np.zeros(len(self.names)))

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        raise UnsupportedError("Exudyn does not tell the energy of a kinematic tree")

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """Exudyn's explicit RK4 with steps of at most ``step`` [s] (1 ms if None)."""
        no_dry_friction("Exudyn's trees have", self.system)
        n = len(self.names)
        q0, qd0 = vectors(n, q0=q0, qd0=qd0)
        time = sample_times(time)
        forces = held_forces(tau, time.size, n)
        largest = positive_step(step) or self.default_step
        position, velocity = np.empty((time.size, n)), np.empty((time.size, n))
        position[0], velocity[0] = q0, qd0
        for first, last in _stretches(time, forces):
            if forces is not None:
                self.mbs.SetObjectParameter(self.tree, "jointForceVector", forces[first])
            q, qd = self._run(position[first], velocity[first], time[first : last + 1], largest)
            position[first + 1 : last + 1], velocity[first + 1 : last + 1] = q, qd
        self.mbs.SetObjectParameter(self.tree, "jointForceVector", np.zeros(n))
        return Trajectory(time=time, names=self.names, position=position, velocity=velocity)

    def _run(self, q: Array, qd: Array, time: Array, largest: float) -> tuple[Array, Array]:
        """Samples after the first of an evenly spaced run from (q, qd)."""
        self._set(q, qd)
        samples = time.size - 1
        span = float(time[-1] - time[0])
        per_sample = max(1, int(np.ceil(span / samples / largest * (1.0 - 1e-9))))
        # A hair under the sample spacing, so that rounding of the time never skips a sample.
        every = span / samples * (1.0 - 1e-9)
        if not self._solve(span, samples * per_sample, every):
            raise EngineError(f"exudyn stopped between t = {time[0]} and {time[-1]} s: use a smaller step")
        stored = [np.array(self.mbs.GetSensorStoredData(sensor)) for sensor in self.sensors]
        if any(len(table) != samples + 1 for table in stored):
            raise EngineError(f"exudyn returned {len(stored[0])} samples for {samples + 1}")
        if not all(np.all(np.isfinite(table)) for table in stored):
            raise EngineError(f"exudyn's motion is not finite before t = {time[-1]} s: use a smaller step")
        return stored[0][1:, 1:], stored[1][1:, 1:]

    @property
    def default_step(self) -> float:
        """Steps [s] where none are asked for."""
        return DEFAULT_STEP

    def _solve(self, span: float, steps: int, every: float) -> bool:
        """Run over ``span`` [s] in equal steps, sensors every ``every`` [s]; whether it got through."""
        exudyn = exudyn_package()
        made = settings(exudyn, span, steps, every, relative=1e-8, absolute=1e-10)
        try:
            with quiet(exudyn):
                done = self.mbs.SolveDynamic(made, solverType=exudyn.DynamicSolverType.RK44, updateInitialValues=False)
        except Exception:  # Exudyn raises its own kind, or RuntimeError
            return False
        return done is not False

    def frequencies(self, q: Array) -> Array:
        q = vector("q", q, len(self.names))
        stiffness = jacobian(lambda x: self.gravity(x) - self._passive(x, np.zeros_like(x)), q)
        return frequencies(self.mass_matrix(q), stiffness)


def _stretches(time: Array, forces: Array | None) -> list[tuple[int, int]]:
    """Runs of samples, evenly spaced and under one force."""
    gaps = np.diff(time)
    runs: list[tuple[int, int]] = []
    first = 0
    for k in range(1, time.size):
        last = k == time.size - 1
        uneven = not last and abs(gaps[k] - gaps[first]) > 1e-9 * gaps[first]
        pushed = forces is not None and not np.array_equal(forces[k], forces[first])
        if last or uneven or pushed:
            runs.append((first, k))
            first = k
    return runs


def exudyn_tree(system: System, forces: JointForces | None = None) -> tuple[Any, Any, Any]:
    """(mbs, tree, node) of the rigid system, not yet assembled.

    Conventions, all of them: Exudyn's joints turn about z of their frame, so every body's frame is turned by
    ``aligned(axis)``; offsets are in the parent's (turned) frame and come before the rotation; inertias are about the
    centre of mass in the turned frame. Links that fixed joints tie together are one body. Damping and springs are its
    joint controllers with target ``rest`` and target velocity zero. Armature is a second object on the same
    coordinates with a diagonal mass matrix. Joint laws are its force user function. Gravity is free fall in both. The
    order of coordinates is ours.
    """
    exudyn = exudyn_package()
    from exudyn.itemInterface import NodeGenericODE2, ObjectGenericODE2, ObjectKinematicTree

    parts, _ = bodies(system)
    turns = [aligned(np.asarray(part.joint.axis)) for part in parts]
    base = np.eye(3)
    joints = [part.joint for part in parts]
    n = len(parts)
    mbs = exudyn.SystemContainer().AddSystem()
    laws = {}
    if forces is not None and forces.any:
        # Exudyn calls with (mbs, t, item number, q, q_t).
        laws = {"forceUserFunction": lambda _mbs, _t, _item, q, qd: forces(np.array(q), np.array(qd))}
    node = mbs.AddNode(
        NodeGenericODE2(
            referenceCoordinates=np.zeros(n),
            initialCoordinates=np.zeros(n),
            initialCoordinates_t=np.zeros(n),
            numberOfODE2Coordinates=n,
        )
    )
    kinds = exudyn.JointType
    carriers = [turns[part.parent] if part.parent >= 0 else base for part in parts]
    tree = mbs.AddObject(
        ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[kinds.PrismaticZ if joint.prismatic else kinds.RevoluteZ for joint in joints],
            linkParents=[part.parent for part in parts],
            jointTransformations=exudyn.Matrix3DList(
                [up.T @ part.rotation @ turn for part, up, turn in zip(parts, carriers, turns, strict=True)]
            ),
            jointOffsets=exudyn.Vector3DList([up.T @ part.xyz for part, up in zip(parts, carriers, strict=True)]),
            linkInertiasCOM=exudyn.Matrix3DList(
                [turn.T @ part.inertia @ turn for part, turn in zip(parts, turns, strict=True)]
            ),
            linkCOMs=exudyn.Vector3DList([turn.T @ part.com for part, turn in zip(parts, turns, strict=True)]),
            linkMasses=[part.mass for part in parts],
            baseOffset=[0.0, 0.0, 0.0],
            gravity=np.array(system.gravity),
            jointForceVector=np.zeros(n),
            jointPositionOffsetVector=np.array([joint.rest_position for joint in joints]),
            jointVelocityOffsetVector=np.zeros(n),
            jointPControlVector=np.array([joint.stiffness for joint in joints]),
            jointDControlVector=np.array([joint.damping for joint in joints]),
            **laws,
        )
    )
    armature = np.array([joint.armature for joint in joints])
    if np.any(armature):
        mbs.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.diag(armature)))
    return mbs, tree, node


def rigid_model(
    system: System, kind: type[ExudynModel] | None = None, close: Callable[[Any, Any], None] | None = None
) -> ExudynModel:
    """A system in Exudyn; kind, close: the class of model, and what adds joints that close loops to (mbs, tree)."""
    exudyn = exudyn_package()
    from exudyn.itemInterface import SensorNode

    expressed = express(system)
    system = expressed.system
    mbs, tree, node = exudyn_tree(system, expressed.forces)
    kinds = exudyn.OutputVariableType
    if close is not None:
        close(mbs, tree)
    position, velocity = (
        mbs.AddSensor(SensorNode(nodeNumber=node, storeInternal=True, writeToFile=False, outputVariableType=each))
        for each in (kinds.Coordinates, kinds.Coordinates_t)
    )
    mbs.Assemble()
    joints = system.movable_joints
    return (kind or ExudynModel)(
        names=system.joint_names,
        system=system,
        mbs=mbs,
        tree=tree,
        node=node,
        sensors=(position, velocity),
        damping=np.array([joint.damping for joint in joints]),
        stiffness=np.array([joint.stiffness for joint in joints]),
        rest=np.array([joint.rest_position for joint in joints]),
        forces=expressed.forces,
    )
