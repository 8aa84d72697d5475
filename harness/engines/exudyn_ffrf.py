"""Exudyn's floating frame of reference: meshed solid bars in Hurty-Craig-Bampton modes, not stiffened by rotation.

A. Zwölfer and J. Gerstmayr, The nodal-based floating frame of reference formulation with modal reduction, Acta
Mechanica 232 (2021) 835-851. The deflection is linear in the frame at the root, so a turning bar keeps its length along
the tangent and is softened by rotation: the reference for links whose ``geometric_stiffening`` is off. A link that
hangs on a bar is held by the bar's tip face; rigid links are rigid bodies.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from harness.engines.checked import held_forces, installed_version, positive_step, sample_times, vectors
from harness.engines.exudyn_joint import FrameSide, add_joint_element, held_torques
from harness.engines.exudyn_run import exudyn_package, grid, quiet, settings, solve_dynamic, stored
from harness.engines.planar import PlanarChain, PlanarLink, planar_chain, poses_and_rates, why_not_planar
from harness.engines.protocol import Array
from harness.engines.reduced_bar import ReducedBar, reduced_bar
from harness.errors import UnsupportedError
from harness.system import System, Trajectory

DEFAULT_STEP = 1e-4
#: Bricks along a bar; a thin brick is too stiff in shear, and this many leave the first frequency 0.005 % high.
DEFAULT_ELEMENTS = 96
#: Vibrations kept of a meshed bar, held at its root, and at its tip as well where a link hangs there.
DEFAULT_MODES = 5


@dataclass
class _Assembly:
    """An Exudyn system under construction; by link: its body, its frame's node, its modes' node, its sensors."""

    mbs: Any
    utilities: Any
    bodies: list[Any] = field(default_factory=list)
    frames: list[Any] = field(default_factory=list)
    modes: list[Any] = field(default_factory=list)
    sensors: list[list[Any]] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class _Start:
    """Where a link's frame starts in space: place [m], rotation matrix, velocity [m/s], angular velocity [rad/s]."""

    place: Array
    frame: Array
    velocity: Array
    spin: Array


