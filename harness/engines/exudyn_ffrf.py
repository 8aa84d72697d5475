"""Exudyn's floating frame of reference: a meshed solid bar in Hurty-Craig-Bampton modes, not stiffened by rotation.

A. Zwölfer and J. Gerstmayr, The nodal-based floating frame of reference formulation with modal reduction, Acta
Mechanica 232 (2021) 835-851. The deflection is linear in the frame at the root, so a turning bar keeps its length along
the tangent and is softened by rotation: the reference for links whose ``geometric_stiffening`` is off.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from harness.engines.checked import held_forces, installed_version, positive_step, sample_times, vectors
from harness.engines.exudyn_run import exudyn_package, grid, quiet, settings, solve_dynamic, stored
from harness.engines.planar import PlanarLink, planar_chain, why_not_planar
from harness.engines.protocol import Array
from harness.engines.solid_mesh import Bar, bar
from harness.errors import UnsupportedError
from harness.system import System, Trajectory

DEFAULT_STEP = 1e-4
#: Bricks along the bar; a thin brick is too stiff in shear, and this many leave the first frequency 0.005 % high.
DEFAULT_ELEMENTS = 96
#: Bending modes kept of the meshed bar, held at its root.
DEFAULT_MODES = 5


@dataclass(frozen=True, eq=False)
class FfrfModel:
    """One bar on a base joint; see ``EngineModel``. x runs along the bar, z along the normal of its plane of motion."""

    names: tuple[str, ...]
    system: System
    link: PlanarLink
    gravity_in_plane: Array
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
    def mesh(self) -> Bar:
        """The meshed bar with its payload spread over the tip's face."""
        beam = self.link.beam
        depth, width = beam.thickness, beam.width
        meshed = bar(
            beam.length,
            depth,
            width,
            beam.mass / (beam.length * depth * width),
            beam.bending_stiffness * 12.0 / (width * depth**3),
            self.elements,
        )
        if not beam.payload:
            return meshed
        spread = np.zeros(len(meshed.nodes))
        spread[meshed.tip] = 1.0 / len(meshed.tip)
        extra = csr_matrix(np.kron(beam.payload * np.outer(spread, spread), np.eye(3)))
        return Bar(meshed.nodes, (meshed.mass + extra).tocsr(), meshed.stiffness, meshed.root, meshed.tip)

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """Generalized-α with steps of at most ``step`` [s], from the straight bar; elastic coordinates stand as NaN.

        Raises UnsupportedError for applied forces or an elastic initial state, EngineError where the solver gives up.
        """
        n = len(self.names)
        q0, qd0 = vectors(n, q0=q0, qd0=qd0)
        time = sample_times(time)
        forces = held_forces(tau, time.size, n)
        if forces is not None and np.any(forces):
            raise UnsupportedError("exudyn_ffrf takes no applied joint torques")
        if np.any(q0[self.link.elastic]) or np.any(qd0[self.link.elastic]):
            raise UnsupportedError("exudyn_ffrf starts from the straight bar only")
        if time.size == 1:
            raise UnsupportedError("exudyn_ffrf needs at least two samples of time")
        exudyn = exudyn_package()
        since = time - time[0]
        steps, every = grid(time, positive_step(step) or DEFAULT_STEP)
        with quiet(exudyn):
            turn, rate = 0.0, 0.0
            if self.link.coordinate >= 0:
                turn = self.link.sign * float(q0[self.link.coordinate])
                rate = self.link.sign * float(qd0[self.link.coordinate])
            mbs, tip, sensors = self._build(exudyn, turn, rate)
            made = settings(exudyn, float(since[-1]), steps, every, relative=1e-8, absolute=1e-10)
            solve_dynamic(exudyn, mbs, made)
            flexible, rotation, spin = (stored(mbs, sensor, since) for sensor in sensors)
        position, velocity = np.full((len(time), n), np.nan), np.full((len(time), n), np.nan)
        side = np.sign(self.link.direction[0] * self.link.bending[1] - self.link.direction[1] * self.link.bending[0])
        channels = {f"{self.link.link.name}.tip_deflection": side * flexible @ tip}
        if self.link.coordinate >= 0:
            angle = np.unwrap(rotation[:, 2])
            angle = self.link.sign * (angle - angle[0]) + q0[self.link.coordinate]
            position[:, self.link.coordinate] = angle
            velocity[:, self.link.coordinate] = self.link.sign * spin[:, 2]
            channels[f"{self.link.joint.name}.position"] = angle
        return Trajectory(time=time, names=self.names, position=position, velocity=velocity, channels=channels)

    def frequencies(self, q: Array) -> Array:
        """Natural frequencies of the bar on its joint without gravity [Hz]; UnsupportedError with gravity."""
        vectors(len(self.names), q=q)
        if np.any(self.gravity_in_plane):
            raise UnsupportedError("exudyn_ffrf gives frequencies without gravity only")
        exudyn = exudyn_package()
        with quiet(exudyn):
            mbs, _, _ = self._build(exudyn, 0.0, 0.0)
            made = settings(exudyn, 1.0, 1, 1.0, relative=1e-8, absolute=1e-10)
            squares, _ = exudyn.solver.ComputeODE2Eigenvalues(
                mbs, made, useAbsoluteValues=False, singularValuesTolerance=1e-9
            )
        squares = np.sort(np.real(np.asarray(squares)))
        result: Array = np.sqrt(squares[squares > 1e-9 * squares[-1]]) / (2.0 * np.pi)
        return result

    def _build(self, exudyn: Any, turn: float, rate: float) -> tuple[Any, Array, list[Any]]:
        """The assembled system, the tip's deflection in each mode, sensors of modes, rotation and angular velocity."""
        from exudyn import FEM, rigidBodyUtilities

        items = exudyn.itemInterface
        mbs = exudyn.SystemContainer().AddSystem()
        fem = self._reduced(FEM)
        basis = fem.modeBasis["matrix"]
        start = float(np.arctan2(self.link.direction[1], self.link.direction[0])) + turn
        frame = np.asarray(rigidBodyUtilities.RotationMatrixZ(start))
        cms = FEM.ObjectFFRFreducedOrderInterface(fem)
        flexible = cms.AddObjectFFRFreducedOrder(
            mbs,
            positionRef=[0.0, 0.0, 0.0],
            rotationMatrixRef=frame,
            initialAngularVelocity=[0.0, 0.0, rate],
            stiffnessProportionalDamping=self.link.beam.material_damping,
        )
        self._weigh(items, mbs, flexible["oFFRFreducedOrder"], basis)
        ground = mbs.AddObject(items.ObjectGround())
        origin = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=ground))
        root = mbs.AddMarker(items.MarkerNodeRigid(nodeNumber=flexible["nRigidBody"]))
        free = self.link.coordinate >= 0
        mbs.AddObject(
            items.GenericJoint(
                markerNumbers=[origin, root],
                constrainedAxes=[1, 1, 1, 1, 1, 0 if free else 1],
                rotationMarker0=frame if not free else np.eye(3),
                rotationMarker1=np.eye(3),
            )
        )
        if free and self.link.joint.armature:
            self._hub(items, mbs, rigidBodyUtilities, frame, rate, root)
        if free and self.link.joint.damping:
            mbs.AddObject(
                items.ObjectConnectorTorsionalSpringDamper(
                    markerNumbers=[origin, root], stiffness=0.0, damping=self.link.joint.damping
                )
            )
        kind = exudyn.OutputVariableType
        sensors = [
            mbs.AddSensor(
                items.SensorNode(nodeNumber=node, storeInternal=True, writeToFile=False, outputVariableType=what)
            )
            for node, what in (
                (flexible["nGenericODE2"], kind.Coordinates),
                (flexible["nRigidBody"], kind.Rotation),
                (flexible["nRigidBody"], kind.AngularVelocity),
            )
        ]
        mbs.Assemble()
        return mbs, basis[3 * self.mesh.tip + 1].mean(axis=0), sensors

    def _reduced(self, FEM: Any) -> Any:
        """Exudyn's mesh with the lowest modes in the plane, the root's face held rigidly."""
        fem = FEM.FEMinterface()
        fem.nodes = {"Position": self.mesh.nodes}
        fem.massMatrix, fem.stiffnessMatrix = self.mesh.mass, self.mesh.stiffness
        fem.elements = []
        # Half of the modes bend the other way or twist; they are not excited in the plane, and left out.
        fem.ComputeHurtyCraigBamptonModes(
            boundaryNodesList=[self.mesh.root],
            nEigenModes=4 * self.modes,
            useSparseSolver=True,
            computationMode=FEM.HCBstaticModeSelection.RBE2,
        )
        basis = np.asarray(fem.modeBasis["matrix"])
        tip = 3 * self.mesh.tip
        across = np.abs(basis[tip + 1].mean(axis=0))
        beside = np.maximum(np.abs(basis[tip + 2]).max(axis=0), np.ptp(basis[tip + 1], axis=0))
        plane = np.flatnonzero(across > 10.0 * beside)[: self.modes]
        fem.modeBasis["matrix"] = basis[:, plane]
        return fem

    def _weigh(self, items: Any, mbs: Any, body: Any, basis: Array) -> None:
        """Gravity as the consistent nodal loads of the mesh; Exudyn's own ``gravity`` forgets that the bar is bent.

        A dead load acts through the mean of the loaded points, weighted. A few nodes whose weighted mean of place and
        of every mode is that of all nodes give the same generalized forces at a fraction of the time.
        """
        share = np.asarray(self.mesh.mass.sum(axis=1)).reshape(-1, 3)[:, 0]
        total = float(share.sum())
        functions = np.column_stack([np.ones(len(share)), self.mesh.nodes, *(basis[axis::3] for axis in range(3))])
        sections = np.unique(np.round(self.mesh.nodes[:, 0], 12))
        few = sections[np.linspace(0, len(sections) - 1, 2 * self.modes + 6).round().astype(int)]
        chosen = np.flatnonzero(np.isin(np.round(self.mesh.nodes[:, 0], 12), few))
        scale = np.max(np.abs(functions), axis=0)
        scale[scale == 0.0] = 1.0
        mean = share @ functions / total / scale
        weights, *_ = np.linalg.lstsq((functions[chosen] / scale).T, mean, rcond=1e-12)
        if np.max(np.abs((functions[chosen] / scale).T @ weights - mean)) > 1e-9:
            chosen, weights = np.arange(len(share)), share / total
        marker = mbs.AddMarker(
            items.MarkerSuperElementPosition(
                bodyNumber=body, meshNodeNumbers=chosen.tolist(), weightingFactors=weights.tolist()
            )
        )
        mbs.AddLoad(items.LoadForceVector(markerNumber=marker, loadVector=[*(total * self.gravity_in_plane), 0.0]))

    def _hub(self, items: Any, mbs: Any, utilities: Any, frame: Array, rate: float, root: Any) -> None:
        armature = self.link.joint.armature
        body = mbs.CreateRigidBody(
            referencePosition=[0.0, 0.0, 0.0],
            referenceRotationMatrix=frame,
            initialAngularVelocity=[0.0, 0.0, rate],
            # The hub stands still, so that its mass, which must not be zero, does nothing.
            inertia=utilities.RigidBodyInertia(mass=armature, inertiaTensor=armature * np.eye(3)),
        )
        marker = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body))
        mbs.AddObject(items.GenericJoint(markerNumbers=[root, marker], constrainedAxes=[1] * 6))


