"""Closed loops in MuJoCo: its equalities, which are soft, and its own matrices with the softness taken out.

``forward_dynamics`` and ``inverse_dynamics`` hold loops exactly: mass matrix, forces, Jacobians and their rates (``mj_jacDot``) are
MuJoCo's, constraint forces are eliminated from them here. ``simulate`` is MuJoCo's motion with its equality constraints,
connections and welds of sites, as stiff as it allows at its step unless told: its constraint has no term J̇ q̇ but pulls back
what has opened.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.engines.checked import finite_result
from harness.engines.loops import Closing, eliminated, least
from harness.engines.mujoco_model import MujocoModel, quaternion
from harness.engines.protocol import Array

# Time constant [s] in steps, and damping ratio: MuJoCo raises the first to two steps by itself.
STIFFEST = (2.0, 1.0)
IMPEDANCE = (0.9999, 0.9999, 1e-3, 0.5, 2.0)


def add_equalities(mujoco: Any, spec: Any, closing: Closing, bodies: Mapping[str, str]) -> None:
    """Sites and equality constraints to an ``MjSpec``; bodies: what MuJoCo calls the links."""
    solref = np.array([STIFFEST[0] * spec.option.timestep, STIFFEST[1]])
    for k, connection in enumerate(closing.connections):
        names = []
        for frame, side in ((connection.first, 1), (connection.second, 2)):
            body = spec.body(bodies[frame.link])
            names.append(f"loop{k}__{side}")
            body.add_site(name=names[-1], pos=np.array(frame.xyz), quat=quaternion(np.asarray(frame.rotation)))
        kind = mujoco.mjtEq.mjEQ_WELD if connection.welded else mujoco.mjtEq.mjEQ_CONNECT
        equality = spec.add_equality(
            name=f"loop{k}", type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, name1=names[0], name2=names[1]
        )
        if connection.welded:
            # The pose that sites are welded in is their own, and turns count like shifts.
            equality.data[10] = 1.0
        equality.solref, equality.solimp = solref, np.array(IMPEDANCE)
    for coupling in closing.couplings:
        equality = spec.add_equality(
            name=coupling.name,
            type=mujoco.mjtEq.mjEQ_JOINT,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            name1=coupling.joint,
            name2=coupling.leader or "",
            solref=solref,
            solimp=np.array(IMPEDANCE),
        )
        # How many numbers an equality has differs between versions (11 before 4.0).
        equality.data[:5] = coupling.coefficients


@dataclass(frozen=True, eq=False)
class ClosedMujocoModel(MujocoModel):
    """A closed system in MuJoCo; see ``EngineModel``."""

    closing: Closing

    def soften(self, time_constant: float, damping_ratio: float = 1.0) -> None:
        """Make the equalities as soft as that (``solref``) [s]."""
        self.model.eq_solref[:] = (time_constant, damping_ratio)

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        mass = self.mass_matrix(q)
        forces = tau + self._extra(q, qd) - self.bias(q, qd) + self._out(self.data.qfrc_passive)
        jacobian, rate = self._jacobians()
        found = eliminated(mass, forces, jacobian, -rate @ qd)
        return finite_result("mujoco", "forward dynamics", found)

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        needed = super().inverse_dynamics(q, qd, qdd)
        self.bias(q, qd)
        return least(needed, self._jacobians()[0])

    def _jacobians(self) -> tuple[Array, Array]:
        """What the loops hold as a Jacobian, and its rate, each (c, n), at the state that was asked about last."""
        rows: list[Array] = []
        rates: list[Array] = []
        for k, connection in enumerate(self.closing.connections):
            one, other = (self._site(f"loop{k}__{side}") for side in (1, 2))
            count = 6 if connection.welded else 3
            rows.append((other[0] - one[0])[:count])
            rates.append((other[1] - one[1])[:count])
        for coupling in self.closing.couplings:
            row, rate = np.zeros((1, self.model.nv)), np.zeros((1, self.model.nv))
            row[0, self._dof(coupling.joint)] = 1.0
            if coupling.leader is not None:
                led = self._dof(coupling.leader)
                _, slope, bend = coupling.value(float(self.data.joint(coupling.leader).qpos[0]))
                row[0, led] -= slope
                rate[0, led] = -bend * float(self.data.qvel[led])
            rows.append(row)
            rates.append(rate)
        ours = np.argsort(self.order)
        return np.vstack(rows)[:, ours], np.vstack(rates)[:, ours]

    def _dof(self, joint: str) -> int:
        return int(self.model.joint(joint).dofadr[0])

    def _site(self, name: str) -> tuple[Array, Array]:
        """Jacobian of a site's position and rotation, (6, n), and its rate."""
        from harness.engines.mujoco_model import _mujoco

        mujoco = _mujoco()
        site = self.model.site(name).id
        body, point = int(self.model.site_bodyid[site]), self.data.site_xpos[site]
        whole, rate = np.zeros((6, self.model.nv)), np.zeros((6, self.model.nv))
        mujoco.mj_jac(self.model, self.data, whole[:3], whole[3:], point, body)
        mujoco.mj_jacDot(self.model, self.data, rate[:3], rate[3:], point, body)
        return whole, rate

    @contextmanager
    def _constraints(self, mujoco: Any) -> Iterator[None]:
        """Constraints on while the system is simulated."""
        kept = int(self.model.opt.disableflags)
        off = mujoco.mjtDisableBit
        self.model.opt.disableflags = kept & ~int(off.mjDSBL_CONSTRAINT | off.mjDSBL_EQUALITY | off.mjDSBL_LIMIT)
        try:
            yield
        finally:
            self.model.opt.disableflags = kept