@dataclass(frozen=True, eq=False)
class FfrfModel:
    """A planar chain of meshed bars and rigid bodies; see ``EngineModel``."""

    names: tuple[str, ...]
    system: System
    chain: PlanarChain
    elements: int = DEFAULT_ELEMENTS
    modes: int = DEFAULT_MODES

    def _silent(self, quantity: str) -> UnsupportedError:
        return UnsupportedError(f"exudyn_ffrf gives no {quantity}: its elastic coordinates are other than ours")

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        raise self._silent("accelerations")

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        raise self._silent("generalized forces")

    def mass_matrix(self, q: Array) -> Array:
        raise self._silent("mass matrix")

    def bias(self, q: Array, qd: Array) -> Array:
        raise self._silent("bias forces")

    def gravity(self, q: Array) -> Array:
        raise self._silent("gravity forces")

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        raise self._silent("energy")

    @cached_property
    def bars(self) -> tuple[ReducedBar | None, ...]:
        """The meshed bar of each link, None where it is rigid."""
        carrying = {link.parent for link in self.chain.links}
        return tuple(
            None if link.data is None else reduced_bar(link.beam, self.elements, self.modes, carries=k in carrying)
            for k, link in enumerate(self.chain.links)
        )

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """Generalized-α with steps of at most ``step`` [s], from straight bars; elastic coordinates stand as NaN.

        tau: torques (T, n) at the joints, held between samples; zero on the elastic coordinates.
        Raises UnsupportedError for an elastic initial state or forces on elastic coordinates, EngineError where the
        solver gives up.
        """
        n = len(self.names)
        q0, qd0 = vectors(n, q0=q0, qd0=qd0)
        time = sample_times(time)
        forces = held_forces(tau, time.size, n)
        elastic = np.concatenate([link.elastic for link in self.chain.links])
        if forces is not None and np.any(forces[:, elastic]):
            raise UnsupportedError("exudyn_ffrf takes torques at joints, not forces on elastic coordinates")
        if np.any(q0[elastic]) or np.any(qd0[elastic]):
            raise UnsupportedError("exudyn_ffrf starts from straight bars only")
        if time.size == 1:
            raise UnsupportedError("exudyn_ffrf needs at least two samples of time")
        exudyn = exudyn_package()
        since = time - time[0]
        steps, every = grid(time, positive_step(step) or DEFAULT_STEP)
        with quiet(exudyn):
            built = self._build(exudyn, q0, qd0, held_torques(self.chain, since, forces))
            made = settings(exudyn, float(since[-1]), steps, every, relative=1e-8, absolute=1e-10)
            solve_dynamic(exudyn, built.mbs, made)
            return self._trajectory(built, time, since, q0)

    def frequencies(self, q: Array) -> Array:
        """Natural frequencies of the straight bars at q, without gravity [Hz]; UnsupportedError with gravity."""
        (q,) = vectors(len(self.names), q=q)
        if np.any(self.chain.gravity):
            raise UnsupportedError("exudyn_ffrf gives frequencies without gravity only")
        exudyn = exudyn_package()
        with quiet(exudyn):
            built = self._build(exudyn, q, np.zeros_like(q), {})
            made = settings(exudyn, 1.0, 1, 1.0, relative=1e-8, absolute=1e-10)
            squares, _ = exudyn.solver.ComputeODE2Eigenvalues(
                built.mbs, made, useAbsoluteValues=False, singularValuesTolerance=1e-9
            )
        squares = np.sort(np.real(np.asarray(squares)))
        result: Array = np.sqrt(squares[squares > 1e-9 * squares[-1]]) / (2.0 * np.pi)
        return result

    def _build(self, exudyn: Any, q: Array, qd: Array, torques: dict[int, Callable[[float], float]]) -> _Assembly:
        from exudyn import FEM, rigidBodyUtilities

        items = exudyn.itemInterface
        built = _Assembly(exudyn.SystemContainer().AddSystem(), rigidBodyUtilities)
        mbs = built.mbs
        ground = mbs.AddObject(items.ObjectGround())
        for k, (reduced, start) in enumerate(zip(self.bars, self._starts(rigidBodyUtilities, q, qd), strict=True)):
            if reduced is None:
                self._rigid(items, built, k, start)
            else:
                flexible = FEM.ObjectFFRFreducedOrderInterface(reduced.fem).AddObjectFFRFreducedOrder(
                    mbs,
                    positionRef=start.place,
                    initialVelocity=start.velocity,
                    rotationMatrixRef=start.frame,
                    initialAngularVelocity=start.spin,
                    stiffnessProportionalDamping=self.chain.links[k].beam.material_damping,
                )
                built.bodies.append(flexible["oFFRFreducedOrder"])
                built.frames.append(flexible["nRigidBody"])
                built.modes.append(flexible["nGenericODE2"])
                self._weigh(items, mbs, reduced, built.bodies[k])
            before, after = self._join(items, built, k, ground, start)
            self._load_joint(items, built, k, start, (before, after), torques.get(k))
            self._sense(items, exudyn.OutputVariableType, built, k)
        mbs.Assemble()
        return built

    def _starts(self, utilities: Any, q: Array, qd: Array) -> list[_Start]:
        elastic = np.concatenate([link.elastic for link in self.chain.links])
        straight, rates = q.copy(), qd.copy()
        straight[elastic] = rates[elastic] = 0.0
        found = []
        for link, now, speed in zip(self.chain.links, *poses_and_rates(self.chain, straight, rates, 2), strict=True):
            turn = float(now.turn) + (0.0 if link.data is None else _heading(link))
            found.append(
                _Start(
                    np.append(now.origin, 0.0),
                    np.asarray(utilities.RotationMatrixZ(turn)),
                    np.append(speed.origin, 0.0),
                    np.array([0.0, 0.0, float(speed.turn)]),
                )
            )
        return found

    def _rigid(self, items: Any, built: _Assembly, k: int, start: _Start) -> None:
        """A rigid link about its own origin; only what it has about z matters, and the rotor of a joint on the base."""
        link = self.chain.links[k]
        armature = link.joint.armature if link.parent < 0 else 0.0
        about = link.inertia + link.link.mass * float(link.com @ link.com) + armature
        body = built.mbs.CreateRigidBody(
            referencePosition=start.place,
            referenceRotationMatrix=start.frame,
            initialVelocity=start.velocity,
            initialAngularVelocity=start.spin,
            inertia=built.utilities.RigidBodyInertia(
                mass=link.link.mass, inertiaTensor=about * np.eye(3), com=np.append(link.com, 0.0)
            ),
            gravity=[*self.chain.gravity, 0.0],
        )
        built.bodies.append(body)
        built.frames.append(built.mbs.GetObject(body)["nodeNumber"])
        built.modes.append(None)

    def _weigh(self, items: Any, mbs: Any, reduced: ReducedBar, body: Any) -> None:
        """Gravity as the consistent nodal loads of the mesh; Exudyn's own ``gravity`` forgets that the bar is bent."""
        nodes, weights, mass = reduced.weigh()
        marker = mbs.AddMarker(
            items.MarkerSuperElementPosition(bodyNumber=body, meshNodeNumbers=nodes, weightingFactors=weights)
        )
        mbs.AddLoad(items.LoadForceVector(markerNumber=marker, loadVector=[*(mass * self.chain.gravity), 0.0]))

    def _join(self, items: Any, built: _Assembly, k: int, ground: Any, start: _Start) -> tuple[Any, Any]:
        """Put the joint between its two markers, that of the parent and that of the link's origin."""
        link, mbs = self.chain.links[k], built.mbs
        parent = None if link.parent < 0 else self.bars[link.parent]
        if parent is not None:
            tip = parent.mesh.tip
            before = mbs.AddMarker(
                items.MarkerSuperElementRigid(
                    bodyNumber=built.bodies[link.parent],
                    meshNodeNumbers=tip.tolist(),
                    weightingFactors=[1.0 / len(tip)] * len(tip),
                )
            )
        else:
            body = ground if link.parent < 0 else built.bodies[link.parent]
            before = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[*link.hinge, 0.0]))
        after = mbs.AddMarker(items.MarkerNodeRigid(nodeNumber=built.frames[k]))
        free = link.coordinate >= 0
        mbs.AddObject(
            items.GenericJoint(
                markerNumbers=[before, after],
                constrainedAxes=[1, 1, 1, 1, 1, 0 if free else 1],
                rotationMarker0=np.eye(3) if free else start.frame,
                rotationMarker1=np.eye(3),
            )
        )
        return before, after

    def _load_joint(
        self,
        items: Any,
        built: _Assembly,
        k: int,
        start: _Start,
        markers: tuple[Any, Any],
        torque: Callable[[float], float] | None,
    ) -> None:
        """Rotor, damper and torque of the joint."""
        link, mbs = self.chain.links[k], built.mbs
        if link.coordinate < 0:
            return
        if link.joint.damping:
            mbs.AddObject(
                items.ObjectConnectorTorsionalSpringDamper(
                    markerNumbers=list(markers), stiffness=0.0, damping=link.joint.damping
                )
            )
        inner = link.parent >= 0
        if not inner and link.data is not None and link.joint.armature:
            self._hub(items, built, k, start, markers[1])
        if torque is not None:
            for marker, sign in zip(markers, (-1.0, 1.0), strict=True):
                mbs.AddLoad(
                    items.LoadTorqueVector(
                        markerNumber=marker,
                        loadVectorUserFunction=lambda _mbs, t, _load, sign=sign: [0.0, 0.0, sign * torque(t)],
                    )
                )
        if inner and link.joint.armature:
            parent, side = self._side(built, link.parent, tip=True), self._side(built, k, tip=False)
            add_joint_element(items, mbs, parent, side, inertia=link.joint.armature, damping=0.0)

    def _hub(self, items: Any, built: _Assembly, k: int, start: _Start, root: Any) -> None:
        """The rotor of a bar on the base: a body fixed to the bar's root."""
        armature, mbs = self.chain.links[k].joint.armature, built.mbs
        made = mbs.CreateRigidBody(
            referencePosition=start.place,
            referenceRotationMatrix=start.frame,
            initialAngularVelocity=start.spin,
            # The hub stands still, so that its mass, which must not be zero, does nothing.
            inertia=built.utilities.RigidBodyInertia(mass=armature, inertiaTensor=armature * np.eye(3)),
        )
        marker = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=made))
        mbs.AddObject(items.GenericJoint(markerNumbers=[root, marker], constrainedAxes=[1] * 6))

    def _side(self, built: _Assembly, k: int, *, tip: bool) -> FrameSide:
        parameters = np.asarray(built.mbs.GetNodeParameter(built.frames[k], "referenceCoordinates"))[3:7]
        reduced = self.bars[k]
        modes = None if reduced is None or not tip else (built.modes[k], reduced.tip_turn)
        return FrameSide(built.frames[k], parameters, modes)

    def _sense(self, items: Any, kind: Any, built: _Assembly, k: int) -> None:
        wanted = [(built.frames[k], kind.Rotation), (built.frames[k], kind.AngularVelocity)]
        if built.modes[k] is not None:
            wanted += [(built.modes[k], kind.Coordinates), (built.modes[k], kind.Coordinates_t)]
        built.sensors.append(
            [
                built.mbs.AddSensor(
                    items.SensorNode(nodeNumber=node, storeInternal=True, writeToFile=False, outputVariableType=what)
                )
                for node, what in wanted
            ]
        )

    def _trajectory(self, built: _Assembly, time: Array, since: Array, q0: Array) -> Trajectory:
        n = len(self.names)
        position, velocity = np.full((len(time), n), np.nan), np.full((len(time), n), np.nan)
        channels: dict[str, Array] = {}
        ends: list[tuple[Array, Array]] = []
        for link, reduced, sensors in zip(self.chain.links, self.bars, built.sensors, strict=True):
            data = [stored(built.mbs, sensor, since) for sensor in sensors]
            turn, rate = np.unwrap(data[0][:, 2]), data[1][:, 2]
            if reduced is not None:
                turn = turn - _heading(link)
                side = np.sign(link.direction[0] * link.bending[1] - link.direction[1] * link.bending[0])
                channels[f"{link.link.name}.tip_deflection"] = side * data[2] @ reduced.tip_shift
            if link.coordinate >= 0:
                before = ends[link.parent] if link.parent >= 0 else (np.zeros(len(time)), np.zeros(len(time)))
                angle = link.sign * (turn - before[0])
                # Whole turns are not to be seen in a rotation; the run starts where it was told to.
                angle += 2.0 * np.pi * np.round((q0[link.coordinate] - angle[0]) / (2.0 * np.pi))
                position[:, link.coordinate] = angle
                velocity[:, link.coordinate] = link.sign * (rate - before[1])
                channels[f"{link.joint.name}.position"] = angle
            if reduced is not None:
                turn, rate = turn + data[2] @ reduced.tip_turn, rate + data[3] @ reduced.tip_turn
            ends.append((turn, rate))
        return Trajectory(time=time, names=self.names, position=position, velocity=velocity, channels=channels)


