"""What a mechanism is: links and joints of a tree on a base, immutable.

Units are SI. Frames and signs, once for the whole project:

- Every link has a *link frame*; it coincides with the frame of the joint that carries the link.
- ``Joint.xyz`` and ``Joint.rotation`` place the joint frame in the parent's link frame at zero joint position;
  ``rotation`` maps coordinates in the joint frame to coordinates in the parent frame.
- A positive joint position turns (or shifts) the child about (along) ``axis``, given in the joint frame, right-handed.
- Joints of several degrees of freedom have positions (nq) and velocities (nv), in the order of ``Joint.position_names`` and
  ``Joint.velocity_names``. A rotation in space is a unit quaternion (w, x, y, z) that maps the child's axes to the joint
  frame's, its velocity the child's angular velocity relative to the parent in the *child's* axes; a shift in space, and its
  velocity, are in the axes of the *joint frame*. These are MuJoCo's conventions.
- ``gravity`` is the acceleration of free fall in base coordinates, (0, 0, -9.81) by default.
- Inertia tensors are taken about the centre of mass, in axes parallel to the link frame.
- A joint on a flexible link rides on the beam's cross-section at the station nearest to the joint's origin
  (station = origin · direction, within 0 and length); what is left of the origin is a rigid offset from that section.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.notebook import html_table
from harness.system.loop import Coupling, Loop

Array = NDArray[np.float64]

STANDARD_GRAVITY = (0.0, 0.0, -9.81)


def constant(value: object) -> Array:
    """A float array that cannot be written to."""
    array = np.array(value, dtype=np.float64)
    array.setflags(write=False)
    return array


class JointType(StrEnum):
    """Kinds of joint that the native dynamics models."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"
    HELICAL = "helical"
    UNIVERSAL = "universal"
    PLANAR = "planar"
    BALL = "ball"
    FREE = "free"


# Of joints with several degrees of freedom: endings of the names of their positions and velocities.
_QUATERNION = ("qw", "qx", "qy", "qz")
_SPIN = ("wx", "wy", "wz")
_SEVERAL: dict[JointType, tuple[tuple[str, ...], tuple[str, ...]]] = {
    JointType.UNIVERSAL: (("angle1", "angle2"), ("angle1", "angle2")),
    JointType.PLANAR: (("x", "y", "angle"), ("x", "y", "angle")),
    JointType.BALL: (_QUATERNION, _SPIN),
    JointType.FREE: (("x", "y", "z", *_QUATERNION), ("vx", "vy", "vz", *_SPIN)),
}


@dataclass(frozen=True)
class Mimic:
    """A joint of one degree of freedom that follows another: position = multiplier · position of ``joint`` + offset.

    multiplier: [1, or the followers' unit over the leader's]; offset: [rad or m].
    """

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint that carries ``child`` on ``parent``.

    xyz: origin of the joint frame in the parent's link frame [m], shape (3,).
    rotation: joint frame to parent frame, shape (3, 3).
    axis: unit axis in the joint frame, shape (3,).
    armature: inertia added about (mass along) the axis [kg·m² or kg]; the paper's hub inertia I_h.
    damping: viscous coefficient [N·m·s/rad or N·s/m]; the paper's ξ.
    friction: dry friction, truly sticking [N·m or N].
    stiffness, rest_position: linear spring [N·m/rad or N/m] and where it is slack [rad or m].
    lower, upper: limits of position [rad or m]; recorded; they act where ``System.stops`` says so.
    effort, velocity: limits as stated by the model file; recorded, not enforced.
    axis2: second axis of a universal joint, in the joint frame at zero position; it turns with the first, shape (3,).
    pitch: of a helical joint, the shift along its axis for a turn of one radian [m/rad].
    mimic: the joint that this one follows, where it is not independent.
    A planar joint's ``axis`` is the normal of its plane. Ball and free joints have no axis, stiffness or friction.
    """

    name: str
    type: JointType
    parent: str
    child: str
    xyz: Array = field(default_factory=lambda: constant(np.zeros(3)))
    rotation: Array = field(default_factory=lambda: constant(np.eye(3)))
    axis: Array = field(default_factory=lambda: constant([0.0, 0.0, 1.0]))
    armature: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    stiffness: float = 0.0
    rest_position: float = 0.0
    lower: float = -np.inf
    upper: float = np.inf
    effort: float = np.inf
    velocity: float = np.inf
    axis2: Array = field(default_factory=lambda: constant([0.0, 1.0, 0.0]))
    pitch: float = 0.0
    mimic: Mimic | None = None

    @property
    def movable(self) -> bool:
        """Whether the joint's child moves against its parent."""
        return self.type is not JointType.FIXED

    @property
    def position_names(self) -> tuple[str, ...]:
        """Names of the joint's own positions (nq); none where it mimics another."""
        return self._own_names(0)

    @property
    def velocity_names(self) -> tuple[str, ...]:
        """Names of the joint's own velocities (nv), accelerations and generalized forces; none where it mimics another."""
        return self._own_names(1)

    def _own_names(self, which: int) -> tuple[str, ...]:
        """Of positions (0) or of velocities (1)."""
        if not self.movable or self.mimic is not None:
            return ()
        endings = _SEVERAL.get(self.type)
        return (self.name,) if endings is None else tuple(f"{self.name}.{ending}" for ending in endings[which])

    @property
    def turns_in_space(self) -> bool:
        """Whether a quaternion is among its positions."""
        return self.type in (JointType.BALL, JointType.FREE)

    @property
    def simple(self) -> bool:
        """Whether it is one of the joints of one independent degree of freedom, or fixed, that everything knows."""
        return self.type in _SIMPLE and self.mimic is None

    @property
    def prismatic(self) -> bool:
        return self.type is JointType.PRISMATIC

    @property
    def position_unit(self) -> str:
        return "m" if self.prismatic else "rad"

    @property
    def force_unit(self) -> str:
        """Of generalized forces at the joint."""
        return "N" if self.prismatic else "N*m"


