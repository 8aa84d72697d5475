"""Sizes that are natural to a system and a recording: what makes a torque or an angle large or small there."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np

from harness.effects.measured import Measured
from harness.system import Gimbal, Link, Loop, System
from harness.system.closure import close, closed_position, opening, pins, turning
from harness.system.closure import size as size_of
from harness.system.description import Array
from harness.system.inertia import about_origin, point_inertia
from harness.system.kinematics import gravity_forces, mass_matrix

SLOWEST_RATE = 1e-3  # rad/s; below, nothing is taken to pull a joint back
A_TURN_A_SECOND = 2.0 * np.pi
POSITIONS = 14  # half a radian of the fastest joint apart


@dataclass(frozen=True)
class References:
    """Natural sizes at one site; every one is positive.

    torque: largest gravity torque about the joint, all that hangs on it held straight [N·m or N]; of a recording no less than what
        the stated spring of the joint makes over half the range of its motion there, over 1 rad or 1 m where that is not read.
    inertia: about the joint axis, armature included [kg·m² or kg].
    frequency: √((gravity's torque + stiffness of its own spring) / inertia), or one turn a second where nothing pulls it back
        [rad/s].
    mass: carried by the joint [kg]; length: from the joint to the tip [m]; gravity [m/s²].
    signal: extent of the channel, half its range [channel unit]; effort: largest applied [N·m or N].
    duration: of the recording [s]; interval: median sampling interval [s].
    """

    torque: float = 1.0
    inertia: float = 1.0
    frequency: float = 1.0
    mass: float = 1.0
    length: float = 1.0
    gravity: float = 9.81
    signal: float = 1.0
    effort: float = 1.0
    duration: float = 10.0
    interval: float = 0.01


@dataclass(frozen=True)
class Scale:
    """A typical size as a rule: a factor times powers of the natural sizes.

    ``Scale(0.02, torque=1, frequency=-1)`` is two per cent of torque / frequency, ``Scale(inertia=0.5, mass=-0.5)`` a radius of
    gyration.
    """

    factor: float = 1.0
    torque: int = 0
    inertia: float = 0
    frequency: int = 0
    mass: float = 0
    length: int = 0
    gravity: int = 0
    signal: int = 0
    effort: int = 0
    duration: int = 0
    interval: int = 0

    def __call__(self, references: References) -> float:
        """The size in SI (or channel) units; positive."""
        value = self.factor
        for size in fields(References):
            value *= getattr(references, size.name) ** getattr(self, size.name)
        return float(value)

    def __str__(self) -> str:
        text = f"{self.factor:g}"
        for size in fields(References):
            power = getattr(self, size.name)
            if power:
                text += f" · {size.name}" + (f"^{power}" if power != 1 else "")
        return text


def references(system: System, site: str, recording: Measured | None = None) -> References:
    """Natural sizes at a joint, a link, a channel (``pivot.position``) or the base.

    A link is seen from the joint that carries it, a channel from the joint or link it belongs to, the base from the
    first movable joint.
    """
    owner = site.rsplit(".", 1)[0] if "." in site and site not in system.joint_names else site
    owner = next((g.coordinates[0] for g in system.gimbals if site == g.name), owner)
    # Where a loop is cut, what turns there is seen from the joint that carries it.
    if site in pins(system):
        owner = next(loop.second.link for loop in system.loops if isinstance(loop, Loop) and loop.name == site)
    joint_name = _joint_of(system, owner)
    sizes = (_closed(system).get(site) if site in pins(system) else None) or _mechanical(system, joint_name)
    signal, effort, duration, interval = 1.0, 0.0, 10.0, 0.01
    torque, inertia, frequency, mass, length, gravity = sizes
    if recording is not None:
        torque = max(torque, _of_its_spring(system, site, joint_name, recording))
        time = np.asarray(recording.time)
        duration = float(time[-1] - time[0]) or duration
        interval = float(np.median(np.diff(time))) or interval
        signal = _extent(recording, site)
        for channel in recording.efforts:
            if channel.site == joint_name:
                finite = channel.values[np.isfinite(channel.values)]
                effort = float(np.abs(finite).max()) if finite.size else 0.0
    return References(
        torque=torque,
        inertia=inertia,
        frequency=frequency,
        mass=mass,
        length=length,
        gravity=gravity,
        signal=signal,
        effort=effort or torque,
        duration=duration,
        interval=interval,
    )


def _extent(recording: Measured, name: str) -> float:
    """Half the range of a channel [its unit]; 1 where it is not recorded, or stands still."""
    read = [channel.values[np.isfinite(channel.values)] for channel in recording.channels if channel.name == name]
    return (float(np.ptp(read[-1])) / 2.0 if read and read[-1].size else 1.0) or 1.0


def _of_its_spring(system: System, site: str, joint_name: str, recording: Measured) -> float:
    """What the stated spring of a joint makes over its motion [N·m or N]; nothing at the pins where a loop is cut."""
    if not joint_name or site in pins(system):
        return 0.0
    return max(system.joint(joint_name).stiffness, 0.0) * _extent(recording, f"{joint_name}.position")


def _joint_of(system: System, name: str) -> str:
    for joint in system.joints:
        if name in (joint.name, joint.child) and joint.movable:
            return joint.name
    for joint in system.joints:  # a link on a fixed joint: the nearest movable joint below it
        if name in (joint.name, joint.child):
            carriers = {j.child: j for j in system.joints}
            parent = joint.parent
            while parent in carriers:
                if carriers[parent].movable:
                    return carriers[parent].name
                parent = carriers[parent].parent
    movable = system.movable_joints
    return movable[0].name if movable else ""


def swings(system: System, recording: Measured | None = None) -> tuple[float, ...]:
    """Natural frequencies of the joints [rad/s]; of what bends where no joint moves."""
    return tuple(references(system, name, recording).frequency for name in system.joint_names or ("",))


def swing(system: System, recording: Measured | None = None) -> float:
    """Natural frequency that motions are counted in [rad/s]: of the first joint that something pulls back, of the first one where
    nothing pulls at any, as swings of what has no rest are only a guess."""
    every = swings(system, recording)
    if system.loops or system.gimbals or not system.joint_names:
        return every[0]
    pulled = (_rate(system, name, *_about(system, name)[:2]) > 0.0 for name in system.joint_names)
    return next((rate for rate, back in zip(every, pulled, strict=True) if back), every[0])


def pull(system: System) -> float:
    """The largest natural torque of any joint [N·m or N]; of the weight at the clamp where no joint moves."""
    return max(references(system, name).torque for name in system.joint_names or ("",))


def _held(system: System, gravity: float) -> tuple[float, float, float, float, float, float]:
    """The same of a mechanism without joints: a cantilever about its clamp, in its first mode.

    k = 3 EI / l³ with 33/140 of the beam at the tip (Blevins, Formulas for Natural Frequency and Mode Shape (1979)).
    """
    beams = [link.beam for link in system.links if link.beam is not None]
    if not beams:
        return 1.0, 1.0, 2.0 * np.pi, 1.0, 1.0, gravity
    beam = beams[0]
    tip = beam.payload + 33.0 / 140.0 * beam.mass
    frequency = float(np.sqrt(3.0 * beam.bending_stiffness / beam.length**3 / tip))
    inertia = (beam.payload + beam.mass / 3.0) * beam.length**2
    torque = (beam.payload + 0.5 * beam.mass) * gravity * beam.length
    return torque, inertia, frequency, beam.payload + beam.mass, beam.length, gravity


def _mechanical(system: System, joint_name: str) -> tuple[float, float, float, float, float, float]:
    """Torque, inertia, frequency, mass, length, gravity about one joint with everything else at zero position."""
    gravity = float(np.linalg.norm(system.gravity))
    if not joint_name:
        return _held(system, gravity or 9.81)
    if system.loops:
        together = _closed(system).get(joint_name)
        if together is not None:
            return together
    gimbal = system.gimbal_of(joint_name)
    if gimbal is not None:
        return _in_space(system, gimbal, gravity)
    torque, inertia, mass, reach = _about(system, joint_name)
    rate = _rate(system, joint_name, torque, inertia)
    if torque / inertia < SLOWEST_RATE**2:
        torque = inertia * A_TURN_A_SECOND**2
    return torque, inertia, rate or A_TURN_A_SECOND, mass or 1.0, reach or 1.0, gravity or 9.81


def _rate(system: System, joint_name: str, torque: float, inertia: float) -> float:
    """How fast gravity and its own spring make a joint swing [rad/s]; zero where nothing pulls it back."""
    rate = float(np.sqrt(max(torque + system.joint(joint_name).stiffness, 0.0) / inertia))
    return rate if rate >= SLOWEST_RATE else 0.0


def _about(system: System, joint_name: str) -> tuple[float, float, float, float]:
    """Gravity's torque about one joint with everything else at zero position, inertia, mass, reach."""
    gravity = float(np.linalg.norm(system.gravity))
    poses = zero_poses(system)
    joint = system.joint(joint_name)
    rotation, origin = poses[joint.child]
    axis = rotation @ joint.axis
    carried = _carried(system, joint.child)
    mass, inertia, reach = 0.0, joint.armature, 0.0
    moment = np.zeros(3)
    for link in system.links:
        if link.name not in carried:
            continue
        turn, place = poses[link.name]
        arm = place + turn @ link.com - origin
        mass += link.mass
        moment = moment + link.mass * arm
        if joint.prismatic:
            inertia += link.mass
        else:
            tensor = turn @ about_origin(link) @ turn.T
            about_com = tensor - point_inertia(link.mass, turn @ link.com)
            inertia += float(axis @ (about_com + point_inertia(link.mass, arm)) @ axis)
        reach = max(reach, float(np.linalg.norm(tip_of(link, system) @ turn.T + place - origin)))
    if joint.prismatic:
        torque = mass * gravity
    else:
        # The joint turns, so gravity's part across the axis and the moment's part across the axis meet at right angles.
        across_gravity = system.gravity - axis * (axis @ system.gravity)
        across_moment = moment - axis * (axis @ moment)
        torque = float(np.linalg.norm(across_gravity) * np.linalg.norm(across_moment))
    return torque, inertia if inertia > 0.0 else 1.0, mass, reach


def _in_space(system: System, gimbal: Gimbal, gravity: float) -> tuple[float, float, float, float, float, float]:
    """The same of three joints that are one in space together: those of a body that hangs by its centre of mass's distance."""
    poses = zero_poses(system)
    origin = poses[gimbal.child][1]
    carried = [link for link in system.links if link.name in _carried(system, gimbal.child)]
    mass, moment, tensor, reach = 0.0, np.zeros(3), np.zeros((3, 3)), 0.0
    for link in carried:
        turn, place = poses[link.name]
        arm = place + turn @ link.com - origin
        mass, moment = mass + link.mass, moment + link.mass * arm
        central = turn @ (about_origin(link) - point_inertia(link.mass, np.asarray(link.com))) @ turn.T
        tensor = tensor + central + point_inertia(link.mass, arm)
        reach = max(reach, float(np.linalg.norm(place + turn @ tip_of(link, system) - origin)))
    if reach == 0.0 and mass > 0.0:
        # About its centre a body reaches as far as the uniform rod of its inertia: √3 radii of gyration.
        reach = float(np.sqrt(3.0 * np.linalg.eigvalsh(tensor)[-1] / mass))
    free = any(other.slides and other.joint == gimbal.joint for other in system.gimbals)
    if gimbal.slides:
        return (
            mass * gravity or 1.0,
            mass or 1.0,
            float(np.sqrt(gravity)) or 1.0,
            mass or 1.0,
            reach or 1.0,
            gravity or 9.81,
        )
    inertia = float(np.trace(tensor)) / 3.0 if free else float(np.linalg.eigvalsh(tensor)[-1])
    torque = 0.0 if free else gravity * float(np.linalg.norm(moment))
    rate = float(np.sqrt(torque / inertia)) if inertia > 0.0 else 0.0
    if rate < 1e-3:
        rate, torque = 2.0 * np.pi, (inertia or 1.0) * (2.0 * np.pi) ** 2
    return torque, inertia or 1.0, rate, mass or 1.0, reach or 1.0, gravity or 9.81


@lru_cache(maxsize=8)
def _closed(system: System) -> dict[str, tuple[float, float, float, float, float, float]]:
    """The same of every joint and pin of a closed mechanism of one degree of freedom, seen from there; nothing of others.

    Gravity and inertia are those of the whole mechanism, over positions all along its motion, by how far each joint moves.
    """
    names, gravity = system.coordinate_names, float(np.linalg.norm(system.gravity))
    if system.flexible or not system.simple:
        return {}
    q = closed_position(system)
    cuts = [loop for loop in system.loops if isinstance(loop, Loop) and loop.name in pins(system)]
    ways, turns, pulls, inertias = list[Array](), list[Array](), list[float](), list[float]()
    for _ in range(POSITIONS):
        _, sizes, rows = np.linalg.svd(opening(system, q).jacobian)
        if len(names) - int(np.sum(sizes > 1e-7 * sizes.max(initial=0.0))) != 1:
            return {}
        way = rows[-1] if not ways or rows[-1] @ ways[-1] >= 0.0 else -rows[-1]
        ways.append(way)
        turns.append(np.array([np.linalg.norm(turning(system, q, loop) @ way) for loop in cuts]))
        inertias.append(float(way @ mass_matrix(system, q) @ way))
        pulls.append(abs(float(way @ gravity_forces(system, q))))
        q = close(system, q + way * (0.5 / np.abs(way).max()))[0]
    torque, inertia = max(pulls), float(np.mean(inertias))
    rate = float(np.sqrt(torque / inertia))
    if rate < 1e-3:
        rate, torque = 2.0 * np.pi, inertia * (2.0 * np.pi) ** 2
    moved = np.sqrt(np.mean(np.square(np.hstack([ways, turns])), axis=0))
    moved = np.maximum(moved, 1e-2 * moved.max())
    mass = sum(link.mass for link in system.links)
    return {
        name: (torque / share, inertia / share**2, rate, mass or 1.0, size_of(system), gravity or 9.81)
        for name, share in zip((*names, *(loop.name for loop in cuts)), moved.tolist(), strict=True)
    }


def zero_poses(system: System) -> dict[str, tuple[Array, Array]]:
    """Rotation (3, 3) and origin (3,) of every link frame in base coordinates at zero position, the base included."""
    poses: dict[str, tuple[Array, Array]] = {system.base: (np.eye(3), np.zeros(3))}
    for joint in system.joints:
        rotation, origin = poses[joint.parent]
        poses[joint.child] = (rotation @ joint.rotation, origin + rotation @ joint.xyz)
    return poses


def _carried(system: System, link_name: str) -> set[str]:
    carried = {link_name}
    for joint in system.joints:  # topological order: a parent comes before its children
        if joint.parent in carried:
            carried.add(joint.child)
    return carried


def tip_of(link: Link, system: System) -> Array:
    """Where a link ends, in its own frame [m], shape (3,).

    A beam ends at its tip, a link that carries others at the farthest joint on it, one whose end is stated there. Otherwise the
    link is taken for a uniform rod with a point mass at its end that has the same mass, centre of mass and inertia:
    with k² = J/m about the link's origin, c the distance of the centre of mass and x the point mass's share,
    k²/c² = (4/3) (1 + 2x)/(1 + x)² and the end lies at 2c/(1 + x).
    """
    if link.beam is not None:
        return np.asarray(link.beam.direction * link.beam.length)
    ends = [joint.xyz for joint in system.joints if joint.parent == link.name]
    if ends:
        farthest = max(ends, key=lambda end: float(np.linalg.norm(end)))
        if np.linalg.norm(farthest) > 0.0:
            return np.asarray(farthest)
    if link.end is not None:
        return np.asarray(link.end)
    distance = float(np.linalg.norm(link.com))
    if distance == 0.0 or link.mass <= 0.0:
        return np.zeros(3)
    return np.asarray(link.com) * rod_and_bob(link)[0] / distance


def rod_and_bob(link: Link) -> tuple[float, float]:
    """Length [m] and the end mass's share of the total of the rod that ``tip_of`` speaks of.

    A link with more inertia than a uniform rod has about its origin (k²/c² > 4/3) is given no end mass.
    """
    com = np.asarray(link.com)
    distance = float(np.linalg.norm(com))
    along = com / distance
    tensor = about_origin(link)
    # Inertia across the rod, the mean of the two transverse directions.
    across = (float(np.trace(tensor)) - float(along @ tensor @ along)) / 2.0
    ratio = across / (link.mass * distance**2)
    target = 0.75 * ratio  # (1 + 2x)/(1 + x)²
    if target >= 1.0:
        return 2.0 * distance, 0.0
    # target (1 + x)² = 1 + 2x, the root in [0, 1]
    share = (1.0 - target + np.sqrt(1.0 - target)) / target if target > 0.0 else 1.0
    share = float(min(max(share, 0.0), 1.0))
    return 2.0 * distance / (1.0 + share), share
