"""The torque that a motion needs as a polynomial of what is uncertain about a rigid mechanism.

Inverse dynamics is linear in the masses, first and second moments of the links (Atkeson, An and Hollerbach, Int. J. Robotics Res.
5(3) (1986) 101), and lengths enter as squares at most: a link's torque is its mass times a product of the arm that its force has
and of the acceleration that the arm gives it. So the torque along a motion is a sum of products of at most four factors by which
nominal quantities are multiplied, and its terms are computed once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from harness.denoc.batch.model import BatchModel
from harness.denoc.lanes.rows import BASE_SLOTS, INERTIA_SLOTS, PLACEMENT_SLOTS
from harness.diagnose.inverse.constants import MOST_FACTORS
from harness.diagnose.problem.hypothesis import Nominal
from harness.system import System
from harness.system.inertia import inertial_numbers, point_inertia

Array = NDArray[np.float64]

OF_JOINTS = ("armature", "damping", "stiffness")


@dataclass(frozen=True, eq=False)
class Terms:
    """Products of factors, and what torque each is multiplied with: a sum of those of mechanisms with one link in them.

    factors: which factors each product has, (m, MOST_FACTORS); one more than there are stands for 1. rows: parameter rows of those
    mechanisms. weights: of their torques in each term, (m, rows).
    """

    factors: NDArray[np.intp]
    weights: Array
    rows: tuple[Array, ...]


class NominalRows:
    """Parameter rows of a rigid mechanism for any factors of its nominal quantities.

    Only for systems that ``fits`` takes, without attached effects.
    """

    def __init__(self, system: System, nominal: Sequence[Nominal]) -> None:
        self.model = BatchModel(system)
        self.count = len(nominal)
        own = {(quantity.kind, quantity.name): k for k, quantity in enumerate(nominal)}
        self._row = self.model.lanes.row(system)
        at = len(BASE_SLOTS)
        parts: dict[str, _Part] = {}
        for joint, link in zip(system.joints, system.links, strict=True):
            numbers = inertial_numbers(link)
            apart = np.zeros(10)
            apart[4:] = point_inertia(link.mass, np.asarray(link.com))[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
            which = [own.get((kind, link.name), self.count) for kind in ("mass", "length", "inertia")]
            parts[link.name] = _Part(
                slice(at, at + 3),
                slice(at + len(PLACEMENT_SLOTS), at + len(PLACEMENT_SLOTS) + len(INERTIA_SLOTS)),
                own.get(("length", joint.parent), self.count),
                (which[0], which[1], which[2]),
                numbers,
                apart,
                parts.get(joint.parent),
            )
            at += len(PLACEMENT_SLOTS) + len(INERTIA_SLOTS)
        self._links = list(parts.values())
        self._joints = [
            (self.model.lanes.slot(joint.name, kind), own.get((kind, joint.name), self.count))
            for joint in system.movable_joints
            for kind in OF_JOINTS
        ]

    @staticmethod
    def fits(system: System) -> bool:
        """Whether the system is one of rigid links on joints of one degree of freedom each, and nothing else."""
        plain = system.simple and not system.flexible and not system.loops and not system.drives
        return plain and not system.attachments and not any(link.gravcomp for link in system.links)

    def row(self, factors: Array) -> Array:
        """The row for factors (nominal,), shape (P,)."""
        f = np.append(factors, 1.0)
        row = self._row.copy()
        for part in self._links:
            row[part.place] = self._row[part.place] * f[part.above]
            row[part.inertia] = part.scaled(f)
        for slot, k in self._joints:
            row[slot] = self._row[slot] * f[k]
        return row

    def of_each_number(self) -> list[Array]:
        """Rows of the mechanism with nothing in it but one of a link's ten inertial numbers, which is one."""
        return [self._bare(part, unit, {}) for part in self._links for unit in np.eye(len(INERTIA_SLOTS))]

    def terms(self) -> Terms:
        """What the torque along any motion is made up of."""
        factors: list[tuple[int, ...]] = []
        rows: list[Array] = []
        weights: list[dict[int, float]] = []

        def add(which: tuple[int, ...], made_of: dict[int, float]) -> None:
            factors.append((*which, *[self.count] * (MOST_FACTORS - len(which))))
            weights.append(made_of)

        for part in self._links:
            mass, length, inertia = part.factors
            turning = part.numbers - part.apart
            turning[:4] = 0.0
            if turning.any():
                rows.append(self._bare(part, turning, {}))
                add((mass, inertia), {len(rows) - 1: 1.0})
            if part.numbers[0] == 0.0:
                continue
            lengths = sorted({k for k in part.lengths(self._row) if k < self.count})
            at: dict[tuple[int, ...], int] = {}
            for several in ((), *((k,) for k in lengths), *((k, k) for k in lengths), *combinations(lengths, 2)):
                # Lengths of nothing, but for one or two.
                given = dict.fromkeys(lengths, 0.0) | {k: float(several.count(k)) for k in several}
                f = np.ones(self.count + 1)
                f[list(given)] = list(given.values())
                point = part.numbers * np.repeat([1.0, f[length]], [1, 9])
                point[4:] = part.apart[4:] * f[length] ** 2
                rows.append(self._bare(part, point, given))
                at[several] = len(rows) - 1
            # Interpolation: f(0) = c, f(1) = c + b + a, f(2) = c + 2 b + 4 a, and f(1, 1) has the product besides.
            none = at[()]
            add((mass,), {none: 1.0})
            for k in lengths:
                one, two = at[k,], at[k, k]
                add((mass, k), {none: -1.5, one: 2.0, two: -0.5})
                add((mass, k, k), {none: 0.5, one: -1.0, two: 0.5})
            for k, l in combinations(lengths, 2):
                add((mass, k, l), {at[k, l]: 1.0, at[k,]: -1.0, at[l,]: -1.0, none: 1.0})
        for slot, k in self._joints:
            if self._row[slot] != 0.0:
                rows.append(self._bare(None, np.zeros(10), {}))
                rows[-1][slot] = self._row[slot]
                add((k,), {len(rows) - 1: 1.0})
        table = np.zeros((len(weights), len(rows)))
        for k, made_of in enumerate(weights):
            table[k, list(made_of)] = list(made_of.values())
        return Terms(np.array(factors, dtype=np.intp), table, tuple(rows))

    def _bare(self, only: _Part | None, numbers: Array, lengths: dict[int, float]) -> Array:
        """The row of the mechanism with nothing in it but one link's inertial numbers, lengths multiplied."""
        row = self._row.copy()
        f = np.ones(self.count + 1)
        f[list(lengths)] = list(lengths.values())
        for part in self._links:
            row[part.place] *= f[part.above]
            row[part.inertia] = numbers if part is only else 0.0
        for slot, _ in self._joints:
            row[slot] = 0.0
        return row


@dataclass(frozen=True, eq=False)
class _Part:
    """A link and its joint in the row.

    place, inertia: where they stand; above: the factor of the parent's length; factors: of mass, length and inertia; numbers: its
    inertial numbers (10,); apart: those of its mass away from the origin; parent: what carries it.
    """

    place: slice
    inertia: slice
    above: int
    factors: tuple[int, int, int]
    numbers: Array
    apart: Array
    parent: _Part | None

    def scaled(self, f: Array) -> Array:
        """Its inertial numbers with factors (nominal + 1,)."""
        mass, length, inertia = f[list(self.factors)]
        return np.concatenate(
            [
                self.numbers[:1] * mass,
                self.numbers[1:4] * (mass * length),
                (self.numbers[4:] - self.apart[4:]) * (mass * inertia) + self.apart[4:] * (mass * length**2),
            ]
        )

    def lengths(self, row: Array) -> Iterator[int]:
        """Factors of the lengths on the way to its centre of mass."""
        if self.numbers[1:4].any():
            yield self.factors[1]
        part: _Part | None = self
        while part is not None:
            if row[part.place].any():
                yield part.above
            part = part.parent