_SIMPLE = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC, JointType.FIXED)


@dataclass(frozen=True, eq=False)
class Beam:
    """The elastic part of a flexible link: a slender Euler-Bernoulli beam from the link's origin to its tip.

    length: l [m].
    direction: unit vector from joint to tip, undeformed, in the link frame, shape (3,).
    bending: unit vector of positive deflection, orthogonal to ``direction``, shape (3,).
    mass: of the beam alone [kg]; mass per length ρ = mass / length, uniform.
    bending_stiffness: EI for deflection along ``bending`` [N·m²].
    bending_stiffness2: EI for deflection along direction × bending [N·m²]; used if ``bending2``.
    bending2: whether the second plane bends too.
    torsional_stiffness, polar_inertia: GJ [N·m²] and ρ I_p per length [kg·m], used if ``torsion_modes`` > 0.
    half_depth: distance from the neutral axis to the root surface where a gauge reads strain [m]; nan if unknown.
    material_damping: Kelvin-Voigt [s]: stress = E (strain + damping · strain rate).
    modes: number of modes in each bending plane.
    torsion_modes: number of torsion modes.
    modal_damping: ratios of the modes of the link as mounted, shape (k,), k ≤ modes; added to the material damping.
    geometric_stiffening: whether foreshortening (second-order axial displacement) is kept.
    payload: point mass at the tip [kg]; the paper's m_p.
    payload_inertia: inertia of the payload about the tip, in link axes [kg·m²], shape (3, 3).
    shapes: "auto", "clamped_free", "tip_mass", "hub" (pinned with hub inertia) or "samples".
    shape_samples: user shapes for "samples": first column the station in [0, 1], then one column a mode,
        shape (p, 1 + modes).
    """

    length: float
    direction: Array
    bending: Array
    mass: float
    bending_stiffness: float
    bending_stiffness2: float = 0.0
    bending2: bool = False
    torsional_stiffness: float = 0.0
    polar_inertia: float = 0.0
    half_depth: float = float("nan")
    material_damping: float = 0.0
    modes: int = 1
    torsion_modes: int = 0
    modal_damping: tuple[float, ...] = ()
    geometric_stiffening: bool = True
    payload: float = 0.0
    payload_inertia: Array = field(default_factory=lambda: constant(np.zeros((3, 3))))
    shapes: str = "auto"
    shape_samples: Array | None = None
    # Factors on the stiffness of single bending modes beyond what EI gives them, (k,), k ≤ modes; 1 where not given.
    mode_stiffness: tuple[float, ...] = ()
    # What the table said, kept for `audit` and for writing the file back; nan where the file gave EI and mass outright.
    width: float = float("nan")
    thickness: float = float("nan")
    youngs_modulus: float = float("nan")
    density: float = float("nan")

    @property
    def coordinates(self) -> int:
        """Number of elastic coordinates m of the link."""
        return self.modes * (2 if self.bending2 else 1) + self.torsion_modes


