"""The coordinates in which a fit moves the parameters of effects: in units of their natural sizes, or as logarithms."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.prediction.constants import CLOCK_MARGIN, LARGEST_SIZE, LOGARITHMIC_SPAN, REACH, WEAKEST_RATIO
from harness.diagnose.problem.hypothesis import Candidate
from harness.effects.effect import Parameter

Array = NDArray[np.float64]


@lru_cache(maxsize=1024)
def is_logarithmic(candidate: Candidate) -> NDArray[np.bool_]:
    """Which parameters are fitted as logarithms, shape (k,), not to be written to.

    Positive ones whose absence lies at infinity, that cannot be zero, or whose starting values span a decade.
    """

    def spans(parameter: Parameter) -> bool:
        positive = [s for s in parameter.starts if s > 0.0]
        return len(positive) > 1 and max(positive) >= LOGARITHMIC_SPAN * min(positive)

    out = np.array(
        [
            p.lower >= 0.0 and (not np.isfinite(p.neutral) or p.lower > 0.0 or (k > 0 and spans(p)))
            for k, p in enumerate(candidate.effect.parameters)
        ],
        dtype=bool,
    )
    out.setflags(write=False)
    return out


def from_internal(candidate: Candidate, u: Array) -> Array:
    """SI values from the fit's own coordinates: in units of the typical scale, or its logarithm."""
    log = is_logarithmic(candidate)
    scales = candidate.scales
    values = np.asarray(scales * u)
    if log.any():
        # What is fitted as a logarithm may run away before a bound stops it; e^±40 is far beyond either.
        values[..., log] = scales[log] * np.exp(np.minimum(np.maximum(u[..., log], -40.0), 40.0))
    return values


def to_internal(candidate: Candidate, values: Array) -> Array:
    """The inverse of ``from_internal``."""
    log = is_logarithmic(candidate)
    ratio = np.asarray(values, dtype=np.float64) / candidate.scales
    return np.where(log, np.log(np.maximum(ratio, 1e-300)), ratio)


@lru_cache(maxsize=1024)
def internal_bounds(candidate: Candidate, reach: float = REACH) -> tuple[Array, Array]:
    """Physical bounds in the fit's own coordinates, and how far it is searched within them; not to be written to.

    reach: times its starting values, either way, that a logarithm may lie.
    """
    log = is_logarithmic(candidate)
    with np.errstate(divide="ignore"):
        lower = np.where(
            log,
            np.log(np.maximum(candidate.effect.lower, 0.0) / candidate.scales),
            candidate.effect.lower / candidate.scales,
        )
        upper = np.where(
            log,
            np.log(np.maximum(candidate.effect.upper, 0.0) / candidate.scales),
            candidate.effect.upper / candidate.scales,
        )
    if candidate.effect.sensor is not None and candidate.effect.sensor.clock:
        slowest = 1.0 / (1.0 + CLOCK_MARGIN) / candidate.scales
        lower = np.maximum(lower, np.where(log, np.log(slowest), slowest))
    if candidate.effect.adds_coordinates or any(p.search == "size" for p in candidate.effect.parameters):
        # Play or give of next to nothing is none at all, but its equations would be endlessly stiff.
        least = np.array(
            [min((s for s in p.starts if s > 0.0), default=0.0) / reach**2 for p in candidate.effect.parameters]
        )
        lower = np.where(candidate.effect.lower >= 0.0, np.maximum(lower, np.where(log, lower, least)), lower)
    nested = bool(candidate.effect.simpler)
    ends = np.array([_log_reach(p, nested, reach) for p in candidate.effect.parameters]).reshape(-1, 2)
    lower = np.maximum(lower, np.where(log, ends[:, 0], -LARGEST_SIZE))
    upper = np.minimum(upper, np.where(log, ends[:, 1], LARGEST_SIZE))
    lower.setflags(write=False)
    upper.setflags(write=False)
    return lower, upper


def _log_reach(parameter: Parameter, nested: bool, reach: float) -> tuple[float, float]:
    """How far a logarithm may go from the starting values: beyond, the effect is as good as absent or as good as rigid."""
    if np.isfinite(parameter.neutral) and parameter.neutral != 0.0:
        return -np.inf, np.inf  # starting values are counted from there, and physics sets the bounds
    if parameter.unit == "1/rev":
        return -np.inf, np.inf  # scanned, so where its effect lists starting values says nothing about how far it goes
    positive = [s for s in parameter.starts if s > 0.0] or [1.0]
    lowest, highest = min(positive) / reach, max(positive) * reach
    if nested and parameter.name == "stiffness":
        # Where a simpler effect stands at infinite stiffness, going there only makes its equations stiff. Contacts give over a
        # way of their own, so that a weak friction has as weak a stiffness.
        lowest, highest = lowest / WEAKEST_RATIO, max(positive) / 3.0
    return float(np.log(lowest)), float(np.log(highest))


def start_vector(candidate: Candidate) -> Array:
    """First of the effect's own starting values, in the fit's coordinates."""
    values = np.array([p.start_values(candidate.references)[0] for p in candidate.effect.parameters])
    return to_internal(candidate, values)
