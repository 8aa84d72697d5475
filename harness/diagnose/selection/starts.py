"""Where the search for an effect begins: its own starting values, or a scan where no slope leads to the truth."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.problem.problem import Problem
from harness.effects.effect import Parameter
from harness.effects.scale import swings
from harness.system import System

Array = NDArray[np.float64]

Ray = tuple[Array, ...]
"""Starting values (SI) whose effects on the prediction are combined linearly: one vector, or two a quarter wave apart."""

FOLLOWS = 12.0  # times a joint's own frequency; beyond, a shaken base moves it by less than a hundredth as much
UNSEEN = 1e-3  # of a motion's extent
MOST_PERIODS = 60  # of a cogging torque in one turn
REACH = (
    0.15,
    0.25,
    0.35,
    0.45,
    0.55,
    0.65,
    0.72,
    0.79,
    0.85,
    0.9,
    0.94,
    0.97,
    0.99,
)  # shares of the motion's extent at which a stop may stand
LARGER = 1.5  # times the special case's amplitude: a start for amplitudes that it does not have
GONE = 1e-3  # of the first size of a law
CUT = (0.8, 0.95, 0.999)  # shares of a channel's extent at which it may saturate


def rays(candidate: Candidate, problem: Problem) -> list[Ray]:
    """Starting points of a candidate, from the recordings where the effect says that only they can give them."""
    parameters = candidate.effect.parameters
    names = [p.name for p in parameters]
    choices: list[tuple[float, ...]] = []
    quarter = names.index("phase") if "phase" in names else None
    for k, parameter in enumerate(parameters):
        values = parameter.start_values(candidate.references)
        if parameter.name == "phase":
            values = (0.0,)
        elif parameter.name == "periods":
            values = tuple(np.arange(max(parameter.lower, 1.0), MOST_PERIODS + 1.0))
        elif parameter.name == "frequency" and quarter is not None:
            values = tuple(_frequencies(problem))
        elif parameter.name == "angle" and parameter.search == "range":
            values = _stops(candidate, problem)
        elif parameter.name == "limit" and parameter.search == "range":
            values = _limits(candidate, problem)
        elif k > 0 and quarter is not None:
            values = values[:1]
        elif k > 0 and parameters[0].search == "range":
            # How strongly it acts is read off the linear view; only the proportion of these is to be tried.
            values = values[-1:] if k == 1 else values[-2:]
        choices.append(values)
    points = [np.array(point) for point in product(*choices)]
    if "torque" in names and "stiffness" in names:
        # A contact that gives less than any sensor resolves is one that does not give, and costs stiff equations to say so.
        torque, stiffness = names.index("torque"), names.index("stiffness")
        extent = _extent(candidate, problem, "position") or (-1.0, 1.0)
        least = UNSEEN * (extent[1] - extent[0])
        points = [p for p in points if p[torque] >= least * p[stiffness]] or points[:1]
    if names == ["stiffness", "rest_angle"]:
        # Linear in the stiffness and in the torque at zero.
        return [
            (np.array([p[0], 0.0]), np.array([p[0], parameters[1].scale(candidate.references)])) for p in points[:1]
        ]
    if names == ["quadratic", "cubic"]:
        sizes = [p.scale(candidate.references) for p in parameters]
        return [(np.array([sizes[0], 0.0]), np.array([0.0, sizes[1]]))]
    if quarter is None:
        return [(point,) for point in points]
    pairs: list[Ray] = []
    for point in points:
        other = point.copy()
        other[quarter] = 0.5 * np.pi
        pairs.append((point, other))
    return pairs


def _frequencies(problem: Problem) -> Array:
    """Frequencies [Hz] about half the resolution of the longest recording apart, up to where a joint no longer follows."""
    longest = max(run.duration for run in problem.train)
    swing = max(swings(problem.system)) / (2.0 * np.pi)
    top = max(min(0.25 / max(run.interval for run in problem.train), FOLLOWS * swing), 4.0)
    spacing = max(0.5 / longest, 0.04)
    low = np.arange(spacing, 4.0, spacing)
    return np.concatenate([low, np.arange(4.0, top, 2.0 * spacing)])


def _extent(candidate: Candidate, problem: Problem, suffix: str) -> tuple[float, float] | None:
    for c, channel in enumerate(problem.channels):
        if channel.name == candidate.site or channel.name == f"{candidate.site}.{suffix}":
            pooled = np.concatenate([run.values[c] for run in problem.train])
            return float(np.nanmin(pooled)), float(np.nanmax(pooled))
    return None


def _stops(candidate: Candidate, problem: Problem) -> tuple[float, ...]:
    extent = _extent(candidate, problem, "position")
    if extent is None:
        return candidate.effect.parameters[0].start_values(candidate.references)
    low, high = extent
    return tuple([share * high for share in REACH if high > 0.0] + [share * low for share in REACH if low < 0.0])


def _limits(candidate: Candidate, problem: Problem) -> tuple[float, ...]:
    extent = _extent(candidate, problem, "position")
    if extent is None:
        return candidate.effect.parameters[0].start_values(candidate.references)
    return tuple(share * max(abs(extent[0]), abs(extent[1])) for share in CUT)


def calmed(candidate: Candidate, start: Array) -> Array | None:
    """Starting values whose own vibration dies out quickly; none where there is no such vibration.

    One that goes on has a valley at every phase. What gives without ringing has one, and leads to where the ringing is found.
    """
    if not candidate.effect.adds_coordinates:
        return None
    out = start.copy()
    for k, parameter in enumerate(candidate.effect.parameters):
        if parameter.name in ("damping", "damping_ratio"):
            out[k] = max(out[k], *parameter.start_values(candidate.references))
    return None if np.array_equal(out, start) else out


def foretold(candidate: Candidate, system: System, start: Array) -> Array | None:
    """Starting values with what theory foretells of them in their place; none where it does not."""
    reshape = candidate.effect.reshape
    if reshape is None or reshape.expected is None:
        return None
    values = candidate.effect.named(start) | dict(reshape.expected(system, candidate.site))
    return np.array([values[name] for name in candidate.effect.parameter_names])


def alongside(candidate: Candidate, modified: Candidate, values: Array) -> list[tuple[Array, Array]]:
    """Starting values of an effect and of what it modifies, with which both together act about as that does at ``values``."""
    together = candidate.effect.alongside
    if together is None:
        return []
    found = []
    for point in product(*(p.start_values(candidate.references) for p in candidate.effect.parameters)):
        other = together(candidate.effect.named(point), modified.effect.named(values), candidate.references)
        found.append((np.array(point), np.array([other[name] for name in modified.effect.parameter_names])))
    return found


def of_a_contact(first: Parameter, parameter: Parameter) -> bool:
    """Whether a parameter is the stiffness of a contact that slides under the torque which is its effect's ``first``."""
    return (first.name, parameter.name) == ("torque", "stiffness")