@dataclass(frozen=True)
class Ffrf:
    """Exudyn's floating frames with meshed bars as an ``Engine``: planar chains without geometric stiffening."""

    name: str = "exudyn_ffrf"
    elements: int = DEFAULT_ELEMENTS
    modes: int = DEFAULT_MODES

    def version(self) -> str:
        return installed_version("exudyn", "Exudyn")

    def refuses(self, system: System) -> str | None:
        if not system.flexible:
            return "the system has no elastic link"
        if system.loops:
            return "exudyn_ffrf has no loops"
        if not system.simple:
            return "exudyn_ffrf has joints of one independent degree of freedom each alone"
        if system.attachments:
            return f"exudyn_ffrf cannot express the effect {system.attachments[0].effect}"
        reason = why_not_planar(system)
        if reason:
            return reason
        for link in planar_chain(system).links:
            reason = _refuses_joint(system, link) or (_refuses_bar(link) if link.data is not None else None)
            if reason:
                return reason
        return None

    def build(self, system: System) -> FfrfModel:
        """The system in meshed solids; raises UnsupportedError with the reason if it is refused."""
        reason = self.refuses(system)
        if reason:
            raise UnsupportedError(reason, source=system.source)
        exudyn_package()
        return FfrfModel(system.coordinate_names, system, planar_chain(system), self.elements, self.modes)


