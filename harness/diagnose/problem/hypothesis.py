"""A hypothesis: which effects act where, and how much the nominal parameters may move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.problem.constants import FARTHEST_BENT, USUAL_TOLERANCE
from harness.diagnose.problem.problem import Run
from harness.diagnose.problem.windows import Window
from harness.effects.effect import BY_MODEL, Effect
from harness.effects.scale import References, tip_of
from harness.system import Coupling, Joint, Link, Loop, System
from harness.system.description import constant

Array = NDArray[np.float64]

EVERYWHERE = ("viscous_damping", "coulomb_friction")  # what is at one joint of a mechanism as a rule is at all


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect at a site, with the natural sizes there; its identity is ``key``."""

    effect: Effect
    site: str
    references: References

    @property
    def key(self) -> str:
        return f"{self.effect.name}@{self.site}"

    @cached_property
    def scales(self) -> Array:
        """Typical size of each parameter, shape (k,)."""
        return self.effect.scales(self.references)

    @property
    def size(self) -> int:
        return len(self.effect.parameters)

    def surprise(self, values: Sequence[float] | Array) -> float:
        """−2 log of how plausible values of the parameters [SI] are, less its greatest value."""
        total = 0.0
        for parameter, value in zip(self.effect.parameters, values, strict=True):
            if parameter.plausible is not None:
                total += parameter.plausible.surprise(float(value), parameter.neutral, self.references)
        if self.effect.plausible is not None:
            total += self.effect.plausible.surprise(self.effect.named(values), self.references)
        return total

    def own_numbers(self, windows: Sequence[Window], runs: Sequence[Run]) -> int:
        """How many numbers it has that are every window's own: constants, what is remembered of the time before."""
        sensor = self.effect.sensor
        if sensor is None:
            return 0
        inside = sum(runs[window.run].date(window.first) > 0.0 for window in windows)
        return sensor.own_zero * len(windows) + sensor.remembers * inside

    @property
    def out_of_step(self) -> int:
        """One if it is a wave with a phase of its own in every window, else none."""
        return int(self.effect.sensor is not None and self.effect.sensor.courses is not None)


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A set of candidates; the empty one says that nothing is missing."""

    members: tuple[Candidate, ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        return tuple(member.key for member in self.members)

    @property
    def identity(self) -> frozenset[str]:
        return frozenset(self.keys)

    @property
    def things(self) -> int:
        """Number of members that are something by themselves, and no other form of what is there.

        That all joints of a mechanism rub, or all are damped, is one thing.
        """
        own = [member for member in self.members if not member.effect.modifies]
        return len({m.effect.name if m.effect.name in EVERYWHERE else m.key for m in own})

    @property
    def size(self) -> int:
        """Number of effect parameters."""
        return sum(member.size for member in self.members)

    def own_numbers(self, windows: Sequence[Window], runs: Sequence[Run]) -> int:
        """How many numbers the members have that are every window's own."""
        return sum(m.own_numbers(windows, runs) for m in self.members)

    @property
    def out_of_step(self) -> int:
        """Number of members that are waves with a phase of their own in every window."""
        return sum(m.out_of_step for m in self.members)

    def span(self, k: int) -> slice:
        """Where member ``k`` has its parameters in the effect part of the parameter vector."""
        start = sum(member.size for member in self.members[:k])
        return slice(start, start + self.members[k].size)

    def with_(self, candidate: Candidate) -> Hypothesis:
        return Hypothesis((*self.members, candidate))

    def without(self, k: int) -> Hypothesis:
        return Hypothesis(self.members[:k] + self.members[k + 1 :])


@dataclass(frozen=True)
class Nominal:
    """One nominal quantity that is uncertain by its tolerance: ``what`` of ``name``, scaled by exp(tolerance · z)."""

    kind: str  # mass, length, inertia, armature, damping, stiffness, payload
    name: str
    tolerance: float = USUAL_TOLERANCE

    @property
    def key(self) -> str:
        return f"{self.kind}@{self.name}"


