"""The parts of the page of models held against recordings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.recording.units import written
from harness.report.arbitration import rows
from harness.report.arbitration.rows import WORDS
from harness.report.figures.canvas import FAINT, INK, canvas
from harness.report.plots.plot import Line, Plot
from harness.report.sections.comparison import TEMPLATE, comparison

Document = Mapping[str, Any]
Curves = Sequence[Mapping[str, Any]]
COLOURS = ("#d55e00", "#0a7bbd", "#009e73", "#8b6fc0")
MOST_DRAWN = 4000  # samples of a line


@dataclass(frozen=True)
class Answer:
    anchor: str = "answer"
    title: str = "In words"
    template: str = "comparison_words.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        return {"words": document["summary"]}


@dataclass(frozen=True)
class Table:
    """One of the document's tables. rows: the function that makes it; words: what stands above it."""

    anchor: str
    title: str
    rows: Any
    words: str
    template: str = TEMPLATE

    def content(self, document: Document) -> Mapping[str, Any] | None:
        words = self.words.format(counted=document["counted_by"])
        return comparison(self.rows(document), words, (*WORDS, "made of"))


@dataclass(frozen=True)
class Where:
    """Errors over speed, swing and effort, a picture a channel."""

    anchor: str = "regimes"
    title: str = "Errors by speed, swing and effort"
    template: str = "diagnosis_plots.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        pictures = []
        graded = [row for row in document.get("where", ()) if row["by"] != "recording"]
        for channel in dict.fromkeys(row["channel"] for row in graded):
            own = [row for row in graded if row["channel"] == channel]
            pictures.append(
                (f"{channel}: error over windows of a swing and a half, by what they are like", _bars(channel, own))
            )
        words = (
            "Each model runs freely over windows of a swing and a half, from its own best initial state; windows in groups of "
            "equally many, from the slowest to the fastest, the smallest to the largest."
        )
        return {"words": words, "plots": [], "pictures": pictures} if pictures else None


@dataclass(frozen=True)
class Motion:
    """What models leave of the data held out."""

    curves: Curves
    anchor: str = "residuals"
    title: str = "What free runs leave of the data held out"
    template: str = "diagnosis_plots.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        noise = {row["channel"]: row["noise_floor"] for row in document["prediction"]}
        plots = []
        for k, row in enumerate(self.curves):
            every = max(1, len(row["time"]) // MOST_DRAWN)
            time = np.asarray(row["time"])[::every]
            lines = [
                Line(name, (np.asarray(row["measured"]) - np.asarray(values))[::every], COLOURS[j % len(COLOURS)])
                for j, (name, values) in enumerate(row["models"].items())
            ]
            unit = written(row["unit"])
            plots.append(
                Plot(
                    f"left-{k}", f"{row['channel']}, measured less simulated", "time [s]", unit, time, lines,
                    f"What each model's free run leaves of {row['channel']} over time", band=2.0 * noise[row["channel"]],
                ).html()
            )  # fmt: skip
        words = "Nothing but initial states was fitted; two standard deviations of the noise either way are shaded."
        return {"words": words, "plots": plots, "pictures": []} if plots else None


@dataclass(frozen=True)
class Intervals:
    """Every number's 95 % interval, and where models lie, in units of its size."""

    anchor: str = "intervals"
    title: str = "Numbers beside their intervals"
    template: str = "diagnosis_plots.html"

    def content(self, document: Document) -> Mapping[str, Any] | None:
        told = [row for row in document["numbers"] if row["ci95"] is not None]
        if not told:
            return None
        names = rows.models_of(document)
        words = "In units of each number's size: the interval of 95 % and each model."
        return {
            "words": words,
            "plots": [],
            "pictures": [("Intervals of the numbers, and the models in them", _forest(told, names))],
        }


def _bars(channel: str, own: Sequence[Mapping[str, Any]]) -> str:
    kinds = list(dict.fromkeys(row["by"] for row in own))
    names = list(own[0]["models"])
    with canvas(f"regimes-{channel}", 9.2, 2.9, 1, len(kinds)) as (made, axes):
        for ax, kind in zip(axes[0], kinds, strict=True):
            groups = [row for row in own if row["by"] == kind]
            width = 0.8 / len(names)
            for j, name in enumerate(names):
                at = np.arange(len(groups)) + (j - 0.5 * (len(names) - 1)) * width
                ax.bar(
                    at,
                    [row["models"][name] for row in groups],
                    0.9 * width,
                    color=COLOURS[j % len(COLOURS)],
                    label=name,
                )
            ax.set_xticks(range(len(groups)), [row["group"].replace(" … ", "–") for row in groups], fontsize=8.5)
            ax.set_xlabel(f"{kind} [{written(groups[0]['by_unit'])}]")
            ax.grid(axis="x", lw=0)
        axes[0, 0].set_ylabel(f"error [{written(own[0]['unit'])}]")
        made.figure.legend(
            *axes[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=len(names), labelcolor=INK
        )
    return str(made.svg)


def _forest(told: Sequence[Mapping[str, Any]], names: Sequence[str]) -> str:
    with canvas("intervals", 9.2, 0.9 + 0.34 * len(told)) as (made, axes):
        ax = axes[0, 0]
        for k, row in enumerate(told):
            own = [row["published"]] if "published" in row else [row["models"][name] for name in names]
            size = row["size"]
            low, high = np.clip(np.array(row["ci95"]) / size, -2.0, 2.5)
            ax.plot([low, high], [k, k], color=INK, lw=3.0, solid_capstyle="butt", alpha=0.6)
            ax.plot(row["value"] / size, k, "|", color=INK, ms=13, mew=2.0)
            for j, value in enumerate(own):
                ax.plot(value / size, k, ("o", "D")[j % 2], color=COLOURS[j], ms=7, mfc="none", mew=1.8)
        ax.set_yticks(range(len(told)), [row["number"] for row in told])
        ax.set_ylim(len(told) - 0.5, -0.5)
        ax.axvline(0.0, color=FAINT, lw=1.0)
        ax.set_xlabel("share of the number's size")
        handles = [ax.plot([], [], "|", color=INK, ms=13, mew=2.0, label="recordings, 95 %")[0]]
        handles += [
            ax.plot([], [], ("o", "D")[j % 2], color=COLOURS[j], mfc="none", mew=1.8, label=name)[0]
            for j, name in enumerate(names)
        ]
        made.figure.legend(handles=handles, loc="outside upper right", ncols=len(handles), labelcolor=INK)
    return str(made.svg)


__all__ = ["Answer", "Intervals", "Motion", "Table", "Where"]
