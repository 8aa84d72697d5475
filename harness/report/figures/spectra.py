"""Amplitude over frequency, a panel a signal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from harness.cases.case import NATIVE, Series
from harness.report.figures.canvas import INK, canvas
from harness.report.figures.lines import draw

MOST_PANELS = 5
# Five decades below the highest peak there is nothing but the windows' side lobes and the integrators' noise.
DECADES = 1e-5


def spectra(series: Sequence[Series], name: str) -> str:
    """SVG of the spectra of every engine, signal by signal."""
    series = sorted(series, key=lambda line: not line.label.startswith(NATIVE))
    signals = list(dict.fromkeys(line.label.partition(": ")[2] for line in series))[:MOST_PANELS]
    height = 3.3 if len(signals) == 1 else 0.9 + 1.6 * len(signals)
    with canvas(name, 9.2, height, rows=len(signals), sharex=True) as (made, axes):
        for ax, signal in zip(axes[:, 0], signals, strict=True):
            mine = [line for line in series if line.label.partition(": ")[2] == signal]
            draw(ax, [replace(line, label=line.label.partition(":")[0]) for line in mine], width=1.2)
            peak = max((y for line in mine for y in line.y if y == y), default=1.0)
            ax.set_ylim(peak * DECADES, peak * 3.0)
            ax.set_xlabel("")
            if len(signals) > 1:
                ax.set_ylabel(f"{signal.partition('.')[0]} {mine[0].y_label[mine[0].y_label.find('[') :]}")
        handles, labels = axes[0, 0].get_legend_handles_labels()
        made.figure.legend(handles, labels, loc="outside upper right", ncols=len(labels), labelcolor=INK, fontsize=9.5)
        axes[-1, 0].set_xlabel(series[0].x_label)
    return str(made.svg)
