"""Which combinations of masses, first and second moments a tree's motion can show at all: its base parameters.

Kinetic energy and potential are linear in the inertial parameters of the links about their frames' origins (mass, m·c,
inertia) and in the rotors' inertias. What changes neither at any position, up to a constant, no motion shows; what
changes them as others do shows only together with these. So columns of the energies at random positions are taken up
one by one, and what depends on those taken up before is grouped with them (Gautier and Khalil, IEEE Trans. Robot.
Autom. 6 (1990) 368; numerically as in Gautier, J. Robot. Syst. 8 (1991) 485).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from harness.denoc.lanes.rows import INERTIA_SLOTS
from harness.diagnose.arbitration.constants import BASE_PARAMETER_POSITIONS, DEPENDENT_COLUMN, NEGLIGIBLE_FACTOR
from harness.system import System
from harness.system.inertia import inertial_numbers

Array = NDArray[np.float64]
Key = tuple[str, str]  # link (or joint, for a rotor's inertia) and the parameter's name

ARMATURE = "armature"


@dataclass(frozen=True)
class BaseParameter:
    """One combination: the parameter ``key`` with factor one, and what is grouped with it."""

    key: Key
    with_: tuple[tuple[float, Key], ...] = ()

    def value(self, parameters: Mapping[Key, float]) -> float:
        """Of a model with these inertial parameters [SI]."""
        return parameters[self.key] + sum(factor * parameters[key] for factor, key in self.with_)


def base_parameters(system: System) -> tuple[BaseParameter, ...]:
    """The combinations of a rigid tree's inertial parameters that its motion shows.

    Second and first moments of moving links are taken up first, the farthest link's before, then rotors' inertias, what
    is fixed to links, and masses last: so that what is told of a joint is told of the link that it carries.
    """
    keys, columns = energies(system)
    place = {key: k for k, key in enumerate(keys)}
    taken: list[Key] = []
    grouped: dict[Key, list[tuple[float, Key]]] = {}
    for key in _order(system):
        column = columns[:, place[key]]
        length = float(np.linalg.norm(column))
        if length == 0.0:
            continue
        if taken:
            known = columns[:, [place[k] for k in taken]]
            sizes = np.linalg.norm(known, axis=0)
            factors = np.linalg.lstsq(known / sizes, column, rcond=None)[0] / sizes
            if float(np.linalg.norm(column - known @ factors)) <= DEPENDENT_COLUMN * length:
                for factor, other in zip(factors, taken, strict=True):
                    if abs(factor) > NEGLIGIBLE_FACTOR:
                        grouped[other].append((float(factor), key))
                continue
        taken.append(key)
        grouped[key] = []
    return tuple(BaseParameter(key, tuple(grouped[key])) for key in taken)


def inertial_parameters(system: System) -> dict[Key, float]:
    """Mass [kg], first moments [kg·m] and second moments about its frame's origin [kg·m²] of every link, and rotors'
    inertias."""
    found: dict[Key, float] = {}
    for link in system.links:
        pairs = zip(INERTIA_SLOTS, inertial_numbers(link), strict=True)
        found.update({(link.name, name): float(value) for name, value in pairs})
    found.update({(joint.name, ARMATURE): joint.armature for joint in system.movable_joints})
    return found


def energies(system: System) -> tuple[list[Key], Array]:
    """Columns of the mass matrix's entries and of the potential's change over random positions, one an inertial
    parameter."""
    rng = np.random.default_rng(0)
    n = len(system.joint_names)
    upper = np.triu_indices(n)
    first: Array | None = None
    rows = []
    keys: list[Key] = []
    for _ in range(BASE_PARAMETER_POSITIONS):
        q = rng.uniform(-np.pi, np.pi, n)
        keys, masses, potentials = _at(system, q, upper)
        first = potentials if first is None else first
        rows += [masses, (potentials - first)[None]]
    return keys, np.concatenate(rows)


def _at(system: System, q: Array, upper: tuple[NDArray[np.intp], ...]) -> tuple[list[Key], Array, Array]:
    """Parameters, their columns of the mass matrix's upper triangle (E, K), and of the potential (K,), at one
    position."""
    n = len(q)
    number = {name: k for k, name in enumerate(system.joint_names)}
    # Of every link: axes, origin, and the Jacobians of the origin's velocity and of the angular velocity, in the base's axes.
    at = {system.base: (np.eye(3), np.zeros(3), np.zeros((3, n)), np.zeros((3, n)))}
    keys: list[Key] = []
    masses, potentials = [], []
    i, j = upper
    for joint, link in zip(system.joints, system.links, strict=True):
        axes, origin, linear, angular = at[joint.parent]
        shift = axes @ joint.xyz
        axes, origin = axes @ joint.rotation, origin + shift
        linear, angular = linear + np.cross(angular.T, shift).T, angular.copy()
        if joint.movable:
            k, axis = number[joint.name], axes @ joint.axis
            if joint.prismatic:
                origin = origin + axis * q[k]
                linear = linear + np.cross(angular.T, axis * q[k]).T
                linear[:, k] += axis
            else:
                axes = axes @ Rotation.from_rotvec(joint.axis * q[k]).as_matrix()
                angular[:, k] += axis
        at[joint.child] = axes, origin, linear, angular
        v, w = axes.T @ linear, axes.T @ angular
        moment = np.cross(v[:, i], w[:, j], axis=0) + np.cross(v[:, j], w[:, i], axis=0)
        squares = [w[a, i] * w[a, j] for a in range(3)]
        products = [w[a, i] * w[b, j] + w[b, i] * w[a, j] for a, b in ((0, 1), (0, 2), (1, 2))]
        masses += [np.sum(v[:, i] * v[:, j], axis=0), *moment, *squares, *products]
        potentials += [-float(system.gravity @ origin), *(-(axes.T @ system.gravity)), *np.zeros(6)]
        keys += [(link.name, name) for name in INERTIA_SLOTS]
    for name, k in number.items():
        masses.append(((i == k) & (j == k)).astype(np.float64))
        potentials.append(0.0)
        keys.append((name, ARMATURE))
    return keys, np.stack(masses, axis=1), np.array(potentials)


def _order(system: System) -> list[Key]:
    """In which order parameters are taken up."""
    moving = [joint.child for joint in reversed(system.joints) if joint.movable]
    fixed = [joint.child for joint in reversed(system.joints) if not joint.movable]
    seconds, firsts = INERTIA_SLOTS[4:], INERTIA_SLOTS[1:4]
    order: list[Key] = [(link, name) for link in moving for name in (*seconds, *firsts)]
    # What slides has a mass first, and a rotor's inertia beside it.
    order += [(joint.child, "mass") for joint in reversed(system.movable_joints) if joint.prismatic]
    order += [(joint, ARMATURE) for joint in system.joint_names]
    order += [(link, name) for link in fixed for name in (*seconds, *firsts)]
    return list(dict.fromkeys([*order, *((link, "mass") for link in (*moving, *fixed))]))
