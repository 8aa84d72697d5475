"""What a plot of a page is: lines over one axis, told once, drawn as a picture and by the page's script."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from harness.report.figures.canvas import FAINT, INK, canvas, titled

Array = NDArray[np.float64]
WIDTH = 9.2  # inches


@dataclass(frozen=True, eq=False)
class Line:
    """One line of a plot. values: shape of the plot's ``x``, nan where there is none. colour: a CSS colour, or "ink", "faint"."""

    label: str
    values: Array
    colour: str
    style: str = "line"  # line, dashed, dots, marks
    width: float = 1.3
    ends: tuple[Array, Array] | None = None  # lower and upper end of a band around it


@dataclass(frozen=True, eq=False)
class Plot:
    """Lines over one axis.

    name: told apart by it from the page's other plots. x: ascending. described: for who cannot see it. band: half-width around zero
    that is shaded. log: axes that are logarithmic, of "x" and "y". linear: half-width around zero within which a y axis is linear,
    and logarithmic beyond. limits: of y. together: plots of the same name zoom and point together.
    """

    name: str
    title: str
    x_label: str
    y_label: str
    x: Array
    lines: Sequence[Line]
    described: str
    band: float = 0.0
    log: str = ""
    linear: float = 0.0
    limits: tuple[float, float] | None = None
    together: str = ""
    height: float = 2.6

    def html(self) -> Markup:
        """The figure: caption, the place where the script draws, and the picture for paper and for pages without scripts."""
        data = json.dumps(self._data(), ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
        return Markup(
            '<figure class="plot"><figcaption>{title}</figcaption>'
            '<div class="live" role="group" aria-label="{described}"></div>'
            '<script type="application/json">{data}</script><div class="still">{still}</div></figure>'
        ).format(
            title=self.title,
            described=self.described,
            data=Markup(data),
            still=Markup(titled(self.still(), self.described)),
        )

    def _data(self) -> dict[str, Any]:
        return {
            "x": packed(self.x),
            "xLabel": self.x_label,
            "yLabel": self.y_label,
            "band": self.band,
            "log": self.log,
            "linear": self.linear,
            "limits": self.limits,
            "together": self.together,
            "height": round(self.height * 96),
            "lines": [
                {
                    "label": line.label, "y": packed(line.values), "colour": line.colour, "style": line.style, "width": line.width,
                    "ends": [packed(end) for end in line.ends] if line.ends else None,
                }
                for line in self.lines
            ],
        }  # fmt: skip

    def still(self) -> str:
        """SVG of the whole."""
        with canvas(self.name, WIDTH, self.height) as (made, axes):
            ax = axes[0, 0]
            if self.band:
                ax.axhspan(-self.band, self.band, color=FAINT, alpha=0.18, lw=0)
            for line in self.lines:
                self._draw(ax, line)
            if "x" in self.log:
                ax.set_xscale("log")
            if "y" in self.log:
                ax.set_yscale("log")
            if self.linear:
                ax.set_yscale("asinh", linear_width=self.linear)
                largest = max(float(np.nanmax(np.abs(line.values), initial=self.linear)) for line in self.lines)
                # Decades within the linear part would stand on one another.
                decades = np.arange(np.ceil(np.log10(self.linear)), np.log10(largest) + 0.5)
                shown = 10.0 ** decades[:: max(1, len(decades) // 2)]
                ax.set_yticks([*-shown[::-1], 0.0, *shown])
            elif self.limits:
                ax.set_ylim(*self.limits)
            ax.set_xlabel(self.x_label)
            ax.set_ylabel(self.y_label)
            made.figure.legend(
                *ax.get_legend_handles_labels(), loc="outside upper right", ncols=len(self.lines), labelcolor=INK
            )
        return str(made.svg)

    def _draw(self, ax: Any, line: Line) -> None:
        colour = {"ink": INK, "faint": FAINT}.get(line.colour, line.colour)
        if line.ends:
            known = np.isfinite(line.values)
            ax.fill_between(
                self.x[known], line.ends[0][known], line.ends[1][known], color=colour, alpha=0.22, lw=0, zorder=3
            )
        if line.style in ("dots", "marks"):
            small = line.style == "dots"
            ax.plot(
                self.x, line.values, "." if small else "o", ms=2.2 if small else 5, color=colour, mfc=colour if small else "none",
                alpha=0.45 if small else 1.0, label=line.label, rasterized=small,
            )  # fmt: skip
            return
        known = np.isfinite(line.values) if line.ends else np.full(len(self.x), True)
        ax.plot(
            self.x[known], line.values[known], color=colour, lw=line.width, ls="--" if line.style == "dashed" else "-",
            label=line.label, zorder=4 if line.ends else 2,
        )  # fmt: skip


def packed(values: Array) -> str:
    """Single precision, little endian, base64: a quarter of the size of written digits, and more exact than any screen."""
    return base64.b64encode(np.asarray(values, dtype="<f4").tobytes()).decode()
