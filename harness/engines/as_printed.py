"""The paper's equations (7) and (10) as an engine of their own: as printed, or with some of the misprints mended.

It is no peer: its equations are wrong. It is there to say what each misprint does, see ``cases/paper_rigid.py`` and
``cases/paper_flexible.py``. With all of them mended the equations are the correct ones of a pendulum with one mode,
foreshortening left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
import scipy

from harness.denoc.beam.integrals import BENDING, beam_data
from harness.effects.scale import tip_of
from harness.engines.checked import (
    finite_result,
    held_forces,
    positive_step,
    raise_if_refused,
    sample_times,
    vector,
    vectors,
)
from harness.engines.expressed import express, refusal
from harness.engines.march import march
from harness.engines.printed_terms import (
    SLIPS,
    Pendulum,
    Slip,
    State,
    Terms,
    flexible_as_printed,
    rigid_as_printed,
    slips,
)
from harness.engines.protocol import Array, EngineError
from harness.engines.small_motion import NEUTRAL, jacobian
from harness.errors import InputError, UnsupportedError
from harness.system import Joint, Link, System, Trajectory
from harness.system.inertia import about_origin
from harness.system.suggest import did_you_mean

# Directions and moments this far (relative) from what the paper's pendulum has are another mechanism.
LIKE = 1e-9


@dataclass(frozen=True, eq=False)
class PrintedModel:
    """The printed equations of one pendulum; see ``EngineModel``.

    pendulum: the paper's symbols. chosen: slips that are mended. gravity_across, gravity_along: g across and along the link
    at a joint position [m/s²], of which the first is the paper's g cosθ, the second g sinθ. side: 1 where the link bends along
    increasing θ, else −1.
    """

    names: tuple[str, ...]
    link: str
    pendulum: Pendulum
    printed: Callable[[Pendulum, State], Terms]
    chosen: tuple[Slip, ...]
    gravity_across: Callable[[float], float]
    gravity_along: Callable[[float], float]
    side: float

    def _state(self, q: Array, qd: Array) -> State:
        bent = len(q) > 1
        return State(
            self.gravity_across(float(q[0])),
            self.gravity_along(float(q[0])),
            float(qd[0]),
            self.side * float(q[1]) if bent else 0.0,
            self.side * float(qd[1]) if bent else 0.0,
        )

    def terms(self, q: Array, qd: Array) -> Terms:
        """Every term of the equations at a state, in the paper's signs."""
        state = self._state(q, qd)
        found = self.printed(self.pendulum, state)
        for slip in self.chosen:
            found = found + slip.mend(self.pendulum, state)
        return found

    def mends(self, q: Array, qd: Array, qdd: Array) -> dict[str, Array]:
        """What each mended slip adds to the left-hand side at a state, by its name, each shape (n,)."""
        state = self._state(q, qd)
        turned = self._signs * qdd
        return {slip.name: self._signs * slip.mend(self.pendulum, state).force(turned) for slip in self.chosen}

    @property
    def _signs(self) -> Array:
        # The paper's b is ours or its opposite; rows and columns of b change sign together.
        return np.array([1.0, self.side])[: len(self.names)]

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        q, qd, tau = vectors(len(self.names), q=q, qd=qd, tau=tau)
        found, signs = self.terms(q, qd), self._signs
        right = signs * tau - found.coriolis - found.gravity - found.passive
        if not np.any(found.quadratic):
            return finite_result("as_printed", "forward_dynamics", signs * np.linalg.solve(found.mass, right))
        # The root that is −h/M where the square is small; the other one is no motion that starts from rest without force.
        a, b, c = float(found.quadratic[0]), float(found.mass[0, 0]), -float(right[0])
        inside = b * b - 4.0 * a * c
        if inside < 0.0:
            raise EngineError(
                f"the printed equation (7) has no real acceleration at {self.names[0]} = {q[0]:.6g} rad: it is quadratic in θ̈"
            )
        return np.array([-2.0 * c / (b + np.sqrt(inside))])

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        q, qd, qdd = vectors(len(self.names), q=q, qd=qd, qdd=qdd)
        return np.asarray(self._signs * self.terms(q, qd).force(self._signs * qdd))

    def mass_matrix(self, q: Array) -> Array:
        """As printed, hence not symmetric where eq. (10) is not; UnsupportedError where eq. (7) squares the acceleration."""
        q = vector("q", q, len(self.names))
        found = self.terms(q, np.zeros_like(q))
        if np.any(found.quadratic):
            raise UnsupportedError("the printed equation (7) is quadratic in the acceleration and has no mass matrix")
        return np.asarray(found.mass * np.outer(self._signs, self._signs))

    def bias(self, q: Array, qd: Array) -> Array:
        q, qd = vectors(len(self.names), q=q, qd=qd)
        found = self.terms(q, qd)
        return np.asarray(self._signs * (found.coriolis + found.gravity))

    def gravity(self, q: Array) -> Array:
        q = vector("q", q, len(self.names))
        return np.asarray(self._signs * self.terms(q, np.zeros_like(q)).gravity)

    def energy(self, q: Array, qd: Array) -> NoReturn:
        raise UnsupportedError("the printed equations keep no energy: their inertia matrix is not symmetric")

    def simulate(
        self, q0: Array, qd0: Array, time: Array, *, tau: Array | None = None, step: float | None = None
    ) -> Trajectory:
        """Adaptive (DOP853), or RK4 at ``step``; EngineError where the equations have no solution any more."""
        q0, qd0 = vectors(len(self.names), q0=q0, qd0=qd0)
        time = sample_times(time)
        position, velocity = march(
            self.forward_dynamics,
            q0,
            qd0,
            time,
            held_forces(tau, time.size, q0.size),
            positive_step(step),
            rtol=1e-10,
            atol=1e-12,
        )
        channels = {}
        if q0.size > 1:
            channels[f"{self.link}.tip_deflection"] = self.pendulum.S3 * position[:, 1]
        return Trajectory(time, self.names, position, velocity, channels, method="DOP853" if step is None else "RK4")

    def frequencies(self, q: Array) -> Array:
        q = vector("q", q, len(self.names))
        still = np.zeros_like(q)
        slope = jacobian(lambda at: self.forward_dynamics(at, still, still), q)
        squares = np.linalg.eigvals(-slope)
        floor = NEUTRAL * float(np.max(np.abs(squares), initial=0.0))
        steady = np.real(squares[(np.abs(np.imag(squares)) <= floor) & (np.real(squares) > floor)])
        return np.sort(np.sqrt(steady)) / (2.0 * np.pi)


