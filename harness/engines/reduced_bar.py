"""A beam meshed in bricks and reduced to a few bending modes in its plane of motion, for a floating frame at its root."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix, diags

from harness.engines.protocol import Array
from harness.engines.solid_mesh import Bar, bar
from harness.system import Beam


@dataclass(frozen=True, eq=False)
class ReducedBar:
    """A meshed bar in m modes, its root's face held; x runs along the bar, z along the normal of its plane of motion.

    mesh: with the payload spread over the tip's face. fem: Exudyn's ``FEMinterface`` with the modes.
    basis: displacements of the nodes, (3N, m). tip_shift: of the tip's centre along y [m], tip_turn: of the tip's face
    about z [rad], by modal coordinate, (m,).
    """

    mesh: Bar
    fem: Any
    basis: Array
    tip_shift: Array
    tip_turn: Array

    def weigh(self) -> tuple[list[int], list[float], float]:
        """Nodes and weights of a dead load at which gravity acts on all of the mesh, and its mass [kg].

        A dead load acts through the mean of the loaded points, weighted. A few nodes whose weighted mean of place and
        of every mode is that of all nodes give the same generalized forces at a fraction of the time.
        """
        share = np.asarray(self.mesh.mass.sum(axis=1)).reshape(-1, 3)[:, 0]
        total = float(share.sum())
        functions = np.column_stack([np.ones(len(share)), self.mesh.nodes, *(self.basis[k::3] for k in range(3))])
        sections = np.unique(np.round(self.mesh.nodes[:, 0], 12))
        count = 2 * self.basis.shape[1] + 6
        few = sections[np.linspace(0, len(sections) - 1, count).round().astype(int)]
        chosen = np.flatnonzero(np.isin(np.round(self.mesh.nodes[:, 0], 12), few))
        scale = np.max(np.abs(functions), axis=0)
        scale[scale == 0.0] = 1.0
        mean = share @ functions / total / scale
        weights, *_ = np.linalg.lstsq((functions[chosen] / scale).T, mean, rcond=1e-12)
        if np.max(np.abs((functions[chosen] / scale).T @ weights - mean)) > 1e-9:
            chosen, weights = np.arange(len(share)), share / total
        return chosen.tolist(), weights.tolist(), total


def reduced_bar(beam: Beam, elements: int, modes: int, *, carries: bool) -> ReducedBar:
    """The beam in ``modes`` vibrations; ``carries``: its tip's face is rigid, and has its own two modes, for a joint."""
    from exudyn import FEM

    mesh = _meshed(beam, elements)
    fem = FEM.FEMinterface()
    fem.nodes = {"Position": mesh.nodes}
    fem.elements = []
    fem.massMatrix = mesh.mass
    # Poisson's ratio is zero, so bending in the plane moves nothing across it: held stiffly there, a bar has no modes
    # out of the plane, with which those of a square section would mix.
    across = np.zeros(mesh.stiffness.shape[0])
    across[2::3] = mesh.stiffness.diagonal().max()
    fem.stiffnessMatrix = (mesh.stiffness + diags(across)).tocsr()
    fem.ComputeHurtyCraigBamptonModes(
        boundaryNodesList=[mesh.root, mesh.tip] if carries else [mesh.root],
        # In a thick bar waves along it come between.
        nEigenModes=2 * modes,
        useSparseSolver=True,
        computationMode=FEM.HCBstaticModeSelection.RBE2,
    )
    fem.stiffnessMatrix = mesh.stiffness
    basis = np.asarray(fem.modeBasis["matrix"])
    basis = basis[:, np.flatnonzero(_bends(mesh, basis))[: modes + (2 if carries else 0)]]
    fem.modeBasis["matrix"] = basis
    tip, height = 3 * mesh.tip, mesh.nodes[mesh.tip, 1]
    return ReducedBar(mesh, fem, basis, basis[tip + 1].mean(axis=0), -(height @ basis[tip]) / float(height @ height))


def _bends(mesh: Bar, basis: Array) -> Array:
    """Which modes bend the bar in its plane: sections move along y as a whole, and hardly otherwise."""
    _, section = np.unique(np.round(mesh.nodes[:, 0], 12), return_inverse=True)
    count = np.bincount(section)
    sums = np.array([np.bincount(section, weights=column) for column in basis[1::3].T])
    whole = np.sum(count * (sums / count) ** 2, axis=1)
    result: Array = whole > 0.5 * np.sum(basis**2, axis=0)
    return result


def _meshed(beam: Beam, elements: int) -> Bar:
    depth, width = beam.thickness, beam.width
    mesh = bar(
        beam.length,
        depth,
        width,
        beam.mass / (beam.length * depth * width),
        beam.bending_stiffness * 12.0 / (width * depth**3),
        elements,
    )
    if not beam.payload:
        return mesh
    spread = np.zeros(len(mesh.nodes))
    spread[mesh.tip] = 1.0 / len(mesh.tip)
    extra = csr_matrix(np.kron(beam.payload * np.outer(spread, spread), np.eye(3)))
    return Bar(mesh.nodes, (mesh.mass + extra).tocsr(), mesh.stiffness, mesh.root, mesh.tip)
