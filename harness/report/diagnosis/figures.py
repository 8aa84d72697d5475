"""Pictures of a diagnosis: errors before and after, and where the mismatch lies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from harness.report.figures.canvas import FAINT, INK, canvas

BEFORE, REFITTED, AFTER = "#d55e00", "#e69f00", "#0a7bbd"
MODELS = (("nominal", BEFORE), ("refitted", REFITTED), ("augmented", AFTER))


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
                        y = row + 0.22 * (index - 1)
                        ax.plot(value / floor, y, "o", color=colour, mfc=colour if filled else "none", ms=7, mew=1.6)
        ax.axvline(1.0, color=FAINT, lw=1.2, ls=":")
        ax.set_xscale("log")
        ax.set_yticks(range(len(fit)), [channel["channel"] for channel in fit])
        ax.set_ylim(len(fit) - 0.5, -0.5)
        ax.set_xlabel("RMS error / noise floor (open: training, full: held out)")
        handles = [ax.plot([], [], "o", color=c, label=m)[0] for m, c in MODELS if any(ch.get(m) for ch in fit)]
        made.figure.legend(handles=handles, loc="outside upper right", ncols=3, labelcolor=INK)
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
