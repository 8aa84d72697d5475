"""The blind proof as a page: shares, confusion, detection curves, peers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from harness.report.figures.canvas import FAINT, INK, canvas, colour
from harness.report.html import page
from harness.report.proof import SHARES, extent, sharpness_in_words
from harness.report.sections.section import Section

Document = Mapping[str, Any]


@dataclass(frozen=True)
class Shares:
    anchor: str = "shares"
    title: str = "What was found"
    template: str = "proof_shares.html"

    def content(self, document: Document) -> Mapping[str, Any]:
        rows = []
        for key, words in SHARES.items():
            if key in document and document[key][1]:
                hits, of = document[key]
                low, high = document.get("wilson95", {}).get(key, (None, None))
                rows.append((words, hits, of, low, high))
        return {
            "rows": rows,
            "seed": document["seed"],
            "extent": extent(document),
            "sentences": sharpness_in_words(document),
        }


@dataclass(frozen=True)
class Confusion:
    anchor: str = "confusion"
    title: str = "What was concealed, and what was said"
    template: str = "pictures.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        table = document.get("confusion") or {}
        if not table:
            return None
        words = (
            "Rows: what was concealed. Columns: what the diagnosis named. Shade: share of the row; number: cases. Blue: right, "
            "by itself or as a member of the class that was told."
        )
        return {
            "words": words,
            "pictures": [("Confusion", Markup(confusion_svg(table, document.get("confusion_right"))))],
        }


@dataclass(frozen=True)
class Detection:
    anchor: str = "detection"
    title: str = "How visible an effect must be"
    template: str = "pictures.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        found = {name: points for name, points in (document.get("detection") or {}).items() if points}
        if not found:
            return None
        words = (
            "Each mark is a case, up if the effect was named; the line is a running share, all effects together. Below, "
            "every effect by itself: blue where it was named."
        )
        return {"words": words, "pictures": [("Named over visibility", Markup(detection_svg(found)))]}


@dataclass(frozen=True)
class Peers:
    anchor: str = "peers"
    title: str = "What other methods say of the same cases"
    template: str = "proof_peers.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        peers = document.get("peers") or {}
        if not peers:
            return None
        rows = []
        for peer, said in peers.items():
            claims = said.get("claims", {})
            often = {
                row.replace("_", " "): ", ".join(
                    f"{effect.replace('_', ' ')} {count}" for effect, count in _by_count(counts)
                )
                for row, counts in sorted(claims.items())
                if row in ("nothing", "base_tilt", "sensor_delay")
            }
            rows.append((peer, said, often))
        return {"rows": rows}


@dataclass(frozen=True)
class Cases:
    anchor: str = "cases"
    title: str = "Every case"
    template: str = "proof_cases.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        scores = document.get("scores") or []
        if not scores:
            return None
        return {"scores": sorted(scores, key=lambda s: (s["kind"], bool(s.get("right")), s["name"]))}


def _by_count(counts: Mapping[str, int]) -> list[tuple[str, int]]:
    return sorted(counts.items(), key=lambda item: -item[1])


def confusion_svg(
    table: Mapping[str, Mapping[str, int]], accepted: Mapping[str, Mapping[str, int]] | None = None
) -> str:
    """SVG of a confusion matrix; effects that were both concealed and named come first and in the same order.

    accepted: how many of each cell's cases count as right; without it, those on the diagonal.
    """
    rows = sorted(table)
    named = {name for counts in table.values() for name in counts}
    columns = [name for name in rows if name in named] + sorted(named - set(rows))
    counts = np.array([[table[row].get(column, 0) for column in columns] for row in rows], dtype=float)
    shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1.0)
    with canvas("confusion", 9.6, 1.9 + 0.24 * len(rows)) as (made, axes):
        ax = axes[0, 0]
        ax.grid(False)
        for (i, j), share in np.ndenumerate(shares):
            if counts[i, j]:
                good = bool(rows[i] == columns[j])
                if accepted is not None:
                    good = 2.0 * accepted.get(rows[i], {}).get(columns[j], 0) > float(counts[i, j])
                ax.add_patch(_square(j, i, colour("denoc") if good else colour("analytic"), 0.15 + 0.75 * share))
                ax.text(j, i, f"{counts[i, j]:.0f}", ha="center", va="center", fontsize=7, color=INK)
        ax.set_xlim(-0.5, len(columns) - 0.5)
        ax.set_ylim(len(rows) - 0.5, -0.5)
        ax.set_xticks(range(len(columns)), [c.replace("_", " ") for c in columns], rotation=60, ha="right", fontsize=8)
        ax.set_yticks(range(len(rows)), [r.replace("_", " ") for r in rows], fontsize=8)
    return str(made.svg)


def _square(x: float, y: float, shade: str, alpha: float) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((x - 0.46, y - 0.46), 0.92, 0.92, color=shade, alpha=alpha, lw=0)


def detection_svg(found: Mapping[str, list[list[Any]]]) -> str:
    """SVG of hits and misses over visibility on a logarithmic axis: all with the running share, and effect by effect."""
    points = sorted((float(d), bool(hit)) for series in found.values() for d, hit in series if d and d > 0.0)
    visibility = np.array([d for d, _ in points])
    hits = np.array([hit for _, hit in points], dtype=float)
    below = 0.4 + 0.2 * len(found)
    with canvas("detection", 9.2, 3.2 + below, rows=2, sharex=True, height_ratios=(3.2, below)) as (made, axes):
        ax = axes[0, 0]
        rng = np.random.default_rng(0)
        ax.plot(visibility, hits + 0.04 * rng.uniform(-1.0, 1.0, len(hits)), "o", ms=4, alpha=0.5, color=FAINT)
        window = max(5, len(hits) // 8)
        if len(hits) >= window:
            share = np.convolve(hits, np.ones(window) / window, mode="valid")
            middle = np.exp(np.convolve(np.log(visibility), np.ones(window) / window, mode="valid"))
            ax.plot(middle, share, color=colour("denoc"), lw=2.2)
        ax.set_xscale("log")
        ax.set_ylim(-0.1, 1.1)
        ax.set_ylabel("named")
        each = axes[1, 0]
        rows = sorted(found)
        for y, name in enumerate(rows):
            for d, hit in found[name]:
                if d and d > 0.0:
                    each.plot(d, y, "o", ms=5, alpha=0.8, color=colour("denoc" if hit else "analytic"))
        each.set_ylim(len(rows) - 0.5, -0.5)
        each.set_yticks(range(len(rows)), [name.replace("_", " ") for name in rows], fontsize=8)
        each.set_xlabel("visibility: what the effect changes in the recording, over the noise")
    return str(made.svg)


def proof_html(document: Document) -> str:
    """The page of a ``denoc.proof/1`` document."""
    sections: list[Section] = [Shares(), Confusion(), Detection(), Peers(), Cases()]
    return page("The blind proof", document, sections)