def nominal_quantities(system: System) -> tuple[Nominal, ...]:
    """Every nominal mass, length, inertia and stiffness that is not zero."""
    found: list[Nominal] = []
    for joint, link in zip(system.joints, system.links, strict=True):
        if joint.movable:
            found += [
                Nominal(kind, joint.name) for kind in ("armature", "damping", "stiffness") if getattr(joint, kind) > 0.0
            ]
        beam = link.beam
        if beam is not None:
            found += [Nominal("mass", link.name), Nominal("length", link.name), Nominal("stiffness", link.name)]
            if beam.payload > 0.0:
                found.append(Nominal("payload", link.name))
            continue
        if link.mass > 0.0:
            found.append(Nominal("mass", link.name))
            if np.linalg.norm(link.com) > 0.0 or any(j.parent == link.name for j in system.joints):
                found.append(Nominal("length", link.name))
            if np.trace(link.inertia) > 0.0:
                found.append(Nominal("inertia", link.name))
    return tuple(replace(q, tolerance=system.tolerances.get(q.key, system.tolerance)) for q in found)


def tolerances(quantities: Sequence[Nominal]) -> Array:
    """Relative 1σ of each quantity, (k,)."""
    return np.array([quantity.tolerance for quantity in quantities])


def bent_by(quantities: Sequence[Nominal], z: Array) -> Array:
    """By how much quantities are multiplied that deviate by z (k,) [σ of their tolerances]: a step of a fit may go anywhere, and no
    mechanism has a length of nothing or without end.
    """
    return np.asarray(np.exp(np.clip(tolerances(quantities) * z, -FARTHEST_BENT, FARTHEST_BENT)))


def scaled(system: System, quantities: Sequence[Nominal], factors: Sequence[float]) -> System:
    """The system with its nominal quantities multiplied by ``factors``.

    Links keep the ends that the nominal model gives them, however their inertia is bent: an end worked out anew goes as a square
    root beside a uniform rod's inertia.
    """
    joints: dict[str, Joint] = {joint.name: joint for joint in system.joints}
    links: dict[str, Link] = {link.name: link for link in _with_ends(system)}
    rigid: dict[str, dict[str, float]] = {}
    for quantity, factor in zip(quantities, factors, strict=True):
        kind, name = quantity.kind, quantity.name
        if factor == 1.0:
            continue
        if name in joints and kind in ("armature", "damping", "stiffness"):
            joints[name] = replace(joints[name], **{kind: getattr(joints[name], kind) * factor})
            continue
        if links[name].beam is not None:
            links[name] = _scaled_beam(links[name], kind, factor)
        else:
            rigid.setdefault(name, {})[kind] = factor
        if kind == "length":
            for key, joint in joints.items():
                if joint.parent == name:
                    joints[key] = replace(joint, xyz=constant(joint.xyz * factor))
    lengths = {q.name: f for q, f in zip(quantities, factors, strict=True) if q.kind == "length"}
    for name, own in rigid.items():
        links[name] = _scaled_rigid(links[name], own.get("mass", 1.0), own.get("length", 1.0), own.get("inertia", 1.0))
    return replace(
        system,
        joints=tuple(joints[joint.name] for joint in system.joints),
        links=tuple(links[link.name] for link in system.links),
        loops=tuple(_longer(loop, lengths) for loop in system.loops),
    )


def _longer(loop: Loop | Coupling, factors: Mapping[str, float]) -> Loop | Coupling:
    """A cut joint whose frames go with the ends of the links that they are on."""
    if isinstance(loop, Coupling) or not factors:
        return loop
    first, second = (
        replace(frame, xyz=constant(frame.xyz * factors[frame.link])) if frame.link in factors else frame
        for frame in (loop.first, loop.second)
    )
    return replace(loop, first=first, second=second)


