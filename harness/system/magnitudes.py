"""Numbers that no mechanism has: a slip of the pen, a unit mistaken, or an attempt to make arithmetic overflow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.system.description import Beam, System

# The largest of each that is still taken, in SI: far beyond anything that is built, and such that no product of a few of them
# overflows. A moon of Saturn weighs 1e20 kg, and the Earth is 1.5e11 m from the sun.
MASS, LENGTH, ANGLE, ACCELERATION = 1e15, 1e9, 1e6, 1e6
INERTIA, STIFFNESS = 1e20, 1e20
# Any number of a model file, before anything is computed from it.
NUMBER = 1e30
# The smallest mass and size of a beam [kg, m]: below an electron's, and a proton's.
LEAST_MASS, LEAST_LENGTH = 1e-30, 1e-15
_SHIFTS = ("x", "y", "z", "vx", "vy", "vz")


def check_magnitudes(system: System, *, lines: Mapping[tuple[str, str], int] | None = None) -> None:
    """Refuse numbers beyond any mechanism; raises InputError naming joint or link, the number and what is taken."""
    for kind, name, what, value, most, unit in _numbers(system):
        if np.abs(value).max(initial=0.0) > most:
            largest = float(np.abs(value).max())
            raise InputError(
                f"{kind} {name!r}: {what} of {largest:.3g} {unit} is beyond any mechanism"
                if name
                else f"{what} of {largest:.3g} {unit} is beyond any mechanism",
                mend=f"check the number and its unit; up to {most:g} {unit} is taken",
                source=system.source,
                line=(lines or {}).get((kind, name)),
            )
    for link in system.links:
        beam = link.beam
        small = [("mass", link.mass, LEAST_MASS, "kg", link.mass > 0.0)]
        if beam is not None:
            small.append(("length", beam.length, LEAST_LENGTH, "m", True))
            small += [(key, getattr(beam, key), LEAST_LENGTH, "m", True) for key in ("width", "thickness")]
        for what, size, least, unit, stated in small:
            if stated and size < least:
                raise InputError(
                    f"link {link.name!r}: {what} of {size:.3g} {unit} is beyond any mechanism",
                    mend=f"check the number and its unit; {least:g} {unit} and more is taken",
                    source=system.source,
                    line=(lines or {}).get(("link", link.name)),
                )


_Number = tuple[str, str, str, np.ndarray, float, str]


def _numbers(system: System) -> Iterator[_Number]:
    """Kind and name of what has it, what it is, value, the largest that is taken, unit."""
    yield "", "", "gravity", np.asarray(system.gravity), ACCELERATION, "m/s²"
    for joint in system.joints:
        yield "joint", joint.name, "origin", np.asarray(joint.xyz), LENGTH, "m"
        most, unit = (LENGTH, "m") if joint.prismatic else (ANGLE, "rad")
        yield "joint", joint.name, "rest_position", np.asarray(joint.rest_position), most, unit
        most, unit = (MASS, "kg") if joint.prismatic else (INERTIA, "kg·m²")
        yield "joint", joint.name, "armature", np.asarray(joint.armature), most, unit
        for what in ("damping", "friction", "stiffness"):
            yield "joint", joint.name, what, np.asarray(getattr(joint, what)), STIFFNESS, "(SI)"
    for link in system.links:
        yield "link", link.name, "mass", np.asarray(link.mass), MASS, "kg"
        yield "link", link.name, "centre of mass", np.asarray(link.com), LENGTH, "m"
        yield "link", link.name, "inertia", np.asarray(link.inertia), INERTIA, "kg·m²"
        if link.beam is not None:
            yield from _of_beam(link.name, link.beam)


def check_start(system: System, values: Mapping[str, float], rate: str, what: str, source: Path | None = None) -> None:
    """Refuse a start beyond any mechanism: the sine of such an angle is known to no digit that matters.

    values: positions [rad or m], or velocities with ``rate`` "/s", by coordinate name. what: where they were given; source: in
    which file.
    Raises InputError naming the coordinate, its number and what is taken.
    """
    for name, value in values.items():
        most, unit = (ANGLE, "rad") if _turns(system, name) else (LENGTH, "m")
        if abs(value) > most:
            raise InputError(
                f"{what}: {name} of {value:.3g} {unit}{rate} is beyond any mechanism",
                mend=f"check the number and its unit; up to {most:g} {unit}{rate} is taken",
                source=source,
            )


def _turns(system: System, coordinate: str) -> bool:
    """Whether a coordinate is an angle, or of a quaternion; else it is a shift, or a mode of what bends."""
    for joint in system.movable_joints:
        if coordinate in (*joint.position_names, *joint.velocity_names):
            several = len(joint.velocity_names) > 1
            return not (joint.prismatic or (several and coordinate.rpartition(".")[2] in _SHIFTS))
    return False


def _of_beam(name: str, beam: Beam) -> Iterator[_Number]:
    for what in ("length", "half_depth"):
        value = np.nan_to_num(np.asarray(getattr(beam, what)))
        yield "link", name, what, value, LENGTH, "m"
    for what in ("bending_stiffness", "bending_stiffness2", "torsional_stiffness"):
        yield "link", name, what, np.asarray(getattr(beam, what)), STIFFNESS, "N·m²"
    yield "link", name, "payload", np.asarray(beam.payload), MASS, "kg"
    yield "link", name, "payload_inertia", np.asarray(beam.payload_inertia), INERTIA, "kg·m²"
    yield "link", name, "material damping", np.asarray(beam.material_damping), ANGLE, "s"
    for what in ("modal_damping", "mode_stiffness"):
        yield "link", name, what, np.asarray(getattr(beam, what), dtype=np.float64), ANGLE, "(a plain number)"
