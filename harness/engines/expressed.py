"""The effects attached to a system, split into what its description says by itself and joint laws left to the engines.

Effects of sensors and inputs act outside the engines (on predicted channels, on efforts before they are handed over) and
are passed over here.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from harness.effects.attach import apply, input_part
from harness.effects.catalogue import effect
from harness.effects.directions import sideways
from harness.engines.protocol import Array
from harness.errors import InputError
from harness.system import Attachment, System

# Joint laws that are a function of position and velocity, so that any engine can be handed them as a force.
FORCES = (
    "quadratic_drag",
    "polynomial_damping",
    "cubic_stiffness",
    "polynomial_stiffness",
    "constant_torque",
    "cogging_torque",
    "end_stop",
    "backlash",
)

# What makes a joint's dry friction or its stop a soft constraint.
CONSTRAINTS = ("friction_softness", "stop_inertia")


@dataclass(frozen=True, eq=False)
class Drives:
    """Drives with feedback, d of them, any number at a joint: offset − stiffness · q − damping · q̇, within a range each.

    place: the joint of each, (d,). offset, stiffness, damping, lower, upper: (d,). least, greatest: of all drives of a joint
    together [N·m], (n,).
    """

    place: NDArray[np.intp]
    offset: Array
    stiffness: Array
    damping: Array
    lower: Array
    upper: Array
    least: Array
    greatest: Array

    def __call__(self, q: Array, qd: Array) -> Array:
        """Generalized forces, shape (n,)."""
        each = self.offset - self.stiffness * q[self.place] - self.damping * qd[self.place]
        each = np.minimum(np.maximum(each, self.lower), self.upper)
        total = np.bincount(self.place, each, minlength=len(self.least))
        return np.minimum(np.maximum(total, self.least), self.greatest)


@dataclass(frozen=True, eq=False)
class JointForces:
    """Joint laws of position and velocity, each array of shape (n,) in the order of the joints' velocities, zero where absent.

    drag [N·m·s²/rad²], thick (damping over the cube of the velocity) [N·m·s³/rad³], cubic [N·m/rad³], square [N·m/rad²] and cube
    [N·m/rad³] of a polynomial spring and where that is slack [rad], constant [N·m], cogging amplitude [N·m], periods [1/rev] and
    phase [rad], stop angle [rad], stiffness [N·m/rad] and damping [N·m·s/rad]; whole gap [rad] of teeth, their stiffness and
    damping; drives: those with feedback, or None.
    """

    drag: Array
    thick: Array
    cubic: Array
    square: Array
    cube: Array
    slack: Array
    constant: Array
    cogging_amplitude: Array
    cogging_periods: Array
    cogging_phase: Array
    stop_angle: Array
    stop_stiffness: Array
    stop_damping: Array
    teeth_gap: Array
    teeth_stiffness: Array
    teeth_damping: Array
    drives: Drives | None = None

    @property
    def any(self) -> bool:
        regular = ("drag", "thick", "cubic", "square", "cube", "constant")
        return any(np.any(getattr(self, name)) for name in regular) or self.irregular

    @property
    def irregular(self) -> bool:
        """Whether there is more than polynomials of position and velocity: cogging, a stop, teeth with play or a drive."""
        kinds = (self.cogging_amplitude, self.stop_stiffness, self.stop_damping, self.teeth_stiffness)
        return self.drives is not None or any(bool(np.any(kind)) for kind in kinds)

    def __call__(self, q: Array, qd: Array) -> Array:
        """Generalized forces on the right-hand side, shape (n,)."""
        return self.polynomial(q, qd) + self.rest(q, qd)

    def without_stops(self, joints: Collection[str], names: Sequence[str]) -> JointForces:
        """The same without the stops of some joints; names: of all joints, in their order."""
        kept = np.array([float(name not in joints) for name in names])
        return replace(self, stop_stiffness=kept * self.stop_stiffness, stop_damping=kept * self.stop_damping)

    def polynomial(self, q: Array, qd: Array) -> Array:
        """Drag, springs and damping beyond linear, and constant torques, shape (n,)."""
        x = q - self.slack
        spring = self.cubic * q**3 + (self.square + self.cube * x) * x**2
        return np.asarray(self.constant - self.drag * qd * np.abs(qd) - self.thick * qd**3 - spring)

    def potential(self, q: Array) -> float:
        """Energy of the springs beyond linear [J]."""
        x = q - self.slack
        return float(np.sum(self.cubic * q**4 / 4.0 + self.square * x**3 / 3.0 + self.cube * x**4 / 4.0))

    @cached_property
    def _acting(self) -> tuple[Callable[[Array, Array], Array], ...]:
        """Of what ``rest`` adds up, what there is: engines ask for it at every stage of every step."""
        kinds: list[tuple[object, Callable[[Array, Array], Array]]] = [
            (np.any(self.cogging_amplitude), self._cogging),
            (np.any(self.stop_stiffness) or np.any(self.stop_damping), self._stops),
            (np.any(self.teeth_stiffness), self._teeth),
        ]
        acting = [kind for there, kind in kinds if there]
        return (*acting, self.drives) if self.drives is not None else tuple(acting)

    def rest(self, q: Array, qd: Array) -> Array:
        """Cogging, end stops, teeth and drives, shape (n,) or (T, n). A stop or a tooth pushes and never pulls."""
        total = np.zeros(np.shape(q))
        for kind in self._acting:
            total += kind(q, qd)
        return total

    def _cogging(self, q: Array, qd: Array) -> Array:
        return np.asarray(self.cogging_amplitude * np.sin(self.cogging_periods * q + self.cogging_phase))

    def _stops(self, q: Array, qd: Array) -> Array:
        side = np.where(self.stop_angle < 0.0, -1.0, 1.0)
        depth = side * (q - self.stop_angle)
        contact = np.maximum(self.stop_stiffness * depth + self.stop_damping * side * qd, 0.0)
        return np.where(depth > 0.0, -side * contact, 0.0)

    def _teeth(self, q: Array, qd: Array) -> Array:
        """Nothing within half the gap either way, beyond it a spring and a damper, shape (n,)."""
        half = 0.5 * self.teeth_gap
        beyond = np.maximum(np.abs(q) - half, 0.0)
        # Damping sets in over half a hundredth of half the gap: no jump for an integrator to stumble over.
        share = np.minimum(beyond / np.maximum(0.005 * half, 1e-6), 1.0)
        push = self.teeth_stiffness * beyond + self.teeth_damping * share * np.sign(q) * qd
        return np.asarray(-np.sign(q) * np.maximum(push, 0.0))


@dataclass(frozen=True)
class Shaking:
    """Acceleration of the base: amplitude [m/s²] · sin(2π frequency [Hz] · t + phase [rad]), t from the first sample."""

    direction: tuple[float, float, float]
    amplitude: float
    frequency: float
    phase: float

    def __call__(self, time: float) -> Array:
        """Acceleration of the base [m/s²] in base coordinates, shape (3,)."""
        size = self.amplitude * np.sin(2.0 * np.pi * self.frequency * time + self.phase)
        return size * np.array(self.direction)


@dataclass(frozen=True, eq=False)
class Expressed:
    """A system as an engine meets it.

    system: every effect that its description has words for written into it, no attachments left. forces, shaking: joint
    laws and the moving base. laws: all attachments that act as laws of joints or base, those of ``forces`` and
    ``shaking`` included. beyond: those that are neither, and need an engine with that law built in.
    """

    system: System
    forces: JointForces
    shaking: Shaking | None
    laws: tuple[Attachment, ...]
    beyond: tuple[Attachment, ...]

    def refusal(
        self,
        engine: str,
        *,
        forces: bool = True,
        shaking: bool = False,
        constraints: bool = False,
        compensation: bool = False,
    ) -> str | None:
        """Why an engine that takes forces, a shaking base, soft constraints, carried weight (or not) cannot express the system."""
        lifted = next((link.name for link in self.system.links if link.gravcomp), None)
        if lifted is not None and not compensation:
            return f"{engine} cannot express the gravity compensation of single links, that of {lifted} first"
        if self.system.gimbals:
            return f"{engine} does not know joints that are one in space together, {self.system.gimbals[0].name} first"
        commanded = next((drive.name for drive in self.system.drives if drive.gain), None)
        if commanded is not None:
            return f"{engine} keeps no recorded command within the range of force of actuator {commanded}"
        if self.system.drives and not forces:
            return f"{engine} cannot express the actuator {self.system.drives[0].name}"
        if self.system.stops and not constraints:
            return f"{engine} cannot express limits of joints, that of {self.system.stops[0].joint} first"
        for attachment in self.laws:
            can = attachment.effect in FORCES if attachment not in self.beyond else False
            if attachment.effect == "base_excitation":
                if not shaking:
                    return f"{engine} cannot express the effect base_excitation"
            elif constraints and attachment.effect in CONSTRAINTS:
                continue
            elif not (can and forces):
                return f"{engine} cannot express the effect {attachment.effect} at {attachment.site}"
        return None


def express(system: System) -> Expressed:
    """Split the system's effects; InputError for an effect, site or parameter that does not exist."""
    plain = replace(system, attachments=())
    for attachment in system.attachments:
        if attachment.effect == "backlash" and "stiffness" in attachment.parameters:
            # The law of the play itself, as the drive side left it; there is nothing more to write into the system.
            plain = replace(plain, attachments=(*plain.attachments, attachment))
        elif effect(attachment.effect).in_mechanism:
            plain = apply(plain, attachment)
    laws, plain = tuple(a for a in plain.attachments if effect(a.effect).in_mechanism), replace(plain, attachments=())
    names = tuple(name for joint in plain.joints for name in joint.velocity_names)
    table = {name: np.zeros(len(names)) for name in JointForces.__dataclass_fields__ if name != "drives"}
    shaking = None
    beyond = []
    for law in laws:
        values = dict(law.parameters)
        if law.effect == "base_excitation":
            x, y, z = sideways(plain)
            shaking = Shaking((x, y, z), values["amplitude"], values["frequency"], values["phase"])
        elif law.effect in FORCES and law.site in names and law.site in plain.joint_names:
            k = names.index(law.site)
            for name, parameter in _PLACES[law.effect].items():
                # Two laws of a joint may share a term: drag is one of the polynomial's. Only one states where it is slack.
                table[name][k] += values[parameter]
        else:
            beyond.append(law)
    return Expressed(plain, JointForces(**table, drives=_drives(plain, names)), shaking, laws, tuple(beyond))


