"""Whether the recordings hold the change at all: a plain least-squares fit that is told which number changed, and nothing else.

The fit of ``harness.proof.peers.practitioner`` to the recordings of the other state, begun from the model given: inertia (a
factor), viscous and dry friction, zero. Of a free swing it shows one ratio, inertia over weight; the size is what makes that
ratio, or the sizes, where a centre of mass nearer by and one farther out swing alike. It is no rival of the diagnosis, which has
to find out what changed; it says what there is to be found.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

import harness
from harness.effects import apply
from harness.proof.peers.practitioner import Practitioner
from harness.proof.peers.runs import as_run
from harness.recording import read_recordings
from harness.system import Attachment, System

LAWS = ("viscous", "dry")
STEPS = 60  # of the search for sizes


def ratio(system: System) -> float:
    """Inertia about the one joint over weight's moment at a quarter turn [s²]."""
    model = harness.Denoc(system)
    weight = abs(float(model.gravity(np.array([np.pi / 2.0]))[0]))
    return float(model.mass_matrix(np.zeros(1))[0, 0]) / weight


def sizes(system: System, effect: str, site: str, parameter: str, wanted: float) -> list[float]:
    """Sizes of the change with which the system has a ratio, from a tenth of the link's mass or arm to three times as much."""
    link = next(link for link in system.links if link.name == site)
    whole, least = {
        "payload_mass": (link.mass, 0.0),
        "com_offset": (float(np.linalg.norm(link.com)), -0.9),
    }[effect]

    def off(size: float) -> float:
        return ratio(apply(system, Attachment(effect, site, {parameter: size}))) - wanted

    grid = whole * np.linspace(least, 2.0, STEPS)
    found = [off(float(size)) for size in grid]
    return [
        float(brentq(off, a, b)) for (a, b), (x, y) in zip(pairwise(grid), pairwise(found), strict=True) if x * y <= 0.0
    ]


def plain(folder: Path, effect: str, site: str, parameters: Sequence[str]) -> list[float]:
    """Sizes of a change of one number that a plain fit gives for a case, free swings of one joint."""
    system = harness.load(folder / "model.toml", physical=False)
    (joint,) = system.movable_joints
    (parameter,) = parameters
    runs = [as_run(system, r) for r in read_recordings(sorted(folder.glob("run*.csv*")), system=system)]
    fitted = Practitioner(system, runs).fit(LAWS)
    return sizes(system, effect, site, parameter, ratio(system) * fitted.values[f"{joint.name}:inertia"])
