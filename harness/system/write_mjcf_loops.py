"""Loops to MJCF: equalities that connect or weld sites, and joint equalities."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from lxml import etree

from harness.system.closure import completed
from harness.system.description import Array, System
from harness.system.loop import BALL, REVOLUTE, TURNS, WELD, Coupling, Frame, Loop
from harness.system.rotation import quaternion

# A revolute cut is two connections, this far apart along its axis [m].
APART = 0.1


def close_loops(root: etree._Element, world: etree._Element, system: System) -> None:
    """Write the loops of a system whose bodies are written.

    MJCF connects and welds; a revolute cut is two connections along its axis. What is closed beside that must follow from the rest of
    the mechanism. Raises UnsupportedError where it does not.
    """
    equality = root.find("equality")
    if equality is None:
        equality = etree.SubElement(root, "equality")
    bodies = {body.get("name"): body for body in world.iter("body")} | {system.base: world}
    cut = {loop.name: loop for loop in completed(system, (BALL, *REVOLUTE.values(), WELD))}
    for loop in system.loops:
        if isinstance(loop, Coupling):
            other = {} if loop.leader is None else {"joint2": loop.leader}
            terms = _words(loop.coefficients)
            etree.SubElement(equality, "joint", name=loop.name, joint1=loop.joint, polycoef=terms, **other)
            continue
        for k, (word, shift) in enumerate(points(cut[loop.name])):
            name = loop.name if k == 0 else f"{loop.name}__{k + 1}"
            sites = {}
            for side, frame in (("site1", loop.first), ("site2", loop.second)):
                sites[side] = f"{name}__{side}"
                _site(bodies[frame.link], sites[side], frame, shift)
            etree.SubElement(equality, word, name=name, **sites)


def points(loop: Loop) -> Iterable[tuple[str, Array]]:
    """The equalities that say a loop: MuJoCo's word, and where along the frames' axes it is [m], shape (3,)."""
    turns = [turn for turn in TURNS if turn in loop.closed]
    yield ("weld" if len(turns) == 3 else "connect"), np.zeros(3)
    if len(turns) == 2:
        (axis,) = (k for k, turn in enumerate(TURNS) if turn not in loop.closed)
        yield "connect", APART * np.eye(3)[axis]


def _site(body: etree._Element, name: str, frame: Frame, shift: Array) -> None:
    place = np.asarray(frame.xyz) + np.asarray(frame.rotation) @ shift
    etree.SubElement(body, "site", name=name, pos=_words(place), quat=_words(quaternion(np.asarray(frame.rotation))))


def _words(values: Iterable[float]) -> str:
    return " ".join(repr(float(x)) for x in values)