@lru_cache(maxsize=16)
def _with_ends(system: System) -> tuple[Link, ...]:
    """Links that say where they end, rigid ones that end anywhere."""

    def with_end(link: Link) -> Link:
        end = tip_of(link, system)
        return link if link.beam is not None or not end.any() else replace(link, end=constant(end))

    return tuple(with_end(link) for link in system.links)


def _scaled_rigid(link: Link, mass: float, length: float, inertia: float) -> Link:
    """A rigid link with mass, length and inertia about its centre of mass scaled; a heavier one has as much more inertia."""
    return replace(
        link,
        mass=link.mass * mass,
        com=constant(link.com * length),
        inertia=constant(link.inertia * mass * inertia),
        end=None if link.end is None else constant(link.end * length),
    )


def _scaled_beam(link: Link, kind: str, factor: float) -> Link:
    """A flexible link with mass, length, bending stiffness or payload scaled; the rigid-body part follows."""
    beam = link.beam
    assert beam is not None
    if kind == "stiffness":
        return replace(
            link,
            beam=replace(
                beam,
                bending_stiffness=beam.bending_stiffness * factor,
                bending_stiffness2=beam.bending_stiffness2 * factor,
                torsional_stiffness=beam.torsional_stiffness * factor,
            ),
        )
    from harness.system.flexible_link import flexible_link

    if kind == "mass":
        beam = replace(beam, mass=beam.mass * factor, polar_inertia=beam.polar_inertia * factor)
    elif kind == "length":
        beam = replace(beam, length=beam.length * factor)
    else:
        beam = replace(beam, payload=beam.payload * factor, payload_inertia=constant(beam.payload_inertia * factor))
    return flexible_link(link.name, beam)


def compatible(hypothesis: Hypothesis, candidate: Candidate) -> bool:
    """Whether a candidate may join: not there already, no special case (or general case) of what is at its site, and with what it
    modifies there."""
    modified = candidate.effect.modifies
    if (
        modified
        and BY_MODEL not in modified
        and not any(m.site == candidate.site and m.effect.name in modified for m in hypothesis.members)
    ):
        return False
    for member in hypothesis.members:
        if member.key == candidate.key or (_own_law(member) and _own_law(candidate)):
            return False
        if member.site == candidate.site and set(member.effect.modifies) & set(modified):
            return False
        if contains(member, candidate) or contains(candidate, member):
            return False
        if member.effect.adds_coordinates and candidate.effect.adds_coordinates:
            return False
        if member.site == candidate.site and _same_input(member.effect, candidate.effect):
            return False
        if (
            member.effect.law is not None
            and candidate.effect.law is not None
            and member.site == candidate.site
            and set(member.effect.law.slots) & set(candidate.effect.law.slots)
        ):
            return False
    return True


def _same_input(one: Effect, other: Effect) -> bool:
    """Whether two effects do the same to the effort of a joint: of their product neither has a share of its own."""
    return one.input is not None and other.input is not None and one.input.apply is other.input.apply


def dear(candidate: Candidate) -> bool:
    """Whether runs with the candidate take many times as long: it adds coordinates, or a law that no fast method knows."""
    return _own_law(candidate) or (candidate.effect.adds_coordinates and not candidate.effect.switch)


def _own_law(candidate: Candidate) -> bool:
    """Whether the candidate needs a law that is compiled for it; the lanes carry one."""
    return candidate.effect.user is not None or candidate.effect.name == "backlash"


def contains(wider: Candidate, special: Candidate) -> bool:
    """Whether one candidate's law has the other's, at the same site, as a special case."""
    return wider.site == special.site and special.effect.name in wider.effect.simpler


def whole_numbers(candidate: Candidate) -> NDArray[np.bool_]:
    """Which parameters are whole numbers and therefore searched, not fitted: a force over an angle closes on itself in a turn."""
    return np.array([p.name == "periods" and p.unit == "1/rev" for p in candidate.effect.parameters], dtype=bool)
