"""Exudyn's ANCF cable elements: geometrically exact planar beams, the reference for links with geometric stiffening.

Gerstmayr and Irschik, On the correct representation of bending and axial deformation in the absolute nodal coordinate
formulation, J. Sound Vib. 318 (2008) 461-487; Gerstmayr, Exudyn, Multibody Syst. Dyn. 60 (2024).

The finite elements have other elastic coordinates than ours, so this engine speaks through ``simulate`` (joint
positions, ``<link>.tip_deflection``) and ``frequencies``. Deflections are measured normal to the tangent at the root,
which is what the assumed modes mean by u(l).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from harness.engines.checked import installed_version, raise_if_refused, vectors
from harness.engines.exudyn_joint import PlanarBodySide, Side, SlopeSide, add_joint_element
from harness.engines.exudyn_planar import LinkMotion, PlanarBeamModel, bending_side, refuses_planar_beams
from harness.engines.exudyn_run import (
    exudyn_package,
    item,
    node_sensors,
    quiet,
    settings,
    solve_static,
    squared_frequencies,
    stored,
)
from harness.engines.planar import PlanarLink, planar_chain, poses_and_rates
from harness.engines.protocol import Array, EngineError
from harness.errors import UnsupportedError
from harness.system import System

#: Sixteen elements at this step [s] are within about 0.1 % of the peak tip deflection over 2 s of free fall.
DEFAULT_STEP = 2e-5
DEFAULT_ELEMENTS = 16
# Where a beam's section is not told, its axial stiffness is that of a beam this many times longer than its radius of
# gyration: stiff enough to count as inextensible, soft enough for the solver.
_SLENDERNESS = 1000.0
# How far the static equilibrium may lie from the state asked about [rad].
_SAME_STATE = 1e-3


@dataclass
class _Assembly:
    """An Exudyn system under construction; nodes: by link, first and last; sensors: by link, positions and rates."""

    mbs: Any
    nodes: list[list[Any]] = field(default_factory=list)
    reference: list[Array] = field(default_factory=list)
    sensors: list[list[Any]] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class AncfModel(PlanarBeamModel):
    """A planar chain in ANCF cable elements and planar rigid bodies; see ``EngineModel``.

    A run starts with the beams in the shape that the assumed modes have in the state it is given.
    """

    elements: int = DEFAULT_ELEMENTS

    engine: ClassVar[str] = "exudyn_ancf"
    default_step: ClassVar[float] = DEFAULT_STEP

    def _check_start(self, q0: Array, qd0: Array) -> None:
        """Every state is expressed."""

    def frequencies(self, q: Array) -> Array:
        """Natural frequencies about the equilibrium at q [Hz]; gravity's tension in the beams counts.

        Raises UnsupportedError if q is no equilibrium, or if rigid links hang in gravity (Exudyn linearises without
        the constraints' own stiffness).
        """
        (q,) = vectors(len(self.names), q=q)
        exudyn = exudyn_package()
        heavy = bool(np.any(self.chain.gravity))
        if heavy and any(link.data is None for link in self.chain.links):
            raise UnsupportedError("exudyn_ancf gives no frequencies of rigid links in gravity")
        with quiet(exudyn):
            built = self._build(exudyn, q, np.zeros_like(q), {})
            relative, absolute = self._tolerances()
            made = settings(exudyn, 1.0, 1, 1.0, relative=relative, absolute=absolute)
            if heavy:
                self._settle(built, made, q)
            squares = squared_frequencies(exudyn, built.mbs, made)
        # The stiffest axial mode sets the rounding of the swing, which without gravity is exactly neutral.
        floor = 1e-13 * float(squares[-1])
        result: Array = np.sqrt(squares[squares > max(floor, 1e-6)]) / (2.0 * np.pi)
        return result

    def _settle(self, built: _Assembly, made: Any, q: Array) -> None:
        made.staticSolver.numberOfLoadSteps = 1
        try:
            solve_static(built.mbs, made)
        except EngineError:
            raise UnsupportedError("exudyn_ancf gives frequencies about an equilibrium only") from None
        state = built.mbs.systemData.GetODE2Coordinates()
        turns = []
        place = 0
        for link, reference in zip(self.chain.links, built.reference, strict=True):
            here = reference[0] + state[place : place + 4]
            turns.append(_angle(here[2], here[3]) - _angle(*link.direction))
            place += 4 * len(reference)
        for link, turn in zip(self.chain.links, turns, strict=True):
            if link.coordinate < 0:
                continue
            before = turns[link.parent] if link.parent >= 0 else 0.0
            off = link.sign * (turn - before) - q[link.coordinate]
            if abs((off + np.pi) % (2.0 * np.pi) - np.pi) > _SAME_STATE:
                raise UnsupportedError("exudyn_ancf gives frequencies about an equilibrium only")

    def _tolerances(self) -> tuple[float, float]:
        """Relative and absolute tolerance of Newton's residual [N]: what the rounding of the axial force leaves room for."""
        axial = max(_axial_stiffness(link) for link in self.chain.links if link.data is not None)
        return (1e-6 if self.elements <= 16 else 1e-5), max(1e-8, 2e-15 * axial)

    def _build(self, exudyn: Any, q: Array, qd: Array, torques: dict[int, Callable[[float], float]]) -> _Assembly:
        items = exudyn.itemInterface
        built = _Assembly(exudyn.SystemContainer().AddSystem())
        mbs = built.mbs
        ground_node = mbs.AddNode(items.NodePointGround())
        zero, _ = poses_and_rates(self.chain, np.zeros_like(q), np.zeros_like(q), self.elements + 1)
        now, rates = poses_and_rates(self.chain, q, qd, self.elements + 1)
        bodies: list[Any] = []
        for k, link in enumerate(self.chain.links):
            if link.data is None:
                start = np.append(zero[k].origin, 0.0)
                shift = np.append(now[k].origin - zero[k].origin, now[k].turn)
                speed = np.append(rates[k].origin, rates[k].turn)
                # The body's reference point is the link's origin, so that joints count from there.
                node = mbs.AddNode(
                    items.NodeRigidBody2D(
                        referenceCoordinates=start.tolist(),
                        initialCoordinates=shift.tolist(),
                        initialVelocities=speed.tolist(),
                    )
                )
                bodies.append(self._rigid(items, mbs, link, node))
                built.nodes.append([node])
                built.reference.append(start[None, :])
            else:
                reference = np.column_stack([zero[k].points, zero[k].slopes])
                state = np.column_stack([now[k].points, now[k].slopes])
                speed = np.column_stack([rates[k].points, rates[k].slopes])
                nodes = [
                    mbs.AddNode(
                        items.NodePoint2DSlope1(
                            referenceCoordinates=reference[i].tolist(),
                            initialCoordinates=(state[i] - reference[i]).tolist(),
                            initialVelocities=speed[i].tolist(),
                        )
                    )
                    for i in range(self.elements + 1)
                ]
                self._beam(items, mbs, link, nodes)
                bodies.append(None)
                built.nodes.append(nodes)
                built.reference.append(reference)
            self._join(items, mbs, k, built, bodies, ground_node)
            self._drive(items, mbs, k, built, torques.get(k))
            ends = [built.nodes[k][0]] if link.data is None else [built.nodes[k][0], built.nodes[k][-1]]
            kinds = (exudyn.OutputVariableType.Coordinates, exudyn.OutputVariableType.Coordinates_t)
            built.sensors.append(node_sensors(items, mbs, [(node, kind) for node in ends for kind in kinds]))
        mbs.Assemble()
        return built

    def _rigid(self, items: Any, mbs: Any, link: PlanarLink, node: Any) -> Any:
        armature = link.joint.armature if link.parent < 0 else 0.0
        body = mbs.AddObject(
            item(
                items.ObjectRigidBody2D,
                mass=link.link.mass,
                inertia=link.inertia + link.link.mass * float(link.com @ link.com) + armature,
                centerOfMass=link.com.tolist(),
                nodeNumber=node,
            )
        )
        mass = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        mbs.AddLoad(items.LoadMassProportional(markerNumber=mass, loadVector=[*self.chain.gravity, 0.0]))
        return body

    def _beam(self, items: Any, mbs: Any, link: PlanarLink, nodes: list[Any]) -> None:
        beam = link.beam
        axial = _axial_stiffness(link)
        for first, second in pairwise(nodes):
            cable = mbs.AddObject(
                item(
                    items.ObjectANCFCable2D,
                    length=beam.length / self.elements,
                    massPerLength=beam.mass / beam.length,
                    bendingStiffness=beam.bending_stiffness,
                    axialStiffness=axial,
                    bendingDamping=beam.material_damping * beam.bending_stiffness,
                    axialDamping=beam.material_damping * axial,
                    nodeNumbers=[first, second],
                )
            )
            mass = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=cable))
            mbs.AddLoad(items.LoadMassProportional(markerNumber=mass, loadVector=[*self.chain.gravity, 0.0]))
        normal = np.cross(beam.direction, beam.bending)
        turning = float(normal @ beam.payload_inertia @ normal)
        if beam.payload or turning:
            mbs.AddObject(
                items.ObjectGenericODE2(
                    nodeNumbers=[nodes[-1]], massMatrix=np.diag([beam.payload, beam.payload, turning, turning])
                )
            )
            marker = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[-1]))
            load = [*(beam.payload * self.chain.gravity), 0.0]
            mbs.AddLoad(items.LoadForceVector(markerNumber=marker, loadVector=load))
        if link.parent < 0 and link.coordinate >= 0 and (link.joint.armature or link.joint.damping):
            # On the slope of a beam that does not stretch, a mass is a rotary inertia and a damper a rotary damper.
            hub, loss = link.joint.armature, link.joint.damping
            mbs.AddObject(
                items.ObjectGenericODE2(
                    nodeNumbers=[nodes[0]],
                    massMatrix=np.diag([0.0, 0.0, hub, hub]),
                    dampingMatrix=np.diag([0.0, 0.0, loss, loss]),
                )
            )

    def _join(self, items: Any, mbs: Any, k: int, built: _Assembly, bodies: list[Any], ground_node: Any) -> None:
        link = self.chain.links[k]
        root = built.nodes[k][0]
        if link.parent < 0:
            fixed = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground_node, coordinate=0))
            # A clamp holds the slope's direction, not its length: the beam may stretch up to its root. The plane's
            # x axis lies along the first beam.
            for coordinate in (0, 1) if link.coordinate >= 0 else (0, 1, 3):
                held = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=root, coordinate=coordinate))
                # The initial displacement of the base joint is zero, so holding it at zero holds the place.
                mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[fixed, held]))
            if link.joint.damping and link.data is None:
                turn = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=root, coordinate=2))
                mbs.AddObject(
                    items.ObjectConnectorCoordinateSpringDamper(
                        markerNumbers=[fixed, turn], stiffness=0.0, damping=link.joint.damping
                    )
                )
            return
        parent = self.chain.links[link.parent]
        if parent.data is None:
            before = mbs.AddMarker(
                items.MarkerBodyPosition(bodyNumber=bodies[link.parent], localPosition=[*link.hinge, 0.0])
            )
        else:
            before = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=built.nodes[link.parent][-1]))
        after = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=root))
        mbs.AddObject(items.ObjectJointRevolute2D(markerNumbers=[before, after]))

    def _drive(self, items: Any, mbs: Any, k: int, built: _Assembly, torque: Callable[[float], float] | None) -> None:
        """What acts on the joint's own turn and is not told in constant matrices: see ``exudyn_joint``."""
        link = self.chain.links[k]
        inner = link.parent >= 0
        inertia = link.joint.armature if inner else 0.0
        damping = link.joint.damping if inner else 0.0
        if link.coordinate < 0 or not (inertia or damping or torque):
            return

        def side(index: int, place: int) -> Side:
            node = built.nodes[index][place]
            rigid = self.chain.links[index].data is None
            return PlanarBodySide(node) if rigid else SlopeSide(node, built.reference[index][place, 2:])

        parent = side(link.parent, -1) if inner else None
        add_joint_element(items, mbs, parent, side(k, 0), inertia=inertia, damping=damping, torque=torque)

    def _motion(self, built: _Assembly, k: int, since: Array) -> LinkMotion:
        link, reference = self.chain.links[k], built.reference[k]
        data = [stored(built.mbs, sensor, since) for sensor in built.sensors[k]]
        if link.data is None:
            turn, rate = data[0][:, 2], data[1][:, 2]
            return LinkMotion(turn, rate, turn, rate)
        root, tip = data[0] + reference[0], data[2] + reference[-1]
        start = _angle(*link.direction)
        tangent = root[:, 2:] / np.linalg.norm(root[:, 2:], axis=1)[:, None]
        chord = tip[:, :2] - root[:, :2]
        return LinkMotion(
            np.unwrap(_angle(root[:, 2], root[:, 3]) - start),
            _rate(root, data[1]),
            np.unwrap(_angle(tip[:, 2], tip[:, 3]) - start),
            _rate(tip, data[3]),
            bending_side(link) * (tangent[:, 0] * chord[:, 1] - tangent[:, 1] * chord[:, 0]),
        )


