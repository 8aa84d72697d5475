"""Where one model predicts better than another: by recording, by how fast, how far and how hard driven joints move.

Every recording is cut into windows of a swing and a half, over which each model runs freely from its own best initial
state. Whether a difference is more than chance is the Diebold-Mariano test (J. Bus. Econ. Stat. 13 (1995) 253) over a
group's windows, with the small-sample correction of Harvey, Leybourne and Newbold (Int. J. Forecasting 13 (1997) 281):
windows do not overlap, so that errors are one step ahead.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t

from harness.diagnose.arbitration.constants import CLEAR_CHANCE, FEWEST_WINDOWS, MATTERING_DIFFERENCE, WINDOW_GROUPS
from harness.diagnose.arbitration.runs import FreeRuns
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]


def rms(left: Sequence[Array], channel: int) -> float:
    """Root mean square of what windows (C, T) leave of a channel; nan where it was never read."""
    every = np.concatenate([piece[channel] for piece in left])
    good = np.isfinite(every)
    return float(np.sqrt(np.mean(every[good] ** 2))) if good.any() else float("nan")


def mean_squares(left: Sequence[Array], channel: int) -> Array:
    """The same window by window, squared, (W,)."""
    return np.array([rms([piece], channel) ** 2 for piece in left])


def compared(errors: Mapping[str, Array]) -> tuple[str, float | None]:
    """Which of two models has the smaller mean-square errors over windows (W,) each: its name, "level" or "too few";
    and the chance of such a difference.

    The loss is the logarithm of a window's mean square, so that no single window decides.
    """
    (one, a), (other, b) = errors.items()
    good = np.isfinite(a) & np.isfinite(b) & (a > 0.0) & (b > 0.0)
    count = int(np.count_nonzero(good))
    if count < FEWEST_WINDOWS:
        return "too few", None
    difference = np.log(a[good]) - np.log(b[good])
    spread, mean = float(np.std(difference, ddof=1)), float(np.mean(difference))
    chance = float(2.0 * t.sf(abs(mean) / (spread / np.sqrt(count)), count - 1)) if spread > 0.0 else float(mean == 0.0)
    total = float(np.log(np.mean(a[good])) - np.log(np.mean(b[good])))
    if chance > CLEAR_CHANCE or min(abs(mean), abs(total)) < MATTERING_DIFFERENCE or mean * total < 0.0:
        return "level", chance
    return (one if mean < 0.0 else other), chance


def where(problem: Problem, windows: Sequence[Window], runs: Mapping[str, FreeRuns]) -> list[dict[str, Any]]:
    """One row a channel and group of windows; ``models``: error of each [channel unit]; ``better``: see ``compared``.

    runs: of two models or more over the same windows; the first two are compared.
    """
    out: list[dict[str, Any]] = []
    pair = list(runs)[:2]
    some = next(iter(runs.values()))
    for c, channel in enumerate(problem.channels):
        squares = {name: mean_squares(found.left, c) for name, found in runs.items()}
        for by, unit, groups in _groups(problem, windows, some, c):
            for label, ends, which in groups:
                if not np.any(which):
                    continue
                better, chance = (
                    compared({name: squares[name][which] for name in pair}) if len(pair) == 2 else ("", None)
                )
                out.append(
                    {
                        "channel": channel.name,
                        "unit": channel.unit,
                        "by": by,
                        "by_unit": unit,
                        "group": label,
                        "from": ends[0],
                        "to": ends[1],
                        "windows": int(np.count_nonzero(which)),
                        "models": {name: float(np.sqrt(np.nanmean(s[which]))) for name, s in squares.items()},
                        "better": better,
                        "chance": chance,
                    }
                )
    return out


Group = tuple[str, tuple[float | None, float | None], NDArray[np.bool_]]


def _groups(problem: Problem, windows: Sequence[Window], some: FreeRuns, c: int) -> list[tuple[str, str, list[Group]]]:
    """By what windows are grouped for a channel, its unit, and the groups."""
    found: list[tuple[str, str, list[Group]]] = []
    runs = np.array([w.run for w in windows])
    found.append(
        ("recording", "", [(problem.runs[k].name, (None, None), runs == k) for k in dict.fromkeys(runs.tolist())])
    )
    channel = problem.channels[c]
    if channel.quantity == "position":
        speed, extent = [], []
        for window, path in zip(windows, some.predicted, strict=True):
            time = problem.runs[window.run].time[window.first : window.last]
            speed.append(float(np.sqrt(np.mean(np.gradient(path[c], time) ** 2))))
            extent.append(0.5 * float(np.ptp(path[c])))
        found.append(("speed", f"{channel.unit}/s", _quantiles(np.array(speed))))
        found.append(("swing", channel.unit, _quantiles(np.array(extent))))
        joint = problem.system.joint(channel.site)
        place = problem.system.joint_names.index(channel.site)
        pushes = [
            None
            if (e := problem.runs[w.run].effort) is None
            else float(np.sqrt(np.mean(e[w.first : w.last, place] ** 2)))
            for w in windows
        ]
        if any(pushes):
            driven = np.array([p or 0.0 for p in pushes])
            found.append(("effort", joint.force_unit, _quantiles(driven)))
    return found


def _quantiles(size: Array) -> list[Group]:
    """Groups of equally many windows, or fewer groups where there are few windows."""
    count = max(1, min(WINDOW_GROUPS, len(size) // FEWEST_WINDOWS))
    edges = np.quantile(size, np.linspace(0.0, 1.0, count + 1))
    out: list[Group] = []
    for k in range(count):
        low, high = float(edges[k]), float(edges[k + 1])
        which = (size >= low) & ((size < high) if k + 1 < count else (size <= high))
        out.append((f"{low:.3g} … {high:.3g}", (low, high), which))
    return out
