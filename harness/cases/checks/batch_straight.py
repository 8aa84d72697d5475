"""Many states of a flexible mechanism in one call, beams held straight, against engines of rigid bodies."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Row, Series
from harness.cases.checks.batch import BATCHES, FEW, of_row
from harness.denoc import Denoc
from harness.engines.protocol import EngineModel
from harness.engines.registry import engine
from harness.errors import EngineUnavailableError, UnsupportedError

RIGID = ("pinocchio", "mujoco")


@dataclass(frozen=True)
class BatchStraight:
    """Largest relative difference between the joints' share of a ``*_batch`` method and the rigid mechanism.

    of: a key of ``BATCHES``. allowed, why: as in ``StateAgreement``. Accelerations: under the forces by which the other engine
    moves the joints as asked, and those that hold the beams straight, the joints must move as asked and no beam bend.
    """

    of: str
    allowed: float
    why: str
    states: int = 11

    @property
    def quantity(self) -> str:
        return f"{BATCHES[self.of][0]}_straight"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        rigid = bench.system.rigid()
        native = Denoc(bench.system)
        names = bench.system.coordinate_names
        where = np.array([names.index(name) for name in rigid.coordinate_names])
        q, qd, qdd = bench.rng().standard_normal((3, self.states, len(where)))
        wide = np.zeros((3, self.states, len(names)))
        wide[:, :, where] = q, qd, qdd
        for name in RIGID:
            try:
                engine(name).version()
                model = engine(name).build(rigid)
            except (UnsupportedError, EngineUnavailableError) as error:
                yield bench.skipped(self.quantity, (NATIVE, name), str(error))
                continue
            ours, theirs = self._answers(native, model, wide, where, (q, qd, qdd))
            scale = np.abs(theirs).reshape(self.states, -1).max(1)
            apart = np.abs(ours - theirs).reshape(self.states, -1).max(1) / scale
            worst = int(np.argmax(apart))
            place: dict[str, object] | None = None
            note = f"{self.states} states in one call, flexible links held straight"
            if not apart[worst] <= self.allowed:
                forces = np.array([model.inverse_dynamics(*each) for each in zip(q, qd, qdd, strict=True)])
                row = straight_row(self.of, native, where, self.states)
                said, site = of_row(self.of, row, name, model, q[:FEW], qd[:FEW], forces[:FEW])
                place = {"state": worst} | site
                note = "; ".join(filter(None, [note, said]))
            yield bench.row(
                self.quantity,
                (NATIVE, name),
                float(apart[worst]),
                self.allowed,
                why=self.why,
                first_divergence=place,
                note=note,
            )

    def _answers(
        self, native: Denoc, model: EngineModel, wide: Array, where: Array, state: tuple[Array, Array, Array]
    ) -> tuple[Array, Array]:
        """Of the native batch and of the other engine, one row a state."""
        if self.of == "mass_matrix":
            whole = native.mass_matrix_batch(wide[0])
            return whole[:, where[:, None], where], np.array([model.mass_matrix(q) for q in state[0]])
        forces = native.inverse_dynamics_batch(*wide)
        moved = np.array([model.inverse_dynamics(*each) for each in zip(*state, strict=True)])
        if self.of == "inverse_dynamics":
            return forces[:, where], moved
        forces[:, where] = moved
        return native.forward_dynamics_batch(wide[0], wide[1], forces), wide[2]


def straight_row(of: str, native: Denoc, where: Array, count: int) -> Callable[..., Array]:
    """What a batch of ``count`` equal rows gives the joints of a mechanism whose beams are held straight, as if it were rigid.

    of: a key of ``BATCHES``; where: the joints' places among all coordinates.
    """
    method = getattr(native, BATCHES[of][0])
    bent = np.setdiff1d(np.arange(native.n), where)

    def last(*joints: Array) -> Array:
        return np.asarray(method(*(np.tile(_wide(x, where, native.n), (count, 1)) for x in joints))[-1])

    def acceleration(q: Array, qd: Array, tau: Array) -> Array:
        # The forces that hold the beams are those under which none of them bends: accelerations are linear in forces.
        free = last(q, qd, tau)
        held = np.zeros((native.n, len(bent)))
        for k, place in enumerate(bent):
            pushed = np.array([_wide(q, where, native.n), _wide(qd, where, native.n), _wide(tau, where, native.n)])
            pushed[2, place] = 1.0
            held[:, k] = np.asarray(method(*(np.tile(x, (count, 1)) for x in pushed))[-1]) - free
        return np.asarray((free + held @ np.linalg.solve(held[bent], -free[bent]))[where])

    if of == "acceleration":
        return acceleration
    if of == "mass_matrix":
        return lambda q: last(q)[np.ix_(where, where)]
    return lambda q, qd, qdd: last(q, qd, qdd)[where]


def _wide(joints: Array, where: Array, n: int) -> Array:
    """With zeros where beams bend."""
    whole = np.zeros(n)
    whole[where] = joints
    return whole
