"""A motion in every engine, and below it how far each leaves the native one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.cases.case import NATIVE, Series
from harness.report.figures.canvas import canvas, colour
from harness.report.figures.lines import draw, legend


def overlay(series: Sequence[Series], name: str) -> str:
    """SVG of two panels: the signals, and the absolute differences from the native engine's."""
    native = {_signal(line): line for line in series if _engine(line) == NATIVE}
    others = [line for line in series if _engine(line) != NATIVE and _signal(line) in native]
    with canvas(name, 9.2, 4.6, rows=2, sharex=True, height_ratios=(3, 2)) as (made, axes):
        above, below = axes[0, 0], axes[1, 0]
        draw(above, series)
        above.set_xlabel("")
        legend(above, len(series))
        for index, line in enumerate(others):
            ours = native[_signal(line)]
            if ours.x != line.x:
                continue
            apart = np.abs(np.array(line.y) - np.array(ours.y))
            below.plot(
                line.x, np.where(apart > 0.0, apart, np.nan), color=colour(line.label, index), lw=1.1, label=line.label
            )
        below.set_yscale("log")
        below.set_ylabel("difference\n" + series[0].y_label[series[0].y_label.rindex("[") :])
        below.set_xlabel(series[0].x_label)
        if not others:
            below.remove()
    return str(made.svg)


def _engine(line: Series) -> str:
    return line.label.split(":")[0]


def _signal(line: Series) -> str:
    return line.label.partition(": ")[2]
