"""Motions of one mechanism in the plane they are seen best in, frame by frame, for the page's script."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from harness.report.animation.skeleton import skeleton
from harness.report.plots.plot import packed
from harness.system import System

Array = NDArray[np.float64]

RATE = 30.0  # frames a second
MOST_FRAMES = 900  # half a minute; of a longer recording the beginning is shown


@dataclass(frozen=True, eq=False)
class Motion:
    """One motion. positions: of joints by name [rad or m], each shape (T,). colour: a CSS colour, or "ink"."""

    label: str
    colour: str
    positions: Mapping[str, Array]


@dataclass(frozen=True, eq=False)
class Scene:
    """What is shown. time: of the frames [s], shape (T,). points: by motion, shape (T, K, 2) [m]. edges: shape (E, 2)."""

    title: str
    time: Array
    labels: tuple[str, ...]
    colours: tuple[str, ...]
    points: tuple[Array, ...]
    edges: NDArray[np.intp]

    def html(self) -> Markup:
        """The figure: caption, the place where the script draws, and the data."""
        every = np.concatenate([p.reshape(-1, 2) for p in self.points])
        every = np.concatenate([every, np.zeros((1, 2))])
        data: dict[str, Any] = {
            "time": packed(self.time),
            "edges": self.edges.tolist(),
            "low": np.nanmin(every, axis=0).tolist(),
            "high": np.nanmax(every, axis=0).tolist(),
            "motions": [
                {"label": label, "colour": colour, "points": packed(points.ravel())}
                for label, colour, points in zip(self.labels, self.colours, self.points, strict=True)
            ],
        }
        text = json.dumps(data, ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
        return Markup(
            '<figure class="animation"><figcaption>{}</figcaption><div class="stage"></div>'
            '<script type="application/json">{}</script><noscript>The animation needs scripts.</noscript></figure>'
        ).format(self.title, Markup(text))


def scene(system: System, time: Array, motions: Sequence[Motion], title: str) -> Scene:
    """Motions that share their times, seen along the horizontal direction in which least happens, gravity down.

    time: [s], shape (T,), ascending.
    """
    count = int(min(MOST_FRAMES, np.floor((time[-1] - time[0]) * RATE) + 1))
    frames = time[0] + np.arange(count) / RATE
    bones = skeleton(system)
    spatial = [
        bones.points({joint: np.interp(frames, time, values) for joint, values in motion.positions.items()})
        for motion in motions
    ]
    right, up = seen(np.concatenate([p.reshape(-1, 3) for p in spatial]), np.asarray(system.gravity, dtype=np.float64))
    flat = tuple(np.stack([p @ right, p @ up], axis=-1) for p in spatial)
    return Scene(
        title, frames, tuple(m.label for m in motions), tuple(m.colour for m in motions), flat, bones.edges
    )  # fmt: skip


def seen(points: Array, gravity: Array) -> tuple[Array, Array]:
    """Directions to the right and up of the picture, unit vectors: up against gravity, right where points spread most.

    points: shape (N, 3). Without gravity both are the directions of greatest spread.
    """
    spread = points - points.mean(axis=0)
    weight = float(np.linalg.norm(gravity))
    if weight > 0.0:
        up = -gravity / weight
        level = spread - np.outer(spread @ up, up)
        right = np.linalg.svd(level.T @ level)[0][:, 0]
        right -= (right @ up) * up
        if np.linalg.norm(right) < 0.5:  # all on one vertical line
            right = np.cross(up, np.eye(3)[int(np.argmin(np.abs(up)))])
    else:
        right, up = np.linalg.svd(spread.T @ spread)[0][:, :2].T
    # The picture's right is the base's positive direction, so that plots and picture agree in sign.
    right = right * (np.sign(right[int(np.argmax(np.abs(right)))]) or 1.0)
    return np.asarray(right / np.linalg.norm(right)), np.asarray(up)
