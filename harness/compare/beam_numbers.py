"""Which number of a mechanism that bends would explain a difference of its answers, and by how much it is off.

Every number is moved alone, and what that does to the native answer is held against the difference. Several that do the same (mass
and stiffness of a clamped beam, by its frequencies) cannot be told apart, and are all named. Beside the numbers of the description
stand what of a beam and its payload may be counted in the rigid hub as well, and how much of the foreshortening is counted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.compare.numbers_of import VANISHES, Number, numbers
from harness.system import System

Array = NDArray[np.float64]
Answer = Callable[[System], Array]
Blend = Callable[[Array, Array, float], Array]

# How far a number is moved for its effect; a share of the difference that may be left unexplained; and how much more of it
# by numbers that count as one as good as the best.
_STEP, _LEFT, _ALIKE = 1e-3, 0.1, 0.02
# Effects below this share of the largest are rounding.
_NOTHING = 1e-9
MISTAKES = (0.0, 0.5, 2.0)
# What no beam can be: numbers are moved without asking whether a body could have them.
_IMPOSSIBLE = (ValueError, ArithmeticError, np.linalg.LinAlgError)


@dataclass(frozen=True)
class Explanation:
    """A number, by what factor the other engine takes it, and the share of the difference that this leaves."""

    number: Number
    factor: float
    left: float


def linear(without: Array, whole: Array, factor: float) -> Array:
    """What an answer is with a part of something, by the answers without it and with all of it."""
    return np.asarray(without + factor * (whole - without))


def squares(without: Array, whole: Array, factor: float) -> Array:
    """The same of logarithms of frequencies, whose squares go with the stiffness (Southwell)."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(0.5 * np.log(linear(np.exp(2.0 * without), np.exp(2.0 * whole), factor)))


def explain(
    system: System, answer: Answer, apart: Array, blend: Blend = linear, *, left: float = _LEFT
) -> list[Explanation]:
    """The numbers that explain a difference ``apart`` from the native answer, the best first; none where none does.

    answer: of a system, a flat array such as logarithms of frequencies; apart: the other engine's less the native one's.
    blend: an answer with a part of what is there or not. left: share of the difference that a number may leave.
    """
    base, whole = answer(system), float(np.linalg.norm(apart))
    if not np.isfinite(apart).all() or whole == 0.0 or base.shape != apart.shape:
        return []

    def answers(number: Number) -> Callable[[float], Array]:
        if number.without is None:
            return lambda factor: answer(number.scaled(factor))
        without = answer(number.without)
        return lambda factor: blend(without, base, factor)

    effects: list[tuple[Number, Callable[[float], Array], Array]] = []
    for number in numbers(system):
        try:
            moved = answers(number)
            effects.append((number, moved, (moved(1.0 + _STEP) - base) / _STEP))
        except _IMPOSSIBLE:
            continue
    largest = max((float(np.linalg.norm(effect)) for _, _, effect in effects), default=0.0)
    found = []
    for number, moved, effect in effects:
        square = float(effect @ effect)
        if not np.isfinite(square) or np.sqrt(square) <= _NOTHING * largest:
            continue
        found.append(_refined(number, effect, moved, base, apart, whole))
    if not any(one.left <= left for one in found):
        found = [_mistaken(number, moved, base, apart, whole) for number, moved, _ in effects]
    # Of what does the same, first what is there once or not at all.
    found.sort(key=lambda one: (round(one.left, 6), one.number.unlikely(one.factor)))
    return [one for one in found if one.left <= left and one.left <= 2.0 * found[0].left + _ALIKE]


def _refined(
    number: Number, effect: Array, answer: Callable[[float], Array], base: Array, apart: Array, whole: float
) -> Explanation:
    """The factor by secants: what a change of a per cent does is not in proportion to it any more."""
    change, best = 0.0, Explanation(number, 1.0, 1.0)
    slope, left = effect, apart
    for _ in range(3):
        change += float(slope @ left) / float(slope @ slope)
        if not number.least < change < 20.0:
            break
        try:
            moved = answer(1.0 + change) - base
        except _IMPOSSIBLE:
            break
        left = apart - moved
        share = float(np.linalg.norm(left)) / whole
        if np.isfinite(share) and share < best.left:
            best = Explanation(number, 1.0 + change, share)
        if change == 0.0:
            break
        slope = moved / change
        if not float(slope @ slope) > 0.0:
            break
    return best


def _mistaken(number: Number, answer: Callable[[float], Array], base: Array, apart: Array, whole: float) -> Explanation:
    """The best of what mistakes make of a number, which may do more than its slope says: forgotten, halved, doubled."""
    best = Explanation(number, 1.0, 1.0)
    for factor in MISTAKES if number.place.get("value") in VANISHES else MISTAKES[1:]:
        try:
            share = float(np.linalg.norm(apart - (answer(factor) - base))) / whole
        except _IMPOSSIBLE:
            continue
        if np.isfinite(share) and share < best.left:
            best = Explanation(number, factor, share)
    return best


def place_of(found: list[Explanation]) -> dict[str, object]:
    """Of the best; ``or``: what else of the same link or joint does the same, with commas between."""
    place = dict(found[0].number.place)
    owner = {key: name for key, name in place.items() if key != "value"}
    others = [str(one.number.place["value"]) for one in found[1:4] if owner.items() <= one.number.place.items()]
    alike = [value for value in dict.fromkeys(others) if value != place["value"]]
    return place | ({"or": ", ".join(alike)} if alike else {})


def sentence(found: list[Explanation], other: str) -> str:
    """For a table: ``exudyn_ancf moves as with mass of link 'rod' 1.01 times as large``."""
    said = " or ".join(one.number.said(one.factor) for one in found[:4])
    return f"{other} answers as with {said}" if said else ""
