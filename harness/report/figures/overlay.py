"""A motion in every engine, a panel a signal, and below how far each engine is from the native one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.cases.case import NATIVE, Series
from harness.report.figures.canvas import INK, canvas, colour
from harness.report.figures.lines import draw

MOST_PANELS = 5


def overlay(series: Sequence[Series], name: str) -> str:
    """SVG: the signals, and the largest absolute difference over all signals from the native engine's."""
    # The native line first, so that the dashes of the others lie on top of it.
    series = sorted(series, key=lambda line: not line.label.startswith(NATIVE))
    signals = list(dict.fromkeys(_signal(line) for line in series))
    shown = signals[:MOST_PANELS]
    apart = _differences(series)
    count = len(shown) + bool(apart)
    ratios = [3] * len(shown) + [2] * bool(apart) if len(shown) == 1 else [1] * count
    height = 0.9 + (3.7 if len(shown) == 1 and apart else 2.6 if count == 1 else 1.45 * count)
    with canvas(name, 9.2, height, rows=count, sharex=True, height_ratios=ratios) as (made, axes):
        for ax, signal in zip(axes[:, 0], shown, strict=False):
            mine = [replace(line, label=line.label.partition(":")[0]) for line in series if _signal(line) == signal]
            draw(ax, mine)
            ax.set_xlabel("")
            if len(shown) > 1:
                ax.set_ylabel(f"{signal.partition('.')[0]} {_unit(series[0])}")
        handles, labels = axes[0, 0].get_legend_handles_labels()
        made.figure.legend(handles, labels, loc="outside upper right", ncols=len(labels), labelcolor=INK, fontsize=9.5)
        if apart:
            below = axes[-1, 0]
            for index, (engine, (x, y)) in enumerate(apart.items()):
                below.plot(x, np.where(y > 0.0, y, np.nan), color=colour(engine, index), lw=1.1)
            below.set_yscale("log")
            # Where two motions start exactly alike, the first differences would stretch the axis.
            largest = max(float(np.nanmax(y)) for _, y in apart.values())
            if largest > 0.0:
                below.set_ylim(bottom=max(largest * 1e-6, below.get_ylim()[0]))
            below.set_ylabel(f"difference\n{_unit(series[0])}")
        axes[-1, 0].set_xlabel(series[0].x_label)
    return str(made.svg)


def _differences(series: Sequence[Series]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    native = {_signal(line): line for line in series if line.label.partition(":")[0] == NATIVE}
    found: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for line in series:
        ours, engine = native.get(_signal(line)), line.label.partition(":")[0]
        if ours is None or engine == NATIVE or ours.x != line.x:
            continue
        apart = np.abs(np.array(line.y) - np.array(ours.y))
        found[engine] = (np.array(line.x), np.fmax(apart, found[engine][1]) if engine in found else apart)
    return found


def _unit(line: Series) -> str:
    return line.y_label[line.y_label.rindex("[") :] if "[" in line.y_label else ""


def _signal(line: Series) -> str:
    return line.label.partition(": ")[2]