@dataclass(frozen=True)
class AsPrinted:
    """The printed equations as an ``Engine``: (7) for a rigid link, (10) for one that bends in one mode.

    mended: names of misprints (``printed_terms.SLIPS``) put right; "all" for every one.
    """

    mended: tuple[str, ...] = ()
    name: str = "as_printed"

    def __post_init__(self) -> None:
        known = {slip.name for slip in SLIPS} | {"all"}
        for name in self.mended:
            if name not in known:
                raise InputError(f"no misprint is named {name!r}", mend=did_you_mean(name, sorted(known)))

    def version(self) -> str:
        return f"equations (7) and (10), scipy {scipy.__version__}"

    def refuses(self, system: System) -> str | None:
        if system.loops:
            return "the printed equations have no loops"
        if not system.simple:
            return "the printed equations have joints of one independent degree of freedom each alone"
        reason = refusal("the printed equation", system, forces=False)
        if reason:
            return reason
        system = express(system).system
        if len(system.joints) != 1 or not system.joints[0].movable or system.joints[0].prismatic:
            return "the printed equations are of one link on one hinge"
        joint, link = system.joints[0], system.links[0]
        if joint.friction or joint.stiffness:
            return "the printed equations have neither dry friction nor a spring"
        if link.beam is not None:
            beam = link.beam
            if beam.modes != 1 or beam.bending2 or beam.torsion_modes:
                return f"equation (10) is of one mode in one plane, {link.name} has {beam.coordinates}"
            if abs(abs(float(np.cross(beam.direction, beam.bending) @ joint.axis)) - 1.0) > LIKE:
                return f"{link.name} bends out of the plane it swings in"
            return None
        tip = tip_of(link, system)
        length = float(np.linalg.norm(tip))
        if length == 0.0:
            return f"{link.name} is balanced on its hinge"
        if abs(float(tip @ joint.axis)) > LIKE * length:
            return f"{link.name} is not at right angles to its axis"
        payload, inertia = _rigid_parts(joint, link, length)
        if payload < -LIKE * link.mass or abs(inertia) > 1e-6 * link.mass * length**2:
            return f"{link.name} is not a uniform bar with a mass at its tip"
        return None

    def build(self, system: System) -> PrintedModel:
        """The paper's symbols read off the system; raises UnsupportedError if the system is refused."""
        raise_if_refused(system, self.refuses(system))
        system = express(system).system
        joint, link = system.joints[0], system.links[0]
        equation = 7 if link.beam is None else 10
        known = slips(equation)
        chosen = tuple(slip for slip in known if self.mended == ("all",) or slip.name in self.mended)
        axis = joint.rotation @ joint.axis
        direction = joint.rotation @ (link.beam.direction if link.beam else _unit(tip_of(link, system)))
        ahead = np.cross(axis, direction)
        g_along, g_ahead = float(system.gravity @ direction), float(system.gravity @ ahead)
        side = 1.0
        if link.beam is None:
            length = float(np.linalg.norm(tip_of(link, system)))
            payload = max(_rigid_parts(joint, link, length)[0], 0.0)
            rho = (link.mass - payload) / length
            pendulum = Pendulum(rho, length, payload, joint.armature, joint.damping)
        else:
            data = beam_data(system, link.name)
            assert data.plane[0] == BENDING
            side = float(np.sign((joint.rotation @ link.beam.bending) @ ahead))
            pendulum = Pendulum(
                data.rho,
                data.length,
                data.payload,
                joint.armature,
                joint.damping,
                *(float(value.ravel()[0]) for value in (data.S0, data.S1, data.S2, data.S3, data.K, data.C)),
            )
        return PrintedModel(
            names=system.coordinate_names,
            link=link.name,
            pendulum=pendulum,
            printed=rigid_as_printed if link.beam is None else flexible_as_printed,
            chosen=chosen,
            gravity_across=lambda q: g_ahead * np.cos(q) - g_along * np.sin(q),
            gravity_along=lambda q: g_along * np.cos(q) + g_ahead * np.sin(q),
            side=side,
        )


def _rigid_parts(joint: Joint, link: Link, length: float) -> tuple[float, float]:
    """Mass at the tip [kg] of a bar of that length with the link's centre of mass, and what its inertia then lacks [kg·m²]."""
    payload = 2.0 * link.mass * float(np.linalg.norm(link.com)) / length - link.mass
    inertia = float(joint.axis @ about_origin(link) @ joint.axis)
    return payload, inertia - (link.mass - payload) * length**2 / 3.0 - payload * length**2


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))