def _angle(x: Any, y: Any) -> Any:
    return np.arctan2(y, x)


def _rate(slope: Array, speed: Array) -> Array:
    """Rate of turn of a slope vector [rad/s]: columns 2, 3 of node coordinates and their rates."""
    square = slope[:, 2] ** 2 + slope[:, 3] ** 2
    rate: Array = (slope[:, 2] * speed[:, 3] - slope[:, 3] * speed[:, 2]) / square
    return rate


def _axial_stiffness(link: PlanarLink) -> float:
    beam = link.beam
    area = beam.width * beam.thickness
    if np.isfinite(area) and np.isfinite(beam.youngs_modulus):
        return float(beam.youngs_modulus * area)
    return beam.bending_stiffness * (_SLENDERNESS / beam.length) ** 2


@dataclass(frozen=True)
class Ancf:
    """Exudyn's ANCF cables as an ``Engine``: planar chains of beams and rigid links on revolute joints.

    elements: finite elements on each beam.
    """

    name: str = "exudyn_ancf"
    elements: int = DEFAULT_ELEMENTS

    def version(self) -> str:
        return installed_version("exudyn", "Exudyn")

    def refuses(self, system: System) -> str | None:
        return refuses_planar_beams(self.name, system, _refuses_beam)

    def build(self, system: System) -> AncfModel:
        """The system in ANCF elements; raises UnsupportedError with the reason if it is refused."""
        raise_if_refused(system, self.refuses(system))
        exudyn_package()
        return AncfModel(system.coordinate_names, system, planar_chain(system), self.elements)


def _refuses_beam(link: PlanarLink) -> str | None:
    beam = link.beam
    if not beam.geometric_stiffening:
        return f"ANCF beams stiffen by rotation, link {link.link.name!r} is meant not to"
    if any(beam.modal_damping):
        return f"finite elements have no modal damping ratios (link {link.link.name!r})"
    return None
