"""Pictures of a diagnosis: errors before and after, and where the mismatch lies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from harness.report.figures.before_after import AFTER, BEFORE, PREDICTIVE, REFITTED
from harness.report.figures.canvas import FAINT, INK, canvas

MODELS = (("nominal", BEFORE), ("refitted", REFITTED), ("augmented", AFTER), ("predictive", PREDICTIVE))


def errors(fit: Sequence[Mapping[str, Any]], name: str = "errors") -> str:
    """SVG: RMS error of each channel over its noise floor, training (open) and held out (full), for each model."""
    with canvas(name, 9.2, 1.1 + 0.55 * len(fit)) as (made, axes):
        ax = axes[0, 0]
        for row, channel in enumerate(fit):
            floor = channel["noise_floor"]
            for index, (model, colour) in enumerate(MODELS):
                for key, filled in (("train_rmse", False), ("heldout_rmse", True)):
                    value = (channel.get(model) or {}).get(key)
                    if value and floor:
                        y = row + 0.2 * (index - 1.5)
                        ax.plot(value / floor, y, "o", color=colour, mfc=colour if filled else "none", ms=7, mew=1.6)
        ax.axvline(1.0, color=FAINT, lw=1.2, ls=":")
        ax.set_xscale("log")
        ax.set_yticks(range(len(fit)), [channel["channel"] for channel in fit])
        ax.set_ylim(len(fit) - 0.5, -0.5)
        ax.set_xlabel("RMS error / noise floor (open: training, full: held out)")
        handles = [ax.plot([], [], "o", color=c, label=m)[0] for m, c in MODELS if any(ch.get(m) for ch in fit)]
        made.figure.legend(handles=handles, loc="outside upper right", ncols=len(handles), labelcolor=INK)
    return str(made.svg)


def windows(mismatch: Sequence[Mapping[str, Any]], name: str = "windows") -> str:
    """SVG: when each mismatch lasts, the heavier the darker."""
    with canvas(name, 9.2, 1.0 + 0.4 * len(mismatch)) as (made, axes):
        ax = axes[0, 0]
        largest = max(abs(place["severity"] or 0.0) for place in mismatch) or 1.0
        for row, place in enumerate(mismatch):
            for begin, end in place["time"]:
                ax.barh(
                    row,
                    end - begin,
                    left=begin,
                    height=0.5,
                    color=BEFORE,
                    alpha=0.3 + 0.6 * abs(place["severity"] or 0.0) / largest,
                )
        ax.set_yticks(
            range(len(mismatch)), [f"{place['channel']} ({place['side']} at {place['site']})" for place in mismatch]
        )
        ax.set_ylim(len(mismatch) - 0.5, -0.5)
        ax.set_xlim(left=0.0)
        ax.set_xlabel("time [s]")
    return str(made.svg)


def repeated(
    rows: Sequence[Mapping[str, Any]], overall: Mapping[str, Any] | None, label: str, unit: str, name: str
) -> str:
    """SVG: estimate and interval of one parameter from each recording (rows), over the interval from all of them."""
    with canvas(name, 9.2, 1.1 + 0.34 * len(rows)) as (made, axes):
        ax = axes[0, 0]
        low, high = (overall or {}).get("ci95") or (None, None)
        if low is not None and high is not None:
            ax.axvspan(low, high, color=AFTER, alpha=0.18, lw=0)
        if overall is not None:
            ax.axvline(overall["value"], color=AFTER, lw=1.2)
        for place, row in enumerate(rows):
            ends = row.get("ci95") or (None, None)
            if ends[0] is not None and ends[1] is not None:
                ax.plot(ends, (place, place), color=INK, lw=1.6, solid_capstyle="butt")
            ax.plot(row["value"], place, "o", color=INK, mfc="none" if row.get("held_out") else INK, ms=6)
        ax.set_yticks(range(len(rows)), [row["recording"] for row in rows])
        ax.set_ylim(len(rows) - 0.5, -0.5)
        ax.set_xlabel(f"{label} [{unit}]" if unit else label)
    return str(made.svg)


def correlated(told: Mapping[str, Any], name: str = "correlations") -> str:
    """SVG: matrix of correlations, every cell with its figure."""
    names, matrix = told["parameters"], told["matrix"]
    count = len(names)
    words = [text.replace("_", " ") for text in names]
    with canvas(name, 9.2, 1.0 + 0.42 * count) as (made, axes):
        ax = axes[0, 0]
        ax.grid(False)
        for spine in ax.spines.values():
            spine.set_visible(False)
        for row in range(count):
            for column in range(row + 1):
                value = matrix[row][column]
                if value is None:
                    continue
                colour = FAINT if row == column else BEFORE if value > 0 else AFTER
                strength = 0.12 if row == column else 0.1 + 0.75 * abs(value)
                ax.barh(row, 0.96, height=0.92, left=column - 0.48, color=colour, alpha=strength)
                ax.text(column, row, f"{value:+.2f}" if row != column else "1", ha="center", va="center", color=INK)
        ax.set_xticks(range(count), [str(k + 1) for k in range(count)])
        ax.set_yticks(range(count), [f"{text}   {k + 1}" for k, text in enumerate(words)])
        ax.tick_params(length=0)
        ax.set_xlim(-0.5, max(count, 6) - 0.5)
        ax.set_ylim(count - 0.5, -0.5)
    return str(made.svg)
