"""What links carry in one recording and not in another: known weights, by a model of the rig for each recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.system import System
from harness.system.inertia import inertial_numbers, with_inertial_numbers
from harness.system.write_toml import to_toml

Array = NDArray[np.float64]


def payload(system: System, other: System) -> Mapping[str, Array]:
    """By how much the ``inertial_numbers`` (10,) of links differ in another model of the same rig; links that do only.

    Raises InputError where anything but the mass, centre and inertia of rigid links differs.
    """
    if other is system:
        return {}
    named = {link.name: link for link in system.links}
    if other.joint_names != system.joint_names or {link.name for link in other.links} != named.keys():
        raise InputError(
            f"model {other.name!r} is not the mechanism of {system.name!r}: joints or links have other names",
            mend="give models that differ in what their links carry",
            source=other.source,
        )
    emptied = [
        replace(link, mass=named[link.name].mass, com=named[link.name].com, inertia=named[link.name].inertia)
        for link in other.links
    ]
    alike = replace(
        other, name=system.name, links=tuple(emptied), tolerance=system.tolerance, tolerances=system.tolerances
    )
    ours, theirs = (to_toml(one)[0].splitlines() for one in (system, alike))
    line = next((b for a, b in zip(ours, theirs, strict=False) if a != b), None)
    if line is not None or len(ours) != len(theirs):
        what = f" ({line.strip()})" if line and line.strip() else ""
        raise InputError(
            f"model {other.name!r} differs from {system.name!r} in more than what its links carry{what}",
            mend="models of one rig may differ in masses, centres and inertias of rigid links",
            source=other.source,
        )
    found = {link.name: inertial_numbers(link) - inertial_numbers(named[link.name]) for link in other.links}
    differing = {name: change for name, change in found.items() if np.any(change != 0.0)}
    bending = [name for name in differing if named[name].flexible]
    if bending:
        raise InputError(
            f"link {bending[0]!r} bends, and carries something else in model {other.name!r}",
            mend="diagnose the recordings of each payload by themselves",
            source=other.source,
        )
    return differing


def carrying(system: System, change: Mapping[str, Array]) -> System:
    """The system with its links carrying so much more: the inverse of ``payload``."""
    links = [
        with_inertial_numbers(link, inertial_numbers(link) + change[link.name]) if link.name in change else link
        for link in system.links
    ]
    return replace(system, links=tuple(links))


def one_each(systems: Sequence[System], recordings: int) -> list[System]:
    """A model for each recording: the one that all share, or as many as there are recordings."""
    if len(systems) == 1:
        return list(systems) * recordings
    if len(systems) != recordings:
        raise InputError(
            f"{len(systems)} models for {recordings} recording{'' if recordings == 1 else 's'}",
            mend="give one model for all, or one for each recording in their order, the one held out last",
        )
    return list(systems)
