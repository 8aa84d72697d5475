"""Which body of one description is which of the other: by name, then by the joint's name, then by its place in the tree."""

from __future__ import annotations

from collections.abc import Sequence

from harness.compare.descriptions.bodies import Body, bodies
from harness.system import Joint, System


def matched(first: Sequence[Body], second: Sequence[Body]) -> dict[int, int]:
    """Index of the body in ``second`` for each one in ``first`` that has a counterpart."""
    pairs: dict[int, int] = {}
    for name_of in (lambda body: body.name, lambda body: body.joint.name):
        names = {name_of(body): k for k, body in enumerate(second) if k not in pairs.values()}
        for k, body in enumerate(first):
            if k not in pairs and name_of(body) in names:
                pairs[k] = names[name_of(body)]
    # Parents come before children, so that one pass goes down the whole tree.
    for k, body in enumerate(first):
        parent = -1 if body.parent < 0 else pairs.get(body.parent)
        if k in pairs or parent is None:
            continue
        for other, candidate in enumerate(second):
            if other not in pairs.values() and candidate.parent == parent and kind(candidate.joint) == kind(body.joint):
                pairs[k] = other
                break
    return pairs


def kind(joint: Joint) -> str:
    """``turns``, ``slides`` or ``fixed``: revolute and continuous joints differ in their limits alone."""
    if not joint.movable:
        return "fixed"
    return "slides" if joint.prismatic else "turns"


def alike(first: System, second: System) -> bool:
    """Whether two systems may describe one mechanism: they share a name of a link or joint, or the shape of their trees."""
    a, b = bodies(first), bodies(second)
    shapes = [[(body.parent, kind(body.joint)) for body in some] for some in (a, b)]
    return namesakes(first, second) > 0.0 or shapes[0] == shapes[1]


def namesakes(first: System, second: System) -> float:
    """Share of the smaller system's bodies that have a body or joint of the same name in the other."""
    a, b = bodies(first), bodies(second)
    few, many = sorted((a, b), key=len)
    names = {body.name for body in many}, {body.joint.name for body in many}
    return sum(body.name in names[0] or body.joint.name in names[1] for body in few) / max(len(few), 1)
