"""Loops to MJCF: equalities that connect or weld sites, and joint equalities."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from lxml import etree

from harness.errors import UnsupportedError
from harness.system.closure import completed
from harness.system.description import System
from harness.system.loop import BALL, REVOLUTE, WELD, Coupling, Frame, connections
from harness.system.mjcf_names import WORLD, body_names
from harness.system.rotation import quaternion


def close_loops(root: etree._Element, world: etree._Element, system: System) -> None:
    """Write the loops of a system whose bodies are written.

    MJCF connects and welds; a revolute cut is two connections along its axis. What is closed beside that must follow from the rest
    of the mechanism. Raises UnsupportedError where it does not.
    """
    equality = root.find("equality")
    if equality is None:
        equality = etree.SubElement(root, "equality")
    written = {body.get("name"): body for body in world.iter("body")} | {WORLD: world}
    bodies = {link: written[name] for link, name in body_names(system).items() if name in written}
    cut = {loop.name: loop for loop in completed(system, (BALL, *REVOLUTE.values(), WELD))}
    for loop in system.loops:
        if isinstance(loop, Coupling):
            other = {} if loop.leader is None else {"joint2": loop.leader}
            terms = _words(loop.coefficients)
            etree.SubElement(equality, "joint", name=loop.name, joint1=loop.joint, polycoef=terms, **other)
            continue
        for k, connection in enumerate(connections(cut[loop.name])):
            name = loop.name if k == 0 else f"{loop.name}__{k + 1}"
            sites = {}
            for side, frame in (("site1", connection.first), ("site2", connection.second)):
                if frame.link not in bodies:
                    # A massless link between two joints is one body with what it carries, and what would move on it has no frame.
                    raise UnsupportedError(
                        f"loop {loop.name!r} ends on {frame.link!r}, which is massless, so that MJCF has no body for it",
                        mend="give it a mass and inertia, or write TOML",
                        source=system.source,
                    )
                sites[side] = f"{name}__{side}"
                _site(bodies[frame.link], sites[side], frame)
            etree.SubElement(equality, "weld" if connection.welded else "connect", name=name, **sites)


def _site(body: etree._Element, name: str, frame: Frame) -> None:
    turned = _words(quaternion(np.asarray(frame.rotation)))
    etree.SubElement(body, "site", name=name, pos=_words(np.asarray(frame.xyz)), quat=turned)


def _words(values: Iterable[float]) -> str:
    return " ".join(repr(float(x)) for x in values)