@dataclass(frozen=True, eq=False)
class Link:
    """A body: rigid, or flexible if it has a ``beam``.

    mass, com, inertia: of the whole link undeformed (beam and payload included if flexible)
        [kg], [m] shape (3,), [kg·m²] about the centre of mass shape (3, 3).
    gravcomp: share of its weight that an upward force at its centre of mass carries (MuJoCo's ``gravcomp``).
    end: where a rigid link ends, in its own frame [m] shape (3,); if None, at its farthest joint, or as a rod with a bob that has
        its mass, centre and inertia would.
    """

    name: str
    mass: float = 0.0
    com: Array = field(default_factory=lambda: constant(np.zeros(3)))
    inertia: Array = field(default_factory=lambda: constant(np.zeros((3, 3))))
    beam: Beam | None = None
    end: Array | None = None
    gravcomp: float = 0.0

    @property
    def flexible(self) -> bool:
        return self.beam is not None


@dataclass(frozen=True, eq=False)
class Attachment:
    """An effect of the catalogue that the system has, as a model file states it.

    effect: name in the catalogue; site: joint, link, channel or ``base``; parameters: SI values by name;
    std: standard deviations by parameter name, where known.
    """

    effect: str
    site: str
    parameters: Mapping[str, float] = field(default_factory=dict)
    std: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Actuator:
    """A drive with feedback of its own, as an MJCF states it; it acts in single runs and in a diagnosis, never in a comparison.

    Force at ``joint``: offset + (gain + gain_position · position + gain_velocity · velocity) · command − stiffness · position
    − damping · velocity, within lower and upper [N·m or N].
    stiffness, damping: at the joint, gear included. gain and its slopes: per unit of the command, kept within ``commands``.
    together: least and greatest force of all actuators of the joint together [N·m or N].
    gear: that all of them include. note: the line of ``System.notes`` that says what it does by itself, if there is one.
    """

    name: str
    joint: str
    gain: float = 0.0
    offset: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    lower: float = -np.inf
    upper: float = np.inf
    commands: tuple[float, float] = (-np.inf, np.inf)
    together: tuple[float, float] = (-np.inf, np.inf)
    gain_position: float = 0.0
    gain_velocity: float = 0.0
    gear: float = 1.0
    note: str = ""

    @property
    def varying(self) -> bool:
        """Whether what a command gives depends on where the joint is, or how fast."""
        return bool(self.gain_position or self.gain_velocity)

    @property
    def has_feedback(self) -> bool:
        """Whether its force depends on the position or the velocity without a command."""
        return bool(self.stiffness or self.damping)

    def commanded(self, command: float) -> Actuator:
        """The same under a command that is held (kept within ``commands``), as one that takes none."""
        held = min(max(command, self.commands[0]), self.commands[1])
        return replace(
            self,
            offset=self.offset + self.gain * held,
            stiffness=self.stiffness - self.gain_position * held,
            damping=self.damping - self.gain_velocity * held,
            gain=0.0,
            gain_position=0.0,
            gain_velocity=0.0,
        )

    def feedback_in_words(self) -> str:
        """What it does without a command; empty if nothing."""
        slopes = ((-self.stiffness, "position"), (-self.damping, "velocity"))
        parts = [f"{self.offset:+.4g}"] * bool(self.offset) + [f"{slope:+.4g} · {of}" for slope, of in slopes if slope]
        lower, upper = max(self.lower, self.together[0]), min(self.upper, self.together[1])
        if parts and (np.isfinite(lower) or np.isfinite(upper)):
            parts.append(f"within {lower:.4g} … {upper:.4g}")
        return ", ".join(parts) + self._geared() if parts else ""

    def gain_in_words(self) -> str:
        """How what a command gives changes with the motion; empty if it does not."""
        slopes = ((self.gain_position, "position"), (self.gain_velocity, "velocity"))
        parts = [f"{slope:+.4g} · {of}" for slope, of in slopes if slope]
        return (
            f"a gain that changes with the motion, {self.gain:.4g} {', '.join(parts)}{self._geared()}" if parts else ""
        )

    def _geared(self) -> str:
        return "" if self.gear == 1.0 else f" (gear {self.gear:g} included)"


