"""The next experiment, where efforts leave something that they cannot tell apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from harness.diagnose.problem.hypothesis import Candidate

# What makes a joint heavier to move: some by its weight as well, some by inertia alone.
WEIGHTS = ("payload_mass", "com_offset")
INERTIAS = ("added_inertia",)

Pair = tuple[Candidate, Candidate]


def next_experiment(pairs: Sequence[Pair], *, gravity: bool) -> dict[str, Any]:
    """The experiment that would part what cannot be told apart; gravity: whether it acts on the mechanism."""
    for pair in pairs:
        if {"actuator_gain", "servo_gain", "servo_torque"} & set(_names(pair)):
            return _parting(
                pair,
                "hang a known weight on the arm and record again: what it adds to the effort is known, "
                "so that the effort's scale shows",
            )
    for pair in pairs:
        if set(_names(pair)) <= {*WEIGHTS, *INERTIAS}:
            return _parting(pair, _heavier(pair, gravity))
    for pair in pairs:
        return _parting(pair, "drive slowly through the whole range in both directions, then fast")
    return {"what": "", "separates": []}


def _names(pair: Pair) -> tuple[str, str]:
    return pair[0].effect.name, pair[1].effect.name


def _parting(pair: Pair, what: str) -> dict[str, Any]:
    names = _names(pair)
    return {"what": what, "separates": [c.key for c in pair] if names[0] == names[1] else list(names)}


def _heavier(pair: Pair, gravity: bool) -> str:
    """What parts two effects that make joints heavier to move. No free swing: a geared joint would not make one."""
    first, second = pair
    if all(name in INERTIAS for name in _names(pair)):
        return (
            f"move {first.site} alone back and forth, as fast as it may, while the other joints are held still, and then "
            f"{second.site} alone"
        )
    if gravity and any(name in INERTIAS for name in _names(pair)):
        return (
            "stop in several postures, each reached slowly from both sides: halfway between the two efforts lies what the "
            "weight asks for, and inertia asks for nothing there"
        )
    if gravity:
        return (
            "stop in several postures, the outer joints stretched and folded, each reached slowly from both sides: what weighs "
            "more and what lies farther out change the effort differently"
        )
    return "weigh the parts and balance them for their centres of mass"
