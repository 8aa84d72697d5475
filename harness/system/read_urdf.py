"""Systems from URDF, as ROS means it: http://wiki.ros.org/urdf/XML."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from harness.errors import InputError, UnsupportedError
from harness.plain_numbers import plain_number
from harness.system.check import check_bodies, check_dynamics, check_mimics
from harness.system.description import Array, Joint, JointType, Link, Mimic, System, constant
from harness.system.magnitudes import NUMBER
from harness.system.names import check_names
from harness.system.rotation import from_quaternion, from_rpy
from harness.system.suggest import did_you_mean
from harness.system.topology import arrange
from harness.system.urdf_left_out import left_out
from harness.system.xml_source import prefix_and_name

# Limits this large [rad, m, N·m, …] stand for none, in files whose readers insist on a number.
NO_LIMIT = 1e9
_ONE_DEGREE = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC, JointType.FIXED)
# Of URDF's dialects (Drake's, SDFormat's): well formed elsewhere, and no joints of URDF.
_NOT_MODELLED = (
    "ball",
    "spherical",
    "universal",
    "cylindrical",
    "screw",
    "gearbox",
    "revolute2",
    "quaternion_floating",
    "rpy_floating",
)
# URDF's words to ours, where they differ; ours that URDF has not are unknown types in it.
_TYPES = {str(kind): kind for kind in _ONE_DEGREE} | {"planar": JointType.PLANAR, "floating": JointType.FREE}
# Names of the world and of the joint that a floating root gets: Pinocchio's name for the joint.
WORLD, ROOT_JOINT = "world", "root_joint"
# Rotations as quaternions came with this version of the format; urdfdom passes them over in files of an earlier one.
_QUATERNIONS_SINCE = (1, 1)
_VERSIONS = ((1, 0), (1, 1), (1, 2))


def read_urdf(
    root: Any,
    source: Path | None = None,
    *,
    tolerance: float | None = None,
    physical: bool = True,
    floating: bool = False,
) -> System:
    """A system from the root element of a URDF document.

    The root link is the fixed base, whose inertia moves nothing, or floats on a free joint. Geometry, materials,
    transmissions and simulator extensions are not read; what of them would act elsewhere is told in ``System.notes``.
    Raises InputError and UnsupportedError naming file, line, joint or link.
    """
    reader = _Reader(source, physical)
    reader.version(root)
    reader.refuse_foreign_joints(root)
    joints = [reader.joint(element) for element in root.findall("joint")]
    joints = reader.with_leaders(joints)
    links = [reader.link(element) for element in root.findall("link")]
    if not links:
        raise InputError("there is no <link>", mend="a robot has links and joints", source=source, line=root.sourceline)
    base = reader.base(joints, links)
    if floating:
        names = {link.name for link in links}, {joint.name for joint in joints}
        world, root_joint = (_unused(name, taken) for name, taken in zip((WORLD, ROOT_JOINT), names, strict=True))
        joints = [Joint(root_joint, JointType.FREE, world, base), *joints]
        links, base = [Link(world), *links], world
    for link in links:
        if link.name == base and link.mass > 0.0:
            reader.notes.append(f"link {base!r} is the fixed base; its inertia is left out")
    # A second link of the base's name stays in the list, for `arrange` to refuse it.
    rest = list(links)
    rest.remove(next(link for link in links if link.name == base))
    ordered_joints, ordered_links = arrange(joints, rest, base, source=source, lines=reader.lines)
    ordered_links, told = check_bodies(ordered_links, physical=physical, source=source, lines=reader.lines)
    notes = [*reader.notes, *told, *left_out(root, base)]
    system = System(
        name=root.get("name") or (source.stem if source is not None else "robot"),
        joints=ordered_joints,
        links=ordered_links,
        base=base,
        tolerance=0.01 if tolerance is None else tolerance,
        source=source,
        notes=tuple(notes),
    )
    check_names(system, reader.lines)
    check_mimics(system, reader.lines)
    check_dynamics(system, lines=reader.lines)
    return system


def _unused(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    return name


class _Reader:
    """Reads elements and collects notes and lines on the way."""

    def __init__(self, source: Path | None, physical: bool) -> None:
        self.source = source
        self.physical = physical
        self.notes: list[str] = []
        self.lines: dict[tuple[str, str], int] = {}
        self.quaternions = False

    def version(self, root: Any) -> None:
        """Which version of the format the file says it is, and so whether rotations may be quaternions."""
        text = root.get("version")
        if text is None:
            return
        try:
            major, minor = (int(word) for word in text.strip().split("."))
        except ValueError:
            self.notes.append(f"version {text!r} is no URDF version, which urdfdom refuses; read as 1.0")
            return
        if (major, minor) not in _VERSIONS:
            self.notes.append(f"version {text} is beyond 1.2, which urdfdom refuses; read as 1.2")
        self.quaternions = (major, minor) >= _QUATERNIONS_SINCE

    def refuse_foreign_joints(self, root: Any) -> None:
        """Refuse joints of another vocabulary (``drake:joint``) by name, before the links they carry are missed."""
        for element in root:
            prefix, name = prefix_and_name(element)
            if prefix and name == "joint":
                raise UnsupportedError(
                    f"joint {element.get('name')!r}: <{prefix}:joint> of type {element.get('type')!r} is not modelled",
                    mend="build it from revolute, prismatic and fixed joints",
                    source=self.source,
                    line=element.sourceline,
                )

    def refuse(self, element: Any, what: str, mend: str = "") -> NoReturn:
        raise InputError(what, mend=mend, source=self.source, line=element.sourceline)

    def name(self, element: Any) -> str:
        name = element.get("name")
        if not name:
            self.refuse(element, f"<{element.tag}> has no name", f'write <{element.tag} name="…">')
        self.lines[(element.tag, name)] = element.sourceline
        return str(name)

    def numbers(self, element: Any, key: str, size: int, default: Array | None, owner: str) -> Array:
        """``size`` finite numbers of an attribute."""
        text = element.get(key)
        if text is None:
            if default is None:
                self.refuse(element, f"{owner}: <{element.tag}> has no {key}", f'write {key}="…"')
            return default
        words = text.split()
        try:
            values = [plain_number(word) for word in words]
        except ValueError:
            self.refuse(element, f"{owner}: {key}={text!r} is not a number", "write plain decimal numbers in SI")
        if len(values) != size:
            self.refuse(element, f"{owner}: {key}={text!r} has {len(values)} value(s)", f"give {size}")
        if not all(math.isfinite(value) for value in values):
            self.refuse(element, f"{owner}: {key}={text!r} is not finite", "give a finite number")
        # Limits may be without end; of a place or a direction the square must not overflow.
        if size > 1 and any(abs(value) > NUMBER for value in values):
            self.refuse(
                element, f"{owner}: {key}={text!r} is beyond any mechanism", "check the numbers and their units"
            )
        return constant(values)

    def number(self, element: Any, key: str, default: float | None, owner: str) -> float:
        return float(self.numbers(element, key, 1, None if default is None else constant([default]), owner)[0])

    def origin(self, element: Any, owner: str) -> tuple[Array, Array]:
        origin = element.find("origin")
        if origin is None:
            return constant(np.zeros(3)), constant(np.eye(3))
        zero = constant(np.zeros(3))
        xyz = self.numbers(origin, "xyz", 3, zero, owner)
        if origin.get("quat_xyzw") is None:
            return xyz, constant(from_rpy(self.numbers(origin, "rpy", 3, zero, owner)))
        if not self.quaternions:
            self.notes.append(
                f"{owner}: quat_xyzw is left out, as urdfdom leaves it out where <robot> has no version 1.1 or later"
            )
            return xyz, constant(from_rpy(self.numbers(origin, "rpy", 3, zero, owner)))
        if origin.get("rpy") is not None:
            self.refuse(origin, f"{owner}: <origin> has both rpy and quat_xyzw", "give the one or the other")
        x, y, z, w = self.numbers(origin, "quat_xyzw", 4, None, owner)
        if math.hypot(x, y, z, w) < 1e-12:
            self.refuse(origin, f"{owner}: quat_xyzw is zero", 'the identity is quat_xyzw="0 0 0 1"')
        return xyz, constant(from_quaternion((w, x, y, z)))

    def link(self, element: Any) -> Link:
        name = self.name(element)
        owner = f"link {name!r}"
        inertial = element.find("inertial")
        if inertial is None:
            return Link(name)
        mass_element = inertial.find("mass")
        if mass_element is None:
            self.refuse(inertial, f"{owner}: <inertial> has no <mass>", 'add <mass value="…"/>')
        mass = self.number(mass_element, "value", None, owner)
        com, rotation = self.origin(inertial, owner)
        tensor = np.zeros((3, 3))
        inertia = inertial.find("inertia")
        if inertia is not None:
            xx, xy, xz, yy, yz, zz = (
                self.number(inertia, key, None if key[1] == key[2] else 0.0, owner)
                for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
            )
            if missing := [key for key in ("ixy", "ixz", "iyz") if inertia.get(key) is None]:
                self.notes.append(
                    f"{owner}: {', '.join(missing)} not given, taken as zero; other readers drop the whole inertia"
                )
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        elif mass > 0.0:
            self.notes.append(f"{owner}: no <inertia>, taken as a point mass")
        rotated = np.asarray(rotation) @ tensor @ np.asarray(rotation).T
        return Link(name, mass=mass, com=com, inertia=constant((rotated + rotated.T) / 2.0))

    def joint(self, element: Any) -> Joint:
        name = self.name(element)
        owner = f"joint {name!r}"
        kind = element.get("type")
        if kind is None:
            self.refuse(element, f"{owner} has no type", 'write type="revolute"')
        if kind in _NOT_MODELLED:
            raise UnsupportedError(
                f"{owner}: type {kind!r} is not modelled",
                mend="fix it to its parent, or build it from prismatic and revolute joints",
                source=self.source,
                line=element.sourceline,
            )
        if kind not in _TYPES:
            self.refuse(element, f"{owner}: unknown joint type {kind!r}", did_you_mean(kind, _TYPES))
        joint_type = _TYPES[kind]
        xyz, rotation = self.origin(element, owner)
        mimic = self._mimic(element, joint_type, owner)
        damping, friction = self._dynamics(element, joint_type, owner)
        lower, upper, effort, velocity = self._limits(element, joint_type, owner)
        return Joint(
            name=name,
            type=joint_type,
            parent=self._end(element, "parent", owner),
            child=self._end(element, "child", owner),
            xyz=xyz,
            rotation=rotation,
            axis=self._axis(element, joint_type, owner),
            damping=damping,
            friction=friction,
            lower=lower,
            upper=upper,
            effort=effort,
            velocity=velocity,
            mimic=mimic,
        )

    def _mimic(self, element: Any, kind: JointType, owner: str) -> Mimic | None:
        mimic = element.find("mimic")
        if mimic is None:
            return None
        if kind not in _ONE_DEGREE or kind is JointType.FIXED:
            self.notes.append(
                f"{owner} of type {kind} mimics {mimic.get('joint')!r}, which is left out: nothing to follow with"
            )
            return None
        if not mimic.get("joint"):
            self.refuse(mimic, f"{owner}: <mimic> names no joint", 'write <mimic joint="…"/>')
        multiplier, offset = (
            self.number(mimic, key, value, owner) for key, value in (("multiplier", 1.0), ("offset", 0.0))
        )
        return Mimic(str(mimic.get("joint")), multiplier, offset)

    def with_leaders(self, joints: list[Joint]) -> list[Joint]:
        """The joints, independent where what they mimic is no joint that moves, as urdfdom lets them be; told."""
        movable = {joint.name for joint in joints if joint.type in _ONE_DEGREE and joint.movable}
        kept = []
        for joint in joints:
            if joint.mimic is not None and joint.mimic.joint not in movable:
                what = f"joint {joint.name!r} mimics {joint.mimic.joint!r}, which is no joint of one degree of freedom here"
                self.notes.append(f"{what}; it counts as an independent joint")
                joint = replace(joint, mimic=None)
            kept.append(joint)
        return kept

    def _end(self, element: Any, role: str, owner: str) -> str:
        end = element.find(role)
        if end is None or not end.get("link"):
            self.refuse(element, f"{owner} has no {role} link", f'add <{role} link="…"/>')
        return str(end.get("link"))

    def _axis(self, element: Any, kind: JointType, owner: str) -> Array:
        axis_element = element.find("axis")
        if kind in (JointType.FIXED, JointType.FREE):
            return constant([0.0, 0.0, 1.0])
        if axis_element is None:
            return constant([1.0, 0.0, 0.0])  # the format's default
        axis = self.numbers(axis_element, "xyz", 3, None, owner)
        length = float(np.linalg.norm(axis))
        if length < 1e-12:
            self.refuse(axis_element, f"{owner}: axis has zero length", 'give a direction such as xyz="0 1 0"')
        if abs(length - 1.0) < 1e-15:
            return axis
        if abs(length - 1.0) > 1e-4:
            self.notes.append(f"{owner}: axis of length {length:.6g} was normalised")
        return constant(np.asarray(axis) / length)

    def _dynamics(self, element: Any, kind: JointType, owner: str) -> tuple[float, float]:
        dynamics = element.find("dynamics")
        if dynamics is None:
            return 0.0, 0.0
        values = []
        for key in ("damping", "friction"):
            value = self.number(dynamics, key, 0.0, owner)
            if key == "friction" and value and kind not in _ONE_DEGREE:
                self.notes.append(f"{owner}: friction {value:g} is left out, {kind} joints have none here")
                value = 0.0
            if value < 0.0:
                if self.physical:
                    self.refuse(dynamics, f"{owner}: {key} {value:g} is negative", "it would feed energy in")
                self.notes.append(f"{owner}: {key} {value:g} is negative; taken as it stands")
            values.append(value)
        return values[0], values[1]

    def _limits(self, element: Any, kind: JointType, owner: str) -> tuple[float, float, float, float]:
        limit = element.find("limit")
        if limit is None:
            if kind in (JointType.REVOLUTE, JointType.PRISMATIC):
                self.notes.append(
                    f"{owner} is {kind} without <limit>, taken as unlimited; urdfdom (ROS, Pinocchio) refuses the file"
                )
            return -np.inf, np.inf, np.inf, np.inf
        lower, upper = -np.inf, np.inf
        if kind in (JointType.REVOLUTE, JointType.PRISMATIC):
            lower = self._limit(limit, "lower", 0.0, owner)
            upper = self._limit(limit, "upper", 0.0, owner)
            if lower > upper:
                self.notes.append(f"{owner}: lower limit {lower:g} is above upper {upper:g}; both are left out")
                lower, upper = -np.inf, np.inf
        return lower, upper, self._limit(limit, "effort", np.inf, owner), self._limit(limit, "velocity", np.inf, owner)

    def _limit(self, element: Any, key: str, default: float, owner: str) -> float:
        """A limit, which may be infinite."""
        text = element.get(key)
        if text is None:
            return default
        if text.strip().lower().lstrip("+-") in ("inf", "infinity"):
            return float(text)
        value = self.number(element, key, None, owner)
        return math.copysign(math.inf, value) if abs(value) >= NO_LIMIT else value

    def base(self, joints: list[Joint], links: list[Link]) -> str:
        """The root link: the one that no joint carries."""
        carried = {joint.child for joint in joints}
        roots = [link.name for link in links if link.name not in carried]
        if not roots:
            line = self.lines.get(("joint", joints[0].name)) if joints else None
            raise InputError(
                "every link has a parent: the joints form a loop (cyclic tree)",
                mend="one link must be the root, carried by no joint",
                source=self.source,
                line=line,
            )
        if len(roots) > 1:
            # The root that carries most is the base; the others are then told apart as unreachable by `arrange`.
            reach = {root: _reach(root, joints) for root in roots}
            return max(roots, key=lambda root: reach[root])
        return roots[0]


def _reach(root: str, joints: list[Joint]) -> int:
    """How many links hang on a root."""
    children: dict[str, list[str]] = {}
    for joint in joints:
        children.setdefault(joint.parent, []).append(joint.child)
    seen = {root}
    stack = [root]
    while stack:
        for child in children.get(stack.pop(), []):
            if child not in seen:
                seen.add(child)
                stack.append(child)
    return len(seen)
