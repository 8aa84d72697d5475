"""The textbook's matrices as an engine: what the recursions are held against where no other engine knows the mechanism.

Masses from ``harness.denoc.matrices``, which integrates beams node by node; velocity forces by Lagrange's equations from the
derivatives of that mass matrix; weight from the momentum it gives; the elastic and passive forces as the description has them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Row, Series
from harness.cases.checks.batch import BatchAgreement
from harness.cases.checks.states import StateAgreement
from harness.denoc.beam.integrals import beam_data
from harness.denoc.matrices import DenocMatrices, denoc_matrices, joint_motion
from harness.errors import UnsupportedError
from harness.system import System, Trajectory

TEXTBOOK = "textbook"
# Central difference of order 6, and how far it turns or shifts what it moves [rad or m].
_WEIGHTS = (45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0)
_STEP = 0.01


@dataclass(frozen=True, eq=False)
class Textbook:
    """A system of joints of one degree each, some of its links flexible; see ``EngineModel``."""

    names: tuple[str, ...]
    system: System

    @cached_property
    def _steps(self) -> Array:
        """Of each coordinate, so that sections turn no farther than joints do."""
        steps = []
        for joint, link in zip(self.system.joints, self.system.links, strict=True):
            steps += [_STEP] * joint.movable
            if link.flexible:
                data = beam_data(self.system, link.name)
                size = np.maximum(np.abs(data.slope).max(axis=0), np.abs(data.s).max(axis=0) / data.length)
                steps += (_STEP / size).tolist()
        return np.array(steps)

    @cached_property
    def _linear(self) -> tuple[Array, Array, Array]:
        """Stiffness and damping, (n, n), of joints and beams, and where they are at rest, (n,)."""
        n = len(self.names)
        stiffness, damping, rest = np.zeros((n, n)), np.zeros((n, n)), np.zeros(n)
        place = 0
        for joint, link in zip(self.system.joints, self.system.links, strict=True):
            if joint.movable:
                stiffness[place, place], damping[place, place] = joint.stiffness, joint.damping
                rest[place] = joint.rest_position
                place += 1
            if link.flexible:
                data = beam_data(self.system, link.name)
                block = slice(place, place + data.coordinates)
                stiffness[block, block], damping[block, block] = data.K, data.C
                place += data.coordinates
        return stiffness, damping, rest

    @cached_property
    def _known(self) -> dict[bytes, Array]:
        return {}

    def _gradient(self, q: Array) -> Array:
        """∂M_ij/∂q_k, shape (n, n, n)."""
        key = np.ascontiguousarray(q).tobytes()
        if key not in self._known:
            found = []
            for k, step in enumerate(self._steps):
                shift = np.zeros(len(q))
                shift[k] = step
                terms = (
                    weight * (self.mass_matrix(q + (j + 1) * shift) - self.mass_matrix(q - (j + 1) * shift))
                    for j, weight in enumerate(_WEIGHTS)
                )
                found.append(sum(terms) / step)
            self._known[key] = np.stack(found, axis=2)
        return self._known[key]

    def mass_matrix(self, q: Array) -> Array:
        return denoc_matrices(self.system, q).inertia

    def mass_rate(self, q: Array, qd: Array) -> Array:
        """Ṁ, shape (n, n)."""
        return np.asarray(self._gradient(q) @ qd)

    def bias(self, q: Array, qd: Array) -> Array:
        gradient = self._gradient(q)
        moved = np.einsum("ijk,j,k->i", gradient, qd, qd) - 0.5 * np.einsum("jki,j,k->i", gradient, qd, qd)
        return np.asarray(moved + self.gravity(q))

    def gravity(self, q: Array) -> Array:
        """With unit weight along an axis the potential grows at the rate of the momentum along it."""
        return np.asarray(-np.asarray(self.system.gravity) @ self.momentum_matrix(q)[3:])

    def passive(self, q: Array, qd: Array) -> Array:
        stiffness, damping, rest = self._linear
        return np.asarray(-stiffness @ (q - rest) - damping @ qd)

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        return np.asarray(self.mass_matrix(q) @ qdd + self.bias(q, qd) - self.passive(q, qd))

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        return np.asarray(np.linalg.solve(self.mass_matrix(q), tau + self.passive(q, qd) - self.bias(q, qd)))

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        stiffness, _, rest = self._linear
        matrices = denoc_matrices(self.system, q)
        potential = 0.5 * float((q - rest) @ stiffness @ (q - rest))
        for origin, rows in zip(self._origins(matrices, q), matrices.rows, strict=True):
            own = matrices.M[rows, rows]
            potential -= float(np.asarray(self.system.gravity) @ (own[3, 3] * origin + _moment(own)))
        return 0.5 * float(qd @ matrices.inertia @ qd), potential

    def momentum_matrix(self, q: Array) -> Array:
        """Angular momentum about the base's origin and momentum, by unit velocities; without armature, (6, n)."""
        matrices = denoc_matrices(self.system, q)
        each = matrices.M @ matrices.N_l @ matrices.N_d
        whole = np.zeros((6, len(self.names)))
        for origin, rows in zip(self._origins(matrices, q), matrices.rows, strict=True):
            angular, linear = each[rows][:3], each[rows][3:6]
            whole[:3] += angular + np.cross(origin, linear, axisb=0, axisc=0)
            whole[3:] += linear
        return whole

    def origins(self, q: Array) -> Array:
        """Where every link's frame stands, (links, 3)."""
        return self._origins(denoc_matrices(self.system, q), q)

    def velocities(self, q: Array) -> Array:
        """Velocity of every link's origin by unit velocities, (links, 3, n)."""
        matrices = denoc_matrices(self.system, q)
        twists = matrices.N_l @ matrices.N_d
        return np.array([twists[rows][3:6] for rows in matrices.rows])

    def _origins(self, matrices: DenocMatrices, q: Array) -> Array:
        found: list[Array] = []
        for joint, parent, rows, columns in zip(
            self.system.joints, matrices.parents, matrices.rows, matrices.columns, strict=True
        ):
            if parent < 0:
                _, slide, _ = joint_motion(joint, q[columns][: len(joint.position_names)])
                found.append(np.asarray(joint.xyz + joint.rotation @ slide))
            else:
                # The rigid shift of a link against its parent is in its own block of N_l, as -[r]×.
                shift = matrices.N_l[rows, matrices.rows[parent]][3:6, :3]
                found.append(found[parent] + np.array([shift[1, 2], shift[2, 0], shift[0, 1]]))
        return np.array(found)

    def frequencies(self, q: Array) -> Array:
        raise UnsupportedError("the textbook's matrices are asked for forces alone")

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        raise UnsupportedError("the textbook's matrices are asked for forces alone")


def _moment(mass: Array) -> Array:
    """First moment [kg·m] in a mass matrix about an origin, whose upper right block is its [m c]×."""
    return np.array([mass[2, 4], mass[0, 5], mass[1, 3]])


@dataclass(frozen=True)
class AgainstTextbook:
    """A check of states, the native dynamics held against the textbook's matrices; its rows end in ``_bent``."""

    check: StateAgreement | BatchAgreement

    @property
    def quantity(self) -> str:
        return f"{self.check.quantity}_bent"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        if NATIVE not in bench.models:
            return
        models = {NATIVE: bench.models[NATIVE], TEXTBOOK: Textbook(bench.system.coordinate_names, bench.system)}
        for item in self.check.run(Bench(bench.case, bench.system, models)):
            yield replace(item, quantity=self.quantity) if isinstance(item, Row) else item