def _heading(link: PlanarLink) -> float:
    """Turn of a bar's direction from the plane's x axis in the zero pose [rad]."""
    return float(np.arctan2(link.direction[1], link.direction[0]))


def _refuses_joint(system: System, link: PlanarLink) -> str | None:
    joint = link.joint
    if joint.friction or joint.stiffness:
        return f"exudyn_ffrf models neither dry friction nor a spring at joint {joint.name!r}"
    parent = system.links[link.parent] if link.parent >= 0 else None
    if parent is not None and parent.beam is not None:
        off = joint.xyz - parent.beam.length * parent.beam.direction
        if float(np.linalg.norm(off)) > 1e-9 * parent.beam.length:
            return f"joint {joint.name!r} does not sit at the tip of {parent.name!r}"
    return None


def _refuses_bar(link: PlanarLink) -> str | None:
    beam, name = link.beam, link.link.name
    if beam.geometric_stiffening:
        return f"a floating frame does not stiffen by rotation, link {name!r} is meant to"
    if not (np.isfinite(beam.width) and np.isfinite(beam.thickness)):
        return f"a solid mesh needs width and thickness of link {name!r}"
    if any(beam.modal_damping):
        return f"finite elements have no modal damping ratios (link {name!r})"
    if np.any(beam.payload_inertia):
        return f"exudyn_ffrf carries a point mass at the tip, link {name!r} a body with inertia"
    return None
