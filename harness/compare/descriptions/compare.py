"""Two descriptions of one mechanism, body by body and field by field."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from harness.compare.descriptions.bodies import Body, bodies
from harness.compare.descriptions.fields import Difference, beam_numbers, joint_numbers, relative, vector
from harness.compare.descriptions.matching import kind, matched
from harness.compare.descriptions.placement import STILL, Move, axes, masses, placed
from harness.system import System
from harness.system.description import Array

# Files print four digits and more; a parameter that was identified anew moves by per cents.
TOLERANCE = 1e-3


@dataclass(frozen=True, eq=False)
class Comparison:
    """What two descriptions say of every field.

    system: the first; gravity: of the second [m/s²]; first: bodies of the first; differences: all compared, agreeing ones too.
    """

    system: System
    gravity: Array
    first: tuple[Body, ...]
    differences: tuple[Difference, ...]


def compare(first: System, second: System) -> Comparison:
    """Hold every field of two descriptions against one another, bodies matched by name, then by place in the tree.

    Where masses and axes are is compared in the pose of zero, so that link frames chosen otherwise make no difference.
    """
    a, b = bodies(first), bodies(second)
    pairs = matched(a, b)
    reach = max([*(float(np.linalg.norm(x.point - _origin(a, x))) for x in a), *(x.size for x in a), 1e-9])
    moves: dict[int, Move] = {-1: STILL}
    found: list[Difference] = [_gravity(first, second)]
    for k, body in enumerate(a):
        if k not in pairs:
            found.append(
                Difference("body", body.name, 1.0, "1", f"only in the first, carried by joint {body.joint.name}")
            )
            moves[k] = moves[body.parent]
            continue
        other = b[pairs[k]]
        found += _tree(body, other, a, b, pairs)
        moves[k], misplaced = placed(k, body, other, moves[body.parent], reach)
        here = moves[k].body(other)
        found += misplaced
        found += axes(k, body, here)
        found += masses(k, body, here)
        if body.joint.movable and other.joint.movable:
            found += joint_numbers(k, body.joint, other.joint)
        if body.beam is not None and other.beam is not None:
            found += beam_numbers(k, body.name, body.beam, other.beam)
    found += [
        Difference("body", x.name, 1.0, "1", f"only in the second, carried by joint {x.joint.name}")
        for k, x in enumerate(b)
        if k not in pairs.values()
    ]
    found += _effects(first, second)
    return Comparison(first, second.gravity, a, tuple(found))


def _origin(some: tuple[Body, ...], body: Body) -> Array:
    return some[body.parent].point if body.parent >= 0 else body.point


def _gravity(first: System, second: System) -> Difference:
    x, y = np.asarray(first.gravity), np.asarray(second.gravity)
    largest = max(float(np.linalg.norm(x)), float(np.linalg.norm(y)))
    size = float(np.linalg.norm(x - y)) / largest if largest > 0.0 else 0.0
    return Difference("gravity", "base", size, "1", f"{vector(x, 9)} against {vector(y, 9)} m/s²")


def _tree(
    body: Body, other: Body, a: tuple[Body, ...], b: tuple[Body, ...], pairs: dict[int, int]
) -> Iterator[Difference]:
    """What hangs elsewhere, moves otherwise, or bends in one description alone."""
    parents = [some[x.parent].name if x.parent >= 0 else "the base" for some, x in ((a, body), (b, other))]
    if (pairs.get(body.parent) if body.parent >= 0 else -1) != other.parent:
        yield Difference("tree", body.name, 1.0, "1", f"hangs on {parents[0]} against {parents[1]}")
    if kind(body.joint) != kind(other.joint):
        yield Difference("joint type", body.joint.name, 1.0, "1", f"{body.joint.type} against {other.joint.type}")
    if (body.beam is None) != (other.beam is None):
        words = ["rigid" if x.beam is None else "flexible" for x in (body, other)]
        yield Difference("flexibility", body.name, 1.0, "1", " against ".join(words))


def _effects(first: System, second: System) -> Iterator[Difference]:
    """Effects attached to one of them, or to both with other numbers."""
    x, y = ({(a.effect, a.site): a.parameters for a in system.attachments} for system in (first, second))
    for effect, site in dict.fromkeys([*x, *y]):
        if (effect, site) not in x or (effect, site) not in y:
            which = "first" if (effect, site) in x else "second"
            yield Difference("effect", site, 1.0, "1", f"{effect} only in the {which}")
            continue
        for name, value in x[effect, site].items():
            other = y[effect, site].get(name, 0.0)
            yield Difference(
                "effect", site, relative(value, other), "1", f"{effect}, {name}: {value:.6g} against {other:.6g}"
            )
