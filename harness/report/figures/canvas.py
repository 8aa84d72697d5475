"""SVG that follows the page: its text and lines take the page's colours, in light and in dark."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from markupsafe import escape

# Colours that stand in for the page's own, and the CSS variables they become.
INK, FAINT, GRID = "#010203", "#020304", "#030405"
PAGE = {INK: "var(--ink)", FAINT: "var(--faint)", GRID: "var(--grid)"}

# Okabe and Ito: told apart by readers who do not see red and green apart.
COLOURS = {
    "denoc": "#0a7bbd",
    "pinocchio": "#e69f00",
    "mujoco": "#009e73",
    "exudyn": "#cc79a7",
    "analytic": "#d55e00",
    "published": "#8c8c8c",
}
SPARE = ("#56b4e9", "#b3a000", "#8b6fc0", "#a65628", "#5f9ea0", "#e0608a")
# Engines differ by shape as well as by colour.
MARKERS = {"denoc": "o", "pinocchio": "s", "mujoco": "^", "exudyn": "D", "analytic": "P", "published": "X"}

STYLE = {
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.size": 10.5,
    "text.color": INK,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.facecolor": "none",
    "figure.facecolor": "none",
    "savefig.facecolor": "none",
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "lines.markersize": 5,
}


@dataclass
class Canvas:
    """A matplotlib figure that becomes SVG text when the block it is made in has ended."""

    figure: Any
    svg: str = ""


@contextmanager
def canvas(name: str, width: float, height: float, rows: int = 1, columns: int = 1, **options: Any) -> Iterator[Any]:
    """A figure of ``width`` × ``height`` inches; yields (canvas, axes) with axes of shape (rows, columns).

    name: makes the identifiers inside the SVG differ from those of the page's other pictures.
    """
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with matplotlib.rc_context({**STYLE, "svg.hashsalt": name}):
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasSVG(figure)
        axes = figure.subplots(rows, columns, squeeze=False, **options)
        made = Canvas(figure)
        yield made, axes
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
        made.svg = inline(text.getvalue())


def inline(svg: str) -> str:
    """The SVG element alone, fluid in width, with the page's colours and fonts."""
    svg = svg[svg.index("<svg") :]
    for stand_in, variable in PAGE.items():
        svg = svg.replace(stand_in, variable)
    svg = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", svg, count=1)
    svg = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", svg, count=1)
    # Text keeps its size and takes the page's typeface.
    return re.sub(r"(font: [^;\"]*?px) [^;\"]*", r"\1 var(--sans)", svg)


def titled(svg: str, described: str) -> str:
    """An SVG element that says what it shows to who cannot see it."""
    end = svg.index(">", svg.index("<svg"))
    return f'{svg[:end]} role="img"><title>{escape(described)}</title>{svg[end + 1 :]}'


def colour(label: str, index: int = 0) -> str:
    """The engine's colour if the label starts with an engine's name, else a spare one."""
    return next((c for name, c in COLOURS.items() if label.startswith(name)), SPARE[index % len(SPARE)])


def marker(label: str) -> str:
    """The engine's marker if the label starts with an engine's name, else a dot."""
    return next((m for name, m in MARKERS.items() if label.startswith(name)), "o")
