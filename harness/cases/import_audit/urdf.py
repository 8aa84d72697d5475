"""Fields of a URDF: of the format itself, and of Gazebo's, Drake's and ROS's extensions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.cases.import_audit.ignored import ACTS, IGNORED, KEPT, Ignored, cost_natively, free_run, readers, start
from harness.compare.readings import differences, phrase
from harness.engines.readers import read_by
from harness.engines.readers.reading import placed_bodies
from harness.errors import EngineUnavailableError, UnsupportedError
from harness.system import Joint, System
from harness.system.urdf_left_out import number, rotors, springs
from harness.system.xml_source import parse_xml

_WITH = "native runs with the field and without it"


def urdf_fields(path: Path, system: System, allow: Sequence[Path] = ()) -> Iterator[Ignored]:
    """One row for each field at each joint."""
    root = parse_xml(path.read_bytes(), path)
    movable = {joint.name: joint for joint in system.movable_joints}
    for joint in movable.values():
        yield from _dissipation(system, joint)
    yield from _limits(system)
    for element in root.findall("joint"):
        if element.find("mimic") is not None and element.get("name") in movable:
            yield _mimic(system, element)
        dynamics = element.find("dynamics")
        if dynamics is not None and element.get("name") in movable:
            yield from _further(system, movable[str(element.get("name"))], dynamics)
    for name, gear, inertia in rotors(root):
        if name in movable:
            joint = movable[name]
            geared = replace(joint, armature=joint.armature + gear**2 * inertia)
            cost = cost_natively(system, system.replace_joint(geared))
            value = f"{inertia:g} kg·m² × {gear:g}²"
            yield Ignored("drake:rotor_inertia", name, value, readers(IGNORED, IGNORED, IGNORED), *cost, _WITH)
    for name, stiffness, rest in springs(root):
        if name in movable:
            yield _spring(system, movable[name], "gazebo springStiffness", stiffness, rest)
    yield from _read_otherwise(path, system, allow)


def _dissipation(system: System, joint: Joint) -> Iterator[Ignored]:
    unit = "N·s/m" if joint.prismatic else "N·m·s/rad"
    for field, value, text, less in (
        ("damping", joint.damping, f"{joint.damping:g} {unit}", replace(joint, damping=0.0)),
        (
            "friction",
            joint.friction,
            f"{joint.friction:g} {joint.force_unit.replace('*', '·')}",
            replace(joint, friction=0.0),
        ),
    ):
        if value:
            without = system.replace_joint(less)
            yield Ignored(
                f"dynamics {field}", joint.name, text, readers(ACTS, KEPT, ACTS), *cost_natively(without, system), _WITH
            )


def _limits(system: System) -> Iterator[Ignored]:
    """How far a free motion that begins inside the limits leaves them where nobody minds them."""
    run = free_run(system)
    for k, joint in enumerate(system.movable_joints):
        if not (np.isfinite(joint.lower) and np.isfinite(joint.upper)):
            continue
        beyond = None
        if run is not None:
            beyond = float(np.maximum(np.maximum(run[:, k] - joint.upper, joint.lower - run[:, k]), 0.0).max())
        value = f"{joint.lower:g} … {joint.upper:g} {joint.position_unit}"
        yield Ignored(
            "limit",
            joint.name,
            value,
            readers("in single runs alone", KEPT, ACTS),
            None,
            beyond,
            "how far a free run goes beyond the limit",
        )


def _mimic(system: System, element: Any) -> Ignored:
    mimic, name = element.find("mimic"), str(element.get("name"))
    followed = str(mimic.get("joint"))
    factor = number(mimic.get("multiplier")) if mimic.get("multiplier") is not None else 1.0
    offset = number(mimic.get("offset"))
    apart = None
    names = list(system.joint_names)
    run = free_run(system)
    if run is not None and followed in names:
        led, leads = run[:, names.index(name)], run[:, names.index(followed)]
        # From where both begin, so that a start off the law does not count.
        apart = float(np.abs(led - led[0] - factor * (leads - leads[0])).max())
    return Ignored(
        "mimic",
        name,
        f"{factor:g} · {followed} + {offset:g}",
        readers(ACTS, "ignored unless mimic=True is asked for", "acts, as a soft equality"),
        None,
        apart,
        "how far a free run departs from the law",
    )


def _further(system: System, joint: Joint, dynamics: Any) -> Iterator[Ignored]:
    for key, text in dynamics.attrib.items():
        if key in ("damping", "friction", "spring_reference"):
            continue
        if key == "spring_stiffness":
            rest = number(dynamics.get("spring_reference"))
            yield _spring(system, joint, "dynamics spring_stiffness", number(text), rest)
        else:
            nobody = readers(IGNORED, IGNORED, IGNORED)
            yield Ignored(f"dynamics {key}", joint.name, text, nobody, None, None, "not known to any of them")


def _spring(system: System, joint: Joint, field: str, stiffness: float, rest: float) -> Ignored:
    sprung = replace(joint, stiffness=stiffness, rest_position=rest)
    cost = cost_natively(system, system.replace_joint(sprung))
    unit = "N/m" if joint.prismatic else "N·m/rad"
    value = f"{stiffness:g} {unit}, slack at {rest:g}"
    return Ignored(field, joint.name, value, readers(IGNORED, IGNORED, IGNORED), *cost, _WITH)


def _read_otherwise(path: Path, system: System, allow: Sequence[Path]) -> Iterator[Ignored]:
    """Placement and mass that a reader takes otherwise than we do, as one row for each reader."""
    for name in ("pinocchio", "mujoco"):
        try:
            reading = read_by(name, path, system, allow=allow)
        except (UnsupportedError, EngineUnavailableError) as error:
            nobody = {"denoc": ACTS, "pinocchio": "–", "mujoco": "–", name: "refuses the file"}
            reason = error.what if isinstance(error, UnsupportedError) else str(error)
            yield Ignored("the whole file", path.name, reason, nobody, None, None, "its own reader was asked")
            continue
        found = differences(placed_bodies(system), reading.placed())
        if found:
            q = start(system)
            apart = np.abs(reading.gravity(q) - _gravity(system, q)).max()
            here = {"denoc": ACTS, "pinocchio": ACTS, "mujoco": ACTS, name: "reads otherwise"}
            how = "gravity forces of its own reading against ours, in one pose"
            yield Ignored("placement and mass", path.name, phrase(found), here, float(apart), None, how)


def _gravity(system: System, q: Any) -> Any:
    from harness.denoc import Denoc

    return Denoc(system).gravity(q)