@dataclass(frozen=True)
class Ffrf:
    """Exudyn's floating frame with a meshed bar as an ``Engine``: one beam on the base, without geometric stiffening."""

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
        if len(system.links) > 1:
            return "exudyn_ffrf is set up for a single beam on the base"
        reason = why_not_planar(system)
        if reason:
            return reason
        (joint,), (link,) = system.joints, system.links
        beam = link.beam
        assert beam is not None
        if beam.geometric_stiffening:
            return f"a floating frame does not stiffen by rotation, link {link.name!r} is meant to"
        if joint.friction or joint.stiffness:
            return f"exudyn_ffrf models neither dry friction nor a spring at joint {joint.name!r}"
        if not (np.isfinite(beam.width) and np.isfinite(beam.thickness)):
            return f"a solid mesh needs width and thickness of link {link.name!r}"
        if any(beam.modal_damping):
            return f"finite elements have no modal damping ratios (link {link.name!r})"
        if np.any(beam.payload_inertia):
            return f"exudyn_ffrf carries a point mass at the tip, link {link.name!r} a body with inertia"
        return None

    def build(self, system: System) -> FfrfModel:
        """The system as a meshed solid; raises UnsupportedError with the reason if it is refused."""
        reason = self.refuses(system)
        if reason:
            raise UnsupportedError(reason, source=system.source)
        exudyn_package()
        chain = planar_chain(system)
        return FfrfModel(system.coordinate_names, system, chain.links[0], chain.gravity, self.elements, self.modes)
