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
from typing import Any, ClassVar

import numpy as np

from harness.engines.checked import installed_version, raise_if_refused, vectors
from harness.engines.exudyn_joint import FrameSide, add_joint_element
from harness.engines.exudyn_planar import LinkMotion, PlanarBeamModel, bending_side, refuses_planar_beams
from harness.engines.exudyn_run import exudyn_package, node_sensors, quiet, settings, squared_frequencies, stored
from harness.engines.planar import PlanarLink, planar_chain, poses_and_rates
from harness.engines.protocol import Array
from harness.engines.reduced_bar import ReducedBar, reduced_bar
from harness.errors import UnsupportedError
from harness.system import System

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
class FfrfModel(PlanarBeamModel):
    """A planar chain of meshed bars and rigid bodies, which starts from straight bars alone; see ``EngineModel``."""

    elements: int = DEFAULT_ELEMENTS
    modes: int = DEFAULT_MODES

    engine: ClassVar[str] = "exudyn_ffrf"
    default_step: ClassVar[float] = DEFAULT_STEP

    @cached_property
    def bars(self) -> tuple[ReducedBar | None, ...]:
        """The meshed bar of each link, None where it is rigid."""
        carrying = {link.parent for link in self.chain.links}
        return tuple(
            None if link.data is None else reduced_bar(link.beam, self.elements, self.modes, carries=k in carrying)
            for k, link in enumerate(self.chain.links)
        )

    def _check_start(self, q0: Array, qd0: Array) -> None:
        if np.any(q0[self._elastic]) or np.any(qd0[self._elastic]):
            raise UnsupportedError("exudyn_ffrf starts from straight bars only")

    def _tolerances(self) -> tuple[float, float]:
        return 1e-8, 1e-10

    def frequencies(self, q: Array) -> Array:
        """Natural frequencies of the straight bars at q, without gravity [Hz]; UnsupportedError with gravity."""
        (q,) = vectors(len(self.names), q=q)
        if np.any(self.chain.gravity):
            raise UnsupportedError("exudyn_ffrf gives frequencies without gravity only")
        exudyn = exudyn_package()
        with quiet(exudyn):
            built = self._build(exudyn, q, np.zeros_like(q), {})
            relative, absolute = self._tolerances()
            made = settings(exudyn, 1.0, 1, 1.0, relative=relative, absolute=absolute)
            squares = squared_frequencies(exudyn, built.mbs, made)
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
                body = FEM.ObjectFFRFreducedOrderInterface(reduced.fem)
                # Rounding of the mesh's stiffness couples soft modes to hard ones by some 1e-3 N/m, otherwise above the
                # diagonal than below it: an eigenvalue solver that reads one half tells frequencies off by 2e-4.
                body.stiffnessMatrixReduced = 0.5 * (body.stiffnessMatrixReduced + body.stiffnessMatrixReduced.T)
                flexible = body.AddObjectFFRFreducedOrder(
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
        straight, rates = q.copy(), qd.copy()
        straight[self._elastic] = rates[self._elastic] = 0.0
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
        built.sensors.append(node_sensors(items, built.mbs, wanted))

    def _motion(self, built: _Assembly, k: int, since: Array) -> LinkMotion:
        link, reduced = self.chain.links[k], self.bars[k]
        data = [stored(built.mbs, sensor, since) for sensor in built.sensors[k]]
        turn, rate = np.unwrap(data[0][:, 2]), data[1][:, 2]
        if reduced is None:
            return LinkMotion(turn, rate, turn, rate)
        turn = turn - _heading(link)
        end_turn, end_rate = turn + data[2] @ reduced.tip_turn, rate + data[3] @ reduced.tip_turn
        return LinkMotion(turn, rate, end_turn, end_rate, bending_side(link) * data[2] @ reduced.tip_shift)


@dataclass(frozen=True)
class Ffrf:
    """Exudyn's floating frames with meshed bars as an ``Engine``: planar chains without geometric stiffening."""

    name: str = "exudyn_ffrf"
    elements: int = DEFAULT_ELEMENTS
    modes: int = DEFAULT_MODES

    def version(self) -> str:
        return installed_version("exudyn", "Exudyn")

    def refuses(self, system: System) -> str | None:
        return refuses_planar_beams(self.name, system, _refuses_bar)

    def build(self, system: System) -> FfrfModel:
        """The system in meshed solids; raises UnsupportedError with the reason if it is refused."""
        raise_if_refused(system, self.refuses(system))
        exudyn_package()
        return FfrfModel(system.coordinate_names, system, planar_chain(system), self.elements, self.modes)


def _heading(link: PlanarLink) -> float:
    """Turn of a bar's direction from the plane's x axis in the zero pose [rad]."""
    return float(np.arctan2(link.direction[1], link.direction[0]))


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
