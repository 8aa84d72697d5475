"""Flexible links held straight: what is left must be the rigid mechanism, in engines that know no beams."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Row, Series
from harness.cases.checks.states import StateAgreement
from harness.engines.protocol import EngineModel
from harness.engines.registry import engine
from harness.errors import EngineUnavailableError, UnsupportedError
from harness.system import System, Trajectory


@dataclass(frozen=True, eq=False)
class Straight:
    """The joints' share of a flexible model whose elastic coordinates, rates and accelerations are zero.

    names, system: of the rigid mechanism. model: the flexible one. where: its columns of the joints, shape (n,).
    """

    names: tuple[str, ...]
    system: System
    model: EngineModel
    where: Array

    def _wide(self, values: Array) -> Array:
        wide = np.zeros(len(self.model.names))
        wide[self.where] = values
        return wide

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        return self.model.inverse_dynamics(self._wide(q), self._wide(qd), self._wide(qdd))[self.where]

    def mass_matrix(self, q: Array) -> Array:
        return self.model.mass_matrix(self._wide(q))[np.ix_(self.where, self.where)]

    def bias(self, q: Array, qd: Array) -> Array:
        return self.model.bias(self._wide(q), self._wide(qd))[self.where]

    def gravity(self, q: Array) -> Array:
        return self.model.gravity(self._wide(q))[self.where]

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        return self.model.energy(self._wide(q), self._wide(qd))

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        raise UnsupportedError("a beam that is free to bend does not stay straight")

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        raise UnsupportedError("a beam that is free to bend does not stay straight")

    def frequencies(self, q: Array) -> Array:
        raise UnsupportedError("a beam that is free to bend does not stay straight")


@dataclass(frozen=True)
class FrozenAgreement:
    """Relative difference of a quantity, beams straight, between the native dynamics and each engine of rigid bodies.

    of: ``inverse_dynamics``, ``mass_matrix``, ``bias``, ``gravity`` or ``energy``. allowed, why, states: as in
    ``StateAgreement``. Nothing is compared where no joint moves, and with engines that refuse the rigid mechanism.
    """

    of: str
    allowed: float
    why: str
    states: int = 8

    @property
    def quantity(self) -> str:
        return f"{self.of}_straight"

    def run(self, bench: Bench) -> Iterable[Row | Series]:
        rigid = bench.system.rigid()
        if NATIVE not in bench.models or not rigid.coordinate_names:
            return
        flexible = bench.models[NATIVE]
        where = np.array([flexible.names.index(name) for name in rigid.coordinate_names])
        straight = Straight(rigid.coordinate_names, rigid, flexible, where)
        models: dict[str, EngineModel] = {NATIVE: cast(EngineModel, straight)}
        for name in (*bench.models, *bench.refusals):
            if name == NATIVE:
                continue
            try:
                engine(name).version()
                if engine(name).refuses(rigid) is None:
                    models[name] = engine(name).build(rigid)
            except (UnsupportedError, EngineUnavailableError):
                continue  # a row of the case says so already
        agreement = StateAgreement(self.of, self.allowed, self.why, self.states)
        for item in agreement.run(Bench(bench.case, rigid, models)):
            if isinstance(item, Row) and item.verdict != "skipped":
                note = "; ".join(filter(None, ["flexible links held straight", item.note]))
                yield replace(item, quantity=self.quantity, note=note)
