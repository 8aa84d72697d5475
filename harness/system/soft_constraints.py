"""MuJoCo's soft constraints of a joint, dry friction and a limit, from the effects that say what they are to its solver parameters.

A constraint of impedance d acts through ``invweight``, the joint's inverse inertia in the model's own position, with an inertia
J = d / (1 − d) / invweight: so the impedance that an inertia asks for is J invweight / (1 + J invweight).
Source: MuJoCo's documentation, Computation: constraint model, solver parameters.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import copysign

from harness.system.description import System

# Where a joint that is limited on one side has its other limit [rad or m].
FAR = 1e6

# MuJoCo's defaults of ``solref`` and ``solimp``.
SOLREF, SOLIMP = (0.02, 1.0), (0.9, 0.95, 0.001, 0.5, 2.0)

Solver = tuple[tuple[float, float], float]
"""``solref``, and the impedance that is the first two numbers of ``solimp``."""


def soft_friction(system: System) -> dict[str, Mapping[str, float]]:
    """Parameters of ``friction_softness`` by joint, where the description itself states the friction."""
    rubs = {joint.name for joint in system.movable_joints if joint.friction > 0.0}
    soft = {a.site: a.parameters for a in system.attachments if a.effect == "friction_softness"}
    return {site: parameters for site, parameters in soft.items() if site in rubs}


def soft_stops(system: System) -> dict[str, Mapping[str, float]]:
    """Parameters of stops that have an inertia, those of ``end_stop`` and ``stop_inertia`` together, by joint."""
    stops = {a.site: a.parameters for a in system.attachments if a.effect == "end_stop"}
    heavy = {a.site: a.parameters for a in system.attachments if a.effect == "stop_inertia"}
    return {site: {**stops[site], **heavy[site]} for site in stops if heavy.get(site, {}).get("inertia", 0.0) > 0.0}


def _impedance(inertia: float, invweight: float) -> float:
    return inertia * invweight / (1.0 + inertia * invweight)


def friction_solver(soft: Mapping[str, float], invweight: float) -> Solver:
    """Of dry friction as soft as ``friction_softness`` says."""
    impedance = _impedance(soft["inertia"], invweight)
    return (2.0 * soft["time"] / impedance, 1.0), impedance


def limit_solver(stop: Mapping[str, float], invweight: float) -> Solver:
    """Of a limit that pushes as ``end_stop`` and ``stop_inertia`` say."""
    impedance = _impedance(stop["inertia"], invweight)
    rate = impedance / stop["inertia"]
    return (-stop["stiffness"] * rate, -stop["damping"] * rate), impedance


def limit_law(solref: tuple[float, float], solimp: tuple[float, float], invweight: float) -> tuple[float, float, float]:
    """Stiffness, damping and inertia of a limit from MuJoCo's numbers, its impedance the one that it has beyond its width.

    The inverse of ``limit_solver``: ``solref`` is a time constant and a damping ratio, or, negative, stiffness and damping.
    """
    impedance = min(max(solimp[1], 1e-4), 0.9999)  # MuJoCo's own bounds
    inertia = impedance / (1.0 - impedance) / invweight
    first, second = solref
    if first <= 0.0:
        return -first * inertia / impedance, -second * inertia / impedance, inertia
    time, ratio = first, second
    return inertia / (impedance * time**2 * ratio**2), 2.0 * inertia / (impedance * time), inertia


def as_soft_as_by_default(solref: Iterable[float], solimp: Iterable[float]) -> bool:
    """Whether a constraint's solver parameters are those that MuJoCo gives where a file states none."""
    return tuple(solref) == SOLREF and tuple(solimp) == SOLIMP


def limits(stop: Mapping[str, float]) -> tuple[float, float]:
    """The joint's range with a stop on one side."""
    low, high = sorted((stop["angle"], -copysign(FAR, stop["angle"])))
    return low, high
