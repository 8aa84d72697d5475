"""Lines as the series say: the picture for everything that has no picture of its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from harness.cases.case import Series
from harness.report.figures.canvas import FAINT, INK, canvas, colour, marker

GROWTH = 18.0  # of markers, first to last, at most [points]


def lines(series: Sequence[Series], name: str, *, height: float = 3.4) -> str:
    """SVG of the lines of one figure."""
    with canvas(name, 9.2, height) as (made, axes):
        draw(axes[0, 0], series)
        legend(axes[0, 0], len(series))
    return str(made.svg)


def draw(ax: Any, series: Sequence[Series], *, width: float = 2.0) -> None:
    """Draw lines on an axis, with its labels, scales and marks; width [points] of full lines."""
    first = series[0]
    for index, line in enumerate(series):
        base = colour(line.label, index)
        if line.style == "points":
            # Open markers of growing size: points on top of each other stay visible. Of many lines by less, so that the last is no
            # larger than the plot bears.
            size = 6.0 + index * min(3.0, GROWTH / len(series))
            ax.plot(line.x, line.y, marker(line.label), color=base, mfc="none", mew=1.5, ms=size, label=line.label)
        else:
            dash = (0, (4, 2 + index)) if line.style == "dashed" else "-"
            ax.plot(
                line.x,
                line.y,
                ls=dash,
                color=base,
                label=line.label,
                lw=min(1.5, width) if line.style == "dashed" else width,
            )
    if "x" in first.log:
        ax.set_xscale("log")
    if "y" in first.log:
        ax.set_yscale("log")
    unit = first.x_label[first.x_label.find("[") :].strip("[]") if "[" in first.x_label else ""
    for text, position in {k: v for line in series for k, v in line.marks.items()}.items():
        ax.axvline(position, color=FAINT, lw=1.2, ls=":")
        ax.annotate(
            f"{text} {position:.3g} {unit}".rstrip(),
            (position, 0.97),
            xycoords=("data", "axes fraction"),
            xytext=(5, 0),
            textcoords="offset points",
            va="top",
            color=INK,
        )
    ax.set_xlabel(first.x_label)
    ax.set_ylabel(first.y_label)


def legend(ax: Any, count: int) -> None:
    """The legend beside the plot, where it hides nothing."""
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), labelcolor=INK, fontsize=9 if count < 9 else 7.5)
