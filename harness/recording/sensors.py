"""From motion to what sensors would have read: positions, velocities, deflection, strain and acceleration at a link's tip.

What a real sensor then does to the signal (offset, delay, filters, …) are effects, see ``harness.effects.measurement``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from harness.denoc.beam.integrals import BENDING, BeamData, beam_data
from harness.denoc.beam.static_correction import left_out
from harness.effects.bending import bending_direction
from harness.effects.scale import tip_of
from harness.errors import InputError, UnsupportedError
from harness.recording.recording import LINK_QUANTITIES, QUANTITIES
from harness.system import Joint, System, Trajectory
from harness.system.description import Array
from harness.system.suggest import did_you_mean

States = tuple[Array, Array, Array]


class Compiled(Protocol):
    """A compiled model of many lanes, as far as sensors need it."""

    @property
    def system(self) -> System: ...
    @property
    def names(self) -> tuple[str, ...]: ...
    def slot(self, site: str, name: str) -> int: ...


def observe(
    model: Compiled,
    rows: Array,
    site: str,
    quantity: str,
    states: States,
    systems: Sequence[System] = (),
    *,
    linear: bool = False,
) -> Array:
    """One channel of many lanes, shape (B, T).

    rows: parameter rows (B, P), of which gravity is taken. states: position, velocity, acceleration of the coordinates
    ``model.names``, each (B, T, n). site, quantity: as in a recording's columns. systems: what each row was made of (B), of which
    lengths and mode shapes are taken; by default the model's own. linear: leave out of deflection and strain what the beam's
    modes leave out (``harness.denoc.beam.static_correction``), which makes them linear in the state.
    Raises InputError for a channel that the system has not.
    """
    gravity = rows[:, [model.slot("base", f"gravity_{axis}") for axis in "xyz"]]
    if quantity not in LINK_QUANTITIES or not systems:
        return read_channel(model.system, model.names, gravity, site, quantity, states, linear=linear)
    alike: dict[int, list[int]] = {}
    for lane, system in enumerate(systems):
        alike.setdefault(id(system), []).append(lane)
    if len(alike) == 1:
        return read_channel(systems[0], model.names, gravity, site, quantity, states, linear=linear)
    out = np.empty(states[0].shape[:2])
    for lanes in alike.values():
        q, qd, qdd = (array[lanes] for array in states)
        own = systems[lanes[0]]
        out[lanes] = read_channel(own, model.names, gravity[lanes], site, quantity, (q, qd, qdd), linear=linear)
    return out


def measure(trajectory: Trajectory, system: System, channels: tuple[str, ...]) -> dict[str, Array]:
    """Channels by name (``pivot.position``, ``rod.root_strain``) along a simulated motion, each shape (T,).

    A channel that the engine gave itself is taken as it is. Accelerations are differences of the trajectory's velocities,
    so tip accelerations need a sampling interval well below the periods of the motion.
    """
    time = np.asarray(trajectory.time)
    acceleration = np.gradient(trajectory.velocity, time, axis=0, edge_order=2 if len(time) > 2 else 1)
    states = (trajectory.position[None], trajectory.velocity[None], acceleration[None])
    found: dict[str, Array] = {}
    for name in channels:
        site, _, quantity = name.rpartition(".")
        if name in trajectory.channels:
            found[name] = np.asarray(trajectory.channels[name])
        else:
            found[name] = read_channel(system, trajectory.names, system.gravity[None], site, quantity, states)[0]
    return found


def read_channel(
    system: System,
    names: tuple[str, ...],
    gravity: Array,
    site: str,
    quantity: str,
    states: States,
    *,
    linear: bool = False,
) -> Array:
    """One channel (B, T) from states (B, T, n) of the coordinates ``names``; gravity (B, 3) or (1, 3); linear: see ``observe``."""
    if quantity not in QUANTITIES:
        raise InputError(f"{quantity!r} is no quantity of a recording", mend=did_you_mean(quantity, QUANTITIES))
    position, velocity, _ = states
    if quantity in ("position", "velocity"):
        if site not in names:
            raise InputError(f"there is no joint {site!r} to observe", mend=did_you_mean(site, names))
        return np.asarray((position if quantity == "position" else velocity)[:, :, names.index(site)])
    links = tuple(link.name for link in system.links)
    if quantity not in LINK_QUANTITIES or site not in links:
        raise InputError(f"there is no {quantity} of {site!r} to observe", mend=did_you_mean(site, links))
    link = system.link(site)
    if link.beam is None:
        if quantity != "tip_acceleration":
            return np.zeros(position.shape[:2])
        return _specific_force(system, names, gravity, site, states)
    if quantity == "tip_acceleration":
        return _specific_force(system, names, gravity, site, states)
    data = beam_data(system, site)
    if quantity == "root_strain" and not np.isfinite(data.half_depth):
        raise InputError(
            f"link {site!r} does not say how deep it is, so strain cannot be told",
            mend="give its section by width and thickness",
        )
    modes, columns = _bending_modes(data, names, site)
    deflects = quantity == "tip_deflection"
    shape = data.tip.s if deflects else data.at(0.0).curvature
    read = position[:, :, columns] @ shape[modes]
    rest = left_out(system, data)
    if not (linear or rest.nothing or any(_rides_on_flexible(system, joint) for joint in _chain(system, site))):
        at = _frame(system, names, gravity, site, states)
        along, across = at.turn @ data.direction, at.turn @ data.bending
        root = np.sum(at.felt * across, axis=-1)
        turning = np.sum(at.carried(along) * across, axis=-1)
        read = read + rest.read(rest.tip if deflects else rest.curvature, root, turning, states[2][:, :, columns])
    return np.asarray(read if deflects else data.half_depth * read)


def _bending_modes(data: BeamData, names: tuple[str, ...], site: str) -> tuple[list[int], list[int]]:
    """Modes of the first bending plane, and their places among the coordinates."""
    modes = [k for k, plane in enumerate(data.plane) if plane == BENDING]
    return modes, [names.index(f"{site}.mode{k + 1}") for k in modes]


def _chain(system: System, site: str) -> list[Joint]:
    """Joints from the base to the link."""
    chain: list[Joint] = []
    name = site
    while name != system.base:
        joint = system.carrier(name)
        chain.append(joint)
        name = joint.parent
    return chain[::-1]


def _rides_on_flexible(system: System, joint: Joint) -> bool:
    return joint.parent != system.base and system.link(joint.parent).flexible


@dataclass(frozen=True, eq=False)
class _Frame:
    """A link's frame along a motion: its axes as columns (B, T, 3, 3); angular velocity and acceleration, and acceleration of its
    origin less gravity, in base axes, (B, T, 3). What all lanes and times share lacks these two axes."""

    turn: Array
    spin: Array
    spin_rate: Array
    felt: Array

    def carried(self, arm: Array) -> Array:
        """Acceleration that the frame's turning gives a point at ``arm`` (B, T, 3) from its origin, base axes."""
        return np.asarray(_cross(self.spin_rate, arm) + _cross(self.spin, _cross(self.spin, arm)))