@dataclass(frozen=True, eq=False)
class Stops:
    """Both ends of a joint's range as soft constraints: beyond an end by δ they push with K δ + C δ̇ + J δ̈, and never pull.

    lower, upper [rad or m]; stiffness K [N·m/rad or N/m], damping C [N·m·s/rad or N·s/m], inertia J [kg·m² or kg].
    """

    joint: str
    lower: float
    upper: float
    stiffness: float
    damping: float
    inertia: float


@dataclass(frozen=True, eq=False)
class Gimbal:
    """Three joints that follow each other by massless links: the turns of a ball about x, y and z, or the slides of a free joint.

    name: by which what acts on all three goes. joint: that it was. child: the link that it carries. coordinates: the three joints.
    slides: whether they are slides. damping: of velocity or angular velocity as vectors [N·s/m or N·m·s/rad]; friction: dry
    [N or N·m].
    """

    name: str
    joint: str
    child: str
    coordinates: tuple[str, str, str]
    slides: bool
    damping: float = 0.0
    friction: float = 0.0

    def as_joint(self) -> Joint:
        """Damping, friction and units of the three together, by their name."""
        kind = JointType.PRISMATIC if self.slides else JointType.REVOLUTE
        return Joint(self.name, kind, "", self.child, damping=self.damping, friction=self.friction)