def _drives(system: System, names: Sequence[str]) -> Drives | None:
    """The drives that act, in the order of joints ``names``; those of joints that follow others are none of them."""
    acting = [drive for drive in system.drives if drive.joint in names]
    if not acting:
        return None
    least, greatest = np.full(len(names), -np.inf), np.full(len(names), np.inf)
    for drive in acting:
        k = names.index(drive.joint)
        least[k], greatest[k] = drive.together

    def column(name: str) -> Array:
        return np.array([getattr(drive, name) for drive in acting], dtype=np.float64)

    return Drives(
        place=np.array([names.index(drive.joint) for drive in acting], dtype=np.intp),
        offset=column("offset"),
        stiffness=column("stiffness"),
        damping=column("damping"),
        lower=column("lower"),
        upper=column("upper"),
        least=least,
        greatest=greatest,
    )


def realised(system: System) -> System:
    """The system with every effect of the dynamics in it: as description where that has words, else as attached law.

    Effects of sensors and inputs are left out. Raises InputError for an effect, site or parameter that does not exist.
    """
    found = express(system)
    return replace(found.system, attachments=found.laws)


def described(system: System) -> System:
    """The system with its effects turned into fields of the description where there are such, all others attached."""
    found = realised(system)
    outside = tuple(input_part(a) for a in system.attachments if effect(a.effect).side != "dynamics")
    return replace(found, attachments=(*found.attachments, *outside))