def _frame(system: System, names: tuple[str, ...], gravity: Array, site: str, states: States) -> _Frame:
    position, velocity, acceleration = states
    shape = position.shape[:2]
    at = _Frame(np.eye(3), np.zeros(3), np.zeros(3), np.broadcast_to(-gravity[:, None, :], (*shape, 3)))
    moving = False
    for joint in _chain(system, site):
        if _rides_on_flexible(system, joint):
            raise UnsupportedError(
                f"tip acceleration of {site!r}, which rides on the flexible link {joint.parent!r}",
                mend="measure another link",
            )
        felt = at.felt + at.carried(at.turn @ joint.xyz) if moving else at.felt
        turn, spin, spin_rate = at.turn @ joint.rotation, at.spin, at.spin_rate
        if joint.movable:
            k = names.index(joint.name)
            axis = turn @ joint.axis
            speed, rate = velocity[:, :, k, None], acceleration[:, :, k, None]
            if joint.prismatic:
                felt = felt + axis * rate
                if moving:
                    felt = felt + at.carried(axis * position[:, :, k, None]) + 2.0 * _cross(spin, axis * speed)
            else:
                turn = turn @ _turns(joint.axis, position[:, :, k])
                own = axis * speed
                spin_rate = spin_rate + axis * rate + (_cross(spin, own) if moving else 0.0)
                spin = spin + own
            moving = True
        at = _Frame(turn, spin, spin_rate, felt)
    return at


def _specific_force(system: System, names: tuple[str, ...], gravity: Array, site: str, states: States) -> Array:
    """Acceleration of the tip less gravity, along the bending direction of the section there [m/s²], shape (B, T)."""
    position, velocity, acceleration = states
    at = _frame(system, names, gravity, site, states)
    shape, turn = position.shape[:2], at.turn
    link = system.link(site)
    if link.beam is None:
        tip = tip_of(link, system)
        if not np.any(tip):
            raise InputError(
                f"link {site!r} has no tip to feel acceleration at", mend="its centre of mass is on its joint"
            )
        arm = np.broadcast_to(turn @ tip, (*shape, 3))
        along = turn @ bending_direction(system, site, tip / np.linalg.norm(tip))
        felt = at.felt + at.carried(arm)
        return np.asarray(np.sum(felt * along, axis=2))
    data = beam_data(system, site)
    modes, columns = _bending_modes(data, names, site)
    s, slope, stiffening = data.tip.s[modes], data.tip.slope[modes], data.tip.H[np.ix_(modes, modes)]
    b, bd, bdd = position[:, :, columns], velocity[:, :, columns], acceleration[:, :, columns]
    short = stiffening if data.geometric_stiffening else np.zeros_like(stiffening)
    d, e = data.direction, data.bending

    def local(across: Array, back: Array) -> Array:
        return np.asarray(across[..., None] * e - back[..., None] * d)

    # u = s b e − ½ bᵀ H b d and its time derivatives, in the link's frame.
    u = data.length * d + local(b @ s, 0.5 * np.einsum("...k,kl,...l", b, short, b))
    ud = local(bd @ s, np.einsum("...k,kl,...l", b, short, bd))
    udd = local(bdd @ s, np.einsum("...k,kl,...l", b, short, bdd) + np.einsum("...k,kl,...l", bd, short, bd))

    def to_base(vector: Array) -> Array:
        return np.asarray(np.einsum("...ij,...j->...i", turn, vector))

    felt = at.felt + at.carried(to_base(u)) + 2.0 * _cross(at.spin, to_base(ud)) + to_base(udd)
    angle = b @ slope
    along = to_base(np.cos(angle)[..., None] * e - np.sin(angle)[..., None] * d)
    return np.asarray(np.sum(felt * along, axis=2))


def _cross(a: Array, b: Array) -> Array:
    """Products a × b over the last axis; ``numpy.cross`` takes longer about its axes than about these."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[..., i] = a[..., j] * b[..., k] - a[..., k] * b[..., j]
    return out


def _turns(axis: Array, angle: Array) -> Array:
    """Rotation matrices about a unit axis by angles (B, T), shape (B, T, 3, 3) (Rodrigues)."""
    x, y, z = axis
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle)[..., None, None] * k + (1.0 - np.cos(angle))[..., None, None] * (k @ k))
