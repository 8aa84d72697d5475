"""Where the search for an effect begins: its own starting values, or a scan where no slope leads to the truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.problem.problem import Problem
from harness.diagnose.selection.constants.starts import (
    FOLLOWED_FREQUENCY_RATIO,
    GONE_SIZE,
    LARGER_AMPLITUDE,
    MOST_COGGING_PERIODS,
    SATURATION_PLACES,
    STOP_PLACES,
    UNSEEN_EXTENT,
)
from harness.effects.effect import Parameter
from harness.effects.scale import swings

Array = NDArray[np.float64]

Ray = tuple[Array, ...]
"""Starting values (SI) whose effects on the prediction are combined linearly: one vector, or two a quarter wave apart."""


@dataclass(frozen=True, eq=False)
class Number:
    """One number of a candidate that starting values are asked of: the ``place`` it has among them."""

    candidate: Candidate
    problem: Problem
    place: int

    @property
    def parameter(self) -> Parameter:
        return self.candidate.effect.parameters[self.place]

    @property
    def usual(self) -> tuple[float, ...]:
        """Its effect's own starting values."""
        return self.parameter.start_values(self.candidate.references)

    @property
    def of_a_wave(self) -> bool:
        """Whether there is a phase, so that two a quarter wave apart are combined."""
        return "phase" in self.candidate.effect.parameter_names

    def scanned(self, name: str) -> bool:
        """Whether it is the number of that name, to be looked for over the range of the recordings."""
        return self.parameter.name == name and self.parameter.search == "range"


VALUES: tuple[tuple[Callable[[Number], bool], Callable[[Number], tuple[float, ...]]], ...] = (
    (lambda n: n.parameter.name == "phase", lambda n: (0.0,)),
    (
        lambda n: n.parameter.name == "periods",
        lambda n: tuple(np.arange(max(n.parameter.lower, 1.0), MOST_COGGING_PERIODS + 1.0)),
    ),
    (lambda n: n.parameter.name == "frequency" and n.of_a_wave, lambda n: tuple(_frequencies(n.problem))),
    (lambda n: n.scanned("angle"), lambda n: _stops(n.candidate, n.problem)),
    (lambda n: n.scanned("limit"), lambda n: _limits(n.candidate, n.problem)),
    (lambda n: n.place > 0 and n.of_a_wave, lambda n: n.usual[:1]),
    # How strongly it acts is read off the linear view; only the proportion of these is to be tried.
    (
        lambda n: n.place > 0 and n.candidate.effect.parameters[0].search == "range",
        lambda n: n.usual[-1:] if n.place == 1 else n.usual[-2:],
    ),
    (lambda n: True, lambda n: n.usual),
)
"""Which values of a number are tried, by what kind of number it is; the first that holds."""

PAIRS: dict[tuple[str, ...], Callable[[Candidate, Array], Ray]] = {
    # Linear in the stiffness and in the torque at zero.
    ("stiffness", "rest_angle"): lambda c, p: (
        np.array([p[0], 0.0]),
        np.array([p[0], c.effect.parameters[1].scale(c.references)]),
    ),
    ("quadratic", "cubic"): lambda c, p: (np.array([c.scales[0], 0.0]), np.array([0.0, c.scales[1]])),
}
"""Laws that are linear in two numbers, by these: the two points that are combined."""


def rays(candidate: Candidate, problem: Problem) -> list[Ray]:
    """Starting points of a candidate, from the recordings where the effect says that only they can give them."""
    names = candidate.effect.parameter_names
    numbers = [Number(candidate, problem, place) for place in range(len(names))]
    choices = [next(values(n) for holds, values in VALUES if holds(n)) for n in numbers]
    points = _that_give(candidate, problem, [np.array(point) for point in product(*choices)])
    if tuple(names) in PAIRS:
        return [PAIRS[tuple(names)](candidate, point) for point in points[:1]]
    if "phase" not in names:
        return [(point,) for point in points]
    quarter = np.array([0.5 * np.pi if name == "phase" else 0.0 for name in names])
    return [(point, point + quarter) for point in points]


def _that_give(candidate: Candidate, problem: Problem, points: list[Array]) -> list[Array]:
    """Points without contacts that give less than any sensor resolves: they do not give, and cost stiff equations to say so."""
    names = list(candidate.effect.parameter_names)
    if "torque" not in names or "stiffness" not in names:
        return points
    torque, stiffness = names.index("torque"), names.index("stiffness")
    extent = _extent(candidate, problem, "position") or (-1.0, 1.0)
    least = UNSEEN_EXTENT * (extent[1] - extent[0])
    return [p for p in points if p[torque] >= least * p[stiffness]] or points[:1]


def _frequencies(problem: Problem) -> Array:
    """Frequencies [Hz] about half the resolution of the longest recording apart, up to where a joint no longer follows."""
    longest = max(run.duration for run in problem.train)
    swing = max(swings(problem.system)) / (2.0 * np.pi)
    top = max(min(0.25 / max(run.interval for run in problem.train), FOLLOWED_FREQUENCY_RATIO * swing), 4.0)
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
    return tuple(
        [share * high for share in STOP_PLACES if high > 0.0] + [share * low for share in STOP_PLACES if low < 0.0]
    )


def _limits(candidate: Candidate, problem: Problem) -> tuple[float, ...]:
    extent = _extent(candidate, problem, "position")
    if extent is None:
        return candidate.effect.parameters[0].start_values(candidate.references)
    return tuple(share * max(abs(extent[0]), abs(extent[1])) for share in SATURATION_PLACES)


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
            usual = (LARGER_AMPLITUDE * amplitude,)
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
    return any(abs(size) < GONE_SIZE * abs(values[0]) for size in sizes)