def bends(system: System) -> bool:
    """Whether the system has elastic links, its own or by an effect attached to it."""
    try:
        return express(system).system.flexible
    except InputError:  # said by ``refusal``
        return system.flexible


def refusal(
    engine: str,
    system: System,
    *,
    forces: bool = True,
    shaking: bool = False,
    constraints: bool = False,
    compensation: bool = False,
) -> str | None:
    """Why an engine cannot express the system's effects, or None; a wrong effect is a reason too."""
    try:
        found = express(system)
        return found.refusal(engine, forces=forces, shaking=shaking, constraints=constraints, compensation=compensation)
    except InputError as error:
        return str(error)


_PLACES = {
    "quadratic_drag": {"drag": "coefficient"},
    "polynomial_damping": {"drag": "quadratic", "thick": "cubic"},
    "polynomial_stiffness": {"square": "quadratic", "cube": "cubic", "slack": "rest_angle"},
    "cubic_stiffness": {"cubic": "stiffness"},
    "constant_torque": {"constant": "torque"},
    "cogging_torque": {"cogging_amplitude": "amplitude", "cogging_periods": "periods", "cogging_phase": "phase"},
    "backlash": {"teeth_gap": "gap", "teeth_stiffness": "stiffness", "teeth_damping": "damping"},
    "end_stop": {"stop_angle": "angle", "stop_stiffness": "stiffness", "stop_damping": "damping"},
}