@dataclass(frozen=True, eq=False)
class Keyframe:
    """A state that a model file names: by position name and velocity name [rad or m, …], commands by actuator.

    notes: what of it a run does not begin with.
    """

    name: str
    position: Mapping[str, float]
    velocity: Mapping[str, float]
    command: Mapping[str, float]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class System:
    """A mechanism: a tree of joints on a base, which floats where its first joint is free, and the loops that close it.

    joints: in topological order (a joint's parent link is ``base`` or the child of an earlier joint).
    links: in the order of the joints that carry them; the base is not among them.
    loops: what joins links beside the tree's joints.
    gravity: free-fall acceleration in base coordinates [m/s²], shape (3,).
    tolerance: relative 1σ of the nominal masses, lengths, inertias and stiffnesses. tolerances: of single ones that are known
    better or worse, by ``kind@name`` (``armature@servo``).
    attachments: effects beyond the nominal physics.
    actuators: drives with feedback of their own as the file states them; drives: those that act, their command in their offset;
    servos: those that act as a spring and a damper that their joint has already.
    limits: how soft the joints' limits are where the file says so; stops: those that act. limits_act: whether the file lets limits
    act in single runs.
    keyframes: states that the file names, to start from.
    source: the file it was read from.
    notes: what reading the file left out or had to interpret, one line each.
    gimbals: joints of one degree of freedom that together are one in space, where that has been taken apart (``system.charted``).
    leading: coordinates that tell where a closed mechanism is, before others, as those do that are recorded.
    """

    name: str
    joints: tuple[Joint, ...]
    links: tuple[Link, ...]
    base: str = "base"
    gravity: Array = field(default_factory=lambda: constant(STANDARD_GRAVITY))
    tolerance: float = 0.01
    attachments: tuple[Attachment, ...] = ()
    actuators: tuple[Actuator, ...] = ()
    drives: tuple[Actuator, ...] = ()
    servos: tuple[Actuator, ...] = ()
    limits: tuple[Stops, ...] = ()
    stops: tuple[Stops, ...] = ()
    limits_act: bool = True
    keyframes: tuple[Keyframe, ...] = ()
    source: Path | None = None
    notes: tuple[str, ...] = ()
    loops: tuple[Loop | Coupling, ...] = ()
    gimbals: tuple[Gimbal, ...] = ()
    leading: tuple[str, ...] = ()
    tolerances: Mapping[str, float] = field(default_factory=dict)

    def __repr__(self) -> str:
        many, links = ("" if len(some) == 1 else "s" for some in (self.movable_joints, self.links))
        bending = sum(link.beam is not None for link in self.links)
        flexible = f", {bending} flexible" if bending else ""
        degrees = "" if self.simple else f", {self.nv} degrees of freedom"
        closed = f", {len(self.loops)} loop{'s' * (len(self.loops) > 1)}" if self.loops else ""
        return (
            f"<System {self.name!r}: {len(self.movable_joints)} movable joint{many}, {len(self.links)} link{links}"
            f"{flexible}{degrees}{closed}>"
        )

    def _repr_html_(self) -> str:
        """Joints and the links that they carry, for notebooks."""
        rows = [
            (joint.name, joint.type.value, joint.parent, joint.child, float(link.mass), joint.damping, joint.friction)
            for joint, link in zip(self.joints, self.links, strict=True)
        ]
        heads = ("joint", "type", "parent", "link", "mass [kg]", "damping", "friction")
        attached = "; ".join(f"{a.effect} at {a.site}" for a in self.attachments)
        return html_table(
            heads, rows, title=self.name, note="; ".join((*([attached] if attached else []), *self.notes))
        )

    @property
    def movable_joints(self) -> tuple[Joint, ...]:
        return tuple(joint for joint in self.joints if joint.movable)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Movable joints in the order of the joint coordinates."""
        return tuple(joint.name for joint in self.movable_joints)

    def servos_of(self, joint: str) -> tuple[Actuator, ...]:
        """The drives with feedback that act at a joint; none where one without feedback is there, too: efforts add up."""
        acting = tuple(d for d in (*self.servos, *self.drives) if d.joint == joint and d.has_feedback)
        return acting if all(a.has_feedback for a in self.actuators if a.joint == joint) else ()

    @property
    def coordinate_names(self) -> tuple[str, ...]:
        """Velocities (nv): each joint's, followed by those of the elastic coordinates ``<link>.mode<k>`` of its link.

        Where all joints have one degree of freedom these are the names of the generalized coordinates, positions and velocities.
        """
        return self._names("velocity_names")

    @property
    def position_names(self) -> tuple[str, ...]:
        """Positions (nq): each joint's, followed by the elastic coordinates ``<link>.mode<k>`` of its link."""
        return self._names("position_names")

    @property
    def nv(self) -> int:
        """Number of velocities, accelerations and generalized forces: of degrees of freedom."""
        return len(self.coordinate_names)

    @property
    def nq(self) -> int:
        """Number of positions: one more than velocities for each joint that turns in space."""
        return len(self.position_names)

    @property
    def simple(self) -> bool:
        """Whether every joint has one independent degree of freedom or none."""
        return all(joint.simple for joint in self.joints)

    def _names(self, which: str) -> tuple[str, ...]:
        names: list[str] = []
        for joint, link in zip(self.joints, self.links, strict=True):
            names += getattr(joint, which)
            if link.beam is not None:
                names += [f"{link.name}.mode{k + 1}" for k in range(link.beam.coordinates)]
        return tuple(names)

    @property
    def flexible(self) -> bool:
        return any(link.flexible for link in self.links)

    def joint(self, name: str) -> Joint:
        """The joint of that name, or what a gimbal or a cut of that name is as one; KeyError if there is none."""
        for joint in self.joints:
            if joint.name == name:
                return joint
        for gimbal in self.gimbals:
            if gimbal.name == name:
                return gimbal.as_joint()
        for loop in self.loops:
            if isinstance(loop, Loop) and loop.name == name:
                return Joint(name, JointType.REVOLUTE, loop.first.link, loop.second.link)
        raise KeyError(name)

    def gimbal_of(self, coordinate: str) -> Gimbal | None:
        """The gimbal that a joint is one of three of."""
        return next((gimbal for gimbal in self.gimbals if coordinate in gimbal.coordinates), None)

    def link(self, name: str) -> Link:
        """The link of that name; KeyError if there is none."""
        for link in self.links:
            if link.name == name:
                return link
        raise KeyError(name)

    def carrier(self, link_name: str) -> Joint:
        """The joint that carries the link of that name; KeyError if there is none."""
        for joint in self.joints:
            if joint.child == link_name:
                return joint
        raise KeyError(link_name)

    def replace_joint(self, joint: Joint) -> System:
        """The same system with the joint of that name replaced."""
        return replace(self, joints=tuple(joint if j.name == joint.name else j for j in self.joints))

    def replace_link(self, link: Link) -> System:
        """The same system with the link of that name replaced."""
        return replace(self, links=tuple(link if k.name == link.name else k for k in self.links))

    def rigid(self) -> System:
        """The same system with every beam frozen in its undeformed shape."""
        return replace(self, links=tuple(replace(link, beam=None) for link in self.links))
