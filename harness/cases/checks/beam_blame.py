"""What of a beam is to blame where its frequencies or its motion leave the line."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from harness.cases.case import Array
from harness.compare.beam_numbers import explain, sentence
from harness.compare.spectrum import match_modes
from harness.denoc import Denoc
from harness.system import System

Blame = tuple[str, dict[str, object] | None]


def by_frequencies(
    system: System,
    other: str,
    true: Array,
    ratios: Mapping[int, float],
    *,
    mode: int | None = None,
    at: Array | None = None,
) -> Blame:
    """The number that the ratios of found to true frequencies, by mode, would come of.

    other: who found them; mode: the worst one, counted from 0; at: the state they are about, zero if None. With one mode alone
    anything explains it, and nothing is named.
    """
    place: dict[str, object] = {} if mode is None else {"mode": mode + 1}
    chosen = sorted(ratios)
    start = np.zeros(len(system.coordinate_names)) if at is None else at
    own = np.asarray(Denoc(system).frequencies(start))
    pairs = dict(match_modes(np.asarray(true), own))
    chosen = [k for k in chosen if k in pairs]
    if len(chosen) < 2:
        return "", place or None
    where = [pairs[k] for k in chosen]

    def answer(of: System) -> Array:
        return np.log(np.asarray(Denoc(of).frequencies(start))[where])

    found = explain(system, answer, np.log([ratios[k] for k in chosen]))
    if not found:
        return "no one number of the description explains all modes: shapes, stiffening or how it is mounted", place
    return sentence(found, other), place | found[0].number.place


def by_motion(system: System, other: str, answer: Callable[[System], Array], apart: Array) -> Blame:
    """The number that a difference of two motions would come of."""
    found = explain(system, answer, apart)
    if not found:
        return "no one number of the description explains it: what is read, a torque or a law of motion", None
    return sentence(found, other), dict(found[0].number.place)
