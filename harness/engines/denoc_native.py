"""The native DeNOC dynamics as an engine; its conventions are the project's, so there is nothing to transform."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.effects.catalogue import effect
from harness.engines.checked import held_forces, positive_step, raise_if_refused, sample_times, vector, vectors
from harness.engines.coupled import CoupledModel, couple, follows, without_mimics
from harness.engines.curves import curves, march_along
from harness.engines.expressed import Expressed, bends, express
from harness.engines.protocol import Array, EngineError
from harness.engines.soft_motion import soft_joints, soft_march
from harness.errors import InputError
from harness.system import Attachment, JointType, System, Trajectory
from harness.system.loop import explicit
from harness.system.lowering import chained, position_of_rate


def beyond_lanes(system: System, laws: Collection[Attachment]) -> bool:
    """Whether there is that in a system, beside joint laws, drives and limits, which the lanes do not hold."""
    in_space = any(joint.turns_in_space or joint.type is JointType.HELICAL for joint in system.joints)
    lifted = any(link.gravcomp for link in system.links)
    driven = [drive.joint for drive in system.drives]
    several = len(set(driven)) < len(driven) or (driven and any(law.effect == "backlash" for law in laws))
    # A joint has one place for stops in the lanes.
    bounded = {stop.joint for stop in system.stops} & {law.site for law in laws if law.effect == "end_stop"}
    acting = bool(laws or system.drives or system.stops)
    return acting and bool(in_space or lifted or several or bounded)


def _acting(system: System) -> bool:
    return bool(system.attachments or system.drives or system.stops)


@dataclass(frozen=True, eq=False)
class NativeModel:
    """A system in the native dynamics; see ``EngineModel``. ``model`` is the ``harness.denoc.Denoc``."""

    names: tuple[str, ...]
    system: System
    model: Any
    expressed: Expressed

    @property
    def position_names(self) -> tuple[str, ...]:
        return tuple(self.model.position_names)

    def _forces(self, q: Array, qd: Array) -> Array | float:
        # Joint coordinates alone have laws; elastic ones lie between them.
        if not self.expressed.forces.any:
            return 0.0
        places = [self.names.index(name) for joint in self.system.joints for name in joint.velocity_names]
        at = position_of_rate(self.system)[places]
        total = np.zeros(len(self.names))
        total[places] = self.expressed.forces(np.where(at >= 0, q[at], 0.0), qd[places])
        return total

    def _state(self, q: Array, **others: Array) -> Iterator[Array]:
        """Positions, and what has the size of velocities, checked."""
        yield vector("q", q, len(self.position_names))
        yield from vectors(len(self.names), **others)

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        q, qd, tau = self._state(q, qd=qd, tau=tau)
        return np.asarray(self.model.forward_dynamics(q, qd, tau + self._forces(q, qd)))

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        q, qd, qdd = self._state(q, qd=qd, qdd=qdd)
        return np.asarray(self.model.inverse_dynamics(q, qd, qdd)) - self._forces(q, qd)

    def mass_matrix(self, q: Array) -> Array:
        return np.asarray(self.model.mass_matrix(vector("q", q, len(self.position_names))))

    def bias(self, q: Array, qd: Array) -> Array:
        q, qd = self._state(q, qd=qd)
        return np.asarray(self.model.bias(q, qd))

    def gravity(self, q: Array) -> Array:
        return np.asarray(self.model.gravity(vector("q", q, len(self.position_names))))

    def energy(self, q: Array, qd: Array) -> tuple[float, float]:
        q, qd = self._state(q, qd=qd)
        kinetic, potential = self.model.energy(q, qd)
        return float(kinetic), float(potential)

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """RK4 with steps of at most ``step`` [s], or the adaptive method if it is None.

        Beams and dry friction keep the native choice of method: their vibrations and reversals need another than RK4.
        Systems with joint laws beyond damping, springs and dry friction run in the lanes, which always adapt their step; what the
        lanes do not hold (joints of several degrees of freedom with laws, carried weight with dry friction, several drives of a
        joint) is integrated over these accelerations, dry friction and limits being MuJoCo's soft constraints.
        """
        n = len(self.names)
        q0, qd0 = self._state(q0, qd0=qd0)
        time = sample_times(time)
        forces = held_forces(tau, time.size, n)
        if self._coupled:
            return self._simulate_coupled(q0, qd0, time, forces, positive_step(step))
        if self.by_calls:
            return self._simulate_softly(q0, qd0, time, forces, positive_step(step))
        rubbing = sum(joint.friction > 0.0 for joint in self.system.movable_joints)
        if self.system.gimbals:
            return self._simulate_laws(q0, qd0, time, forces, positive_step(step))
        together = bool(self.system.loops) and rubbing > 1 and self.system.simple and not self.system.flexible
        if self.expressed.laws or self.system.drives or self.system.stops or together:
            return self._simulate_laws(q0, qd0, time, forces, positive_step(step))
        plain = not self.system.flexible and not any(joint.friction for joint in self.system.movable_joints)
        method = "rk4" if plain and step is not None else None
        trajectory: Trajectory = self.model.simulate(q0, qd0, time, tau=forces, step=positive_step(step), method=method)
        return trajectory

    @property
    def _coupled(self) -> bool:
        """Whether joints are polynomials of others, beside what a run with loops does not hold."""
        system = self.system
        rubbing = sum(joint.friction > 0.0 for joint in system.movable_joints)
        more = bool(self.expressed.laws) or _acting(system) or rubbing > 1
        return more and bool(explicit(system.loops)) and not system.flexible

    def _simulate_coupled(
        self, q0: Array, qd0: Array, time: Array, tau: Array | None, step: float | None
    ) -> Trajectory:
        system = replace(self.system, attachments=self.expressed.laws)
        along = curves(system, explicit(system.loops))
        # As soft as MuJoCo makes it, which counts with the inertia of the tree.
        soft = soft_joints(system, np.asarray(np.linalg.inv(self.mass_matrix(self.model.neutral))), rubbing=True)
        rates = None if len(q0) == len(qd0) else self.model.position_rates
        found = march_along(along, self.forward_dynamics, self.mass_matrix, soft, q0, qd0, time, tau, rates, step=step)
        return Trajectory(time, self.names, *found, position_names=self.position_names)

    @property
    def by_calls(self) -> bool:
        """Whether the lanes do not hold the system, and its accelerations have to be called for."""
        rubs = any(joint.friction for joint in self.system.movable_joints)
        return beyond_lanes(self.system, self.expressed.laws) or (self.model.by_calls and rubs)

    def _simulate_softly(self, q0: Array, qd0: Array, time: Array, tau: Array | None, step: float | None) -> Trajectory:
        system = replace(self.system, attachments=self.expressed.laws)
        inverse = np.linalg.inv(self.model.mass_matrix(self.model.neutral))
        soft = soft_joints(system, inverse, rubbing=True)
        rates = None if len(q0) == len(qd0) else self.model.position_rates
        position, velocity = soft_march(self, soft, q0, qd0, time, tau, rates, step=step)
        return Trajectory(time, self.names, position, velocity, position_names=self.position_names)

    def _simulate_laws(self, q0: Array, qd0: Array, time: Array, tau: Array | None, step: float | None) -> Trajectory:
        from harness.denoc.motion.channels import channels
        from harness.effects.lanes import lane_model, lane_row

        attached = replace(self.system, attachments=self.expressed.laws)
        own = [
            kind for kind in map(effect, dict.fromkeys(a.effect for a in attached.attachments)) if kind.user is not None
        ]
        lanes = lane_model(attached, own)
        row = lane_row(lanes, attached, own)[None]
        if self.expressed.shaking is not None:
            for axis, part in zip("xyz", self.expressed.shaking.direction, strict=True):
                row[0, lanes.slot("base", f"excitation_{axis}")] = part

        found = lanes.simulate(row, q0, qd0, time - time[0], tau=tau, hold="zero", step=step)
        position, velocity, acceleration = found[0][0], found[1][0], found[2][0]
        if not np.all(np.isfinite(position)):
            raise EngineError("denoc: the motion is not finite any more")
        signals = channels(self.model, position, velocity, acceleration) if self.system.flexible else {}
        return Trajectory(time, self.names, position, velocity, channels=signals)

    def closed_state(self, q: Array, qd: Array) -> tuple[Array, Array]:
        """The nearest state whose loops are closed; the same where there are none."""
        if not self.system.loops:
            return q, qd
        q = self.model.assemble(q)
        return q, np.asarray(self.model.closed_velocity(q, qd))

    def frequencies(self, q: Array) -> Array:
        return np.asarray(self.model.frequencies(vector("q", q, len(self.position_names))))


@dataclass(frozen=True)
class Native:
    """The native DeNOC dynamics as an ``Engine``."""

    name: str = "denoc"

    def version(self) -> str:
        from harness.version import __version__

        return __version__

    def refuses(self, system: System) -> str | None:
        if not system.coordinate_names:
            return "the system has no movable joint and no elastic link"
        try:
            expressed = express(without_mimics(system))
        except InputError as error:
            return str(error)
        if system.loops and (expressed.laws or _acting(system)):
            if explicit(system.loops) and not bends(system) and not follows(system):
                return expressed.refusal("the native dynamics by single calls", constraints=True)
            if bends(system) or follows(system) or beyond_lanes(system, expressed.laws):
                return (
                    "beside loops the native dynamics has damping, springs and dry friction alone, no drives, limits or other "
                    "laws, where links bend, joints turn in space or follow others"
                )
        if system.loops and any(link.gravcomp for link in system.links):
            return "the native dynamics has no gravity compensation of single links beside loops"
        if bends(system) and any(link.gravcomp for link in system.links):
            return "the native dynamics has no gravity compensation of single links beside links that bend"
        if beyond_lanes(expressed.system, expressed.laws) or (_acting(system) and follows(system)):
            reason = expressed.refusal("the native dynamics by single calls", constraints=True, compensation=True)
            if reason is None and bends(system):
                reason = (
                    "the native dynamics has drives, limits and laws beside such joints or drives of rigid links alone"
                )
            return reason
        beyond = expressed.beyond
        for attachment in beyond:
            kind = effect(attachment.effect)
            if kind.law is None and kind.user is None:
                return f"the native dynamics has no law for the effect {attachment.effect} at {attachment.site}"
        own = {a.effect for a in beyond if a.effect == "backlash" or effect(a.effect).user is not None}
        if len(own) > 1:
            return f"{' and '.join(sorted(own))} together need two laws of their own"
        return None

    def build(self, system: System) -> NativeModel | CoupledModel:
        """The system compiled; raises UnsupportedError if the native dynamics does not model it."""
        raise_if_refused(system, self.refuses(system))
        from harness.denoc import Denoc

        if follows(system) and _acting(system):
            chain = chained(system)
            independent = self.build(without_mimics(chain))
            return couple(system, independent, independent.names, independent.position_names)
        expressed = express(system)
        system = expressed.system
        return NativeModel(names=system.coordinate_names, system=system, model=Denoc(system), expressed=expressed)