def like(wider: Candidate, amplitude: float, *, by_way: bool = False) -> list[Array]:
    """Starting values of a more general law that acts about as strongly as its special case of ``amplitude``.

    by_way: with contacts that give over the ways that are usual for a friction of typical size, so that as weak as the friction is
    its stiffness; else with the usual stiffnesses.
    """
    first, *others = wider.effect.parameters
    share = amplitude / first.scale(wider.references) if by_way else 1.0
    choices: list[tuple[float, ...]] = []
    for parameter in others:
        usual = parameter.start_values(wider.references)
        if parameter.unit == first.unit:
            usual = (LARGER * amplitude,)
        elif of_a_contact(first, parameter):
            usual = tuple(share * value for value in usual)
        choices.append(usual)
    points = [np.array([amplitude, *rest]) for rest in product(*choices)]
    return [np.clip(p, wider.effect.lower, wider.effect.upper) for p in points]


def shapeless(candidate: Candidate, values: Array) -> bool:
    """Whether a law acts as its special case for want of the second size that makes it another."""
    if not candidate.effect.simpler:
        return False
    first, *others = candidate.effect.parameters
    sizes = [value for p, value in zip(others, values[1:], strict=True) if p.unit == first.unit]
    return any(abs(size) < GONE * abs(values[0]) for size in sizes)
