"""Joints and links put together into a tree, or refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from heapq import heapify, heappop, heappush
from pathlib import Path

from harness.errors import InputError
from harness.system.description import Joint, Link
from harness.system.suggest import did_you_mean

Lines = Mapping[tuple[str, str], int]


def arrange(
    joints: Sequence[Joint],
    links: Sequence[Link],
    base: str,
    *,
    source: Path | None = None,
    lines: Lines | None = None,
) -> tuple[tuple[Joint, ...], tuple[Link, ...]]:
    """Joints in topological order, file order kept where possible, and their links in the same order.

    links: every link but the base. lines: line of ("joint" | "link", name) in the source, where known.
    Raises InputError for duplicated names, unknown parents or children, two parents, loops, unreachable links.
    """
    lines = lines or {}

    def refuse(what: str, mend: str, kind: str, name: str) -> InputError:
        return InputError(what, mend=mend, source=source, line=lines.get((kind, name)))

    _refuse_duplicates([("link", link.name) for link in links] + [("link", base)], source, lines)
    _refuse_duplicates([("joint", joint.name) for joint in joints], source, lines)
    by_name = {link.name: link for link in links}
    carriers: dict[str, Joint] = {}
    for joint in joints:
        for role, name in (("parent", joint.parent), ("child", joint.child)):
            if name not in by_name and name != base:
                raise refuse(
                    f"joint {joint.name!r}: {role} {name!r} is not a link of this model",
                    did_you_mean(name, [*by_name, base]),
                    "joint",
                    joint.name,
                )
        if joint.child == base:
            raise refuse(
                f"joint {joint.name!r} carries {base!r}, which is the fixed base (cyclic tree)",
                "the base has no parent; turn the joint round or name another base",
                "joint",
                joint.name,
            )
        if joint.child in carriers:
            raise refuse(
                f"link {joint.child!r} has two parents: joints {carriers[joint.child].name!r} and {joint.name!r}",
                "a tree has one joint for each link; loops are not modelled",
                "joint",
                joint.name,
            )
        carriers[joint.child] = joint

    # The earliest joint of the file whose parent already stands comes next.
    index = {joint.name: k for k, joint in enumerate(joints)}
    waiting: dict[str, list[int]] = {}
    for joint in joints:
        waiting.setdefault(joint.parent, []).append(index[joint.name])
    ready = waiting.pop(base, [])
    heapify(ready)
    order: list[Joint] = []
    while ready:
        joint = joints[heappop(ready)]
        order.append(joint)
        for k in waiting.pop(joint.child, []):
            heappush(ready, k)

    reached = {joint.child for joint in order}
    for link in links:
        if link.name in reached:
            continue
        if link.name not in carriers:
            raise refuse(
                f"link {link.name!r} cannot be reached from {base!r}: no joint carries it",
                f"add a joint whose child is {link.name!r}, or take the link out",
                "link",
                link.name,
            )
        loop = _loop(link.name, carriers)
        if loop:
            joint_name = carriers[loop[0]].name
            raise refuse(
                f"links {' → '.join([*loop, loop[0]])} form a loop (cyclic tree)",
                f"one of them must hang on {base!r} or on a link that does",
                "joint",
                joint_name,
            )
    for link in links:
        if link.name not in reached:
            raise refuse(
                f"link {link.name!r} cannot be reached from {base!r}", "join it to the tree", "link", link.name
            )
    return tuple(order), tuple(by_name[joint.child] for joint in order)


def _refuse_duplicates(named: Sequence[tuple[str, str]], source: Path | None, lines: Lines) -> None:
    seen: set[tuple[str, str]] = set()
    for kind, name in named:
        if (kind, name) in seen:
            raise InputError(
                f"two {kind}s are named {name!r}",
                mend="names must be unique; rename one",
                source=source,
                line=lines.get((kind, name)),
            )
        seen.add((kind, name))


def _loop(start: str, carriers: Mapping[str, Joint]) -> list[str]:
    """The loop met when walking from a link towards the base, parent first; empty if the walk ends."""
    path: list[str] = []
    name = start
    while name in carriers and name not in path:
        path.append(name)
        name = carriers[name].parent
    return path[path.index(name) :][::-1] if name in path else []
