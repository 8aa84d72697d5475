"""Pictures of a diagnosis drawn from its curves: motion and residuals over time, missing force, energy by half-swing, spectra."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binned_statistic

from harness.diagnose.answer.curves import Curves, Energy, ForceMap, Residuals, Spectrum
from harness.effects.force_table import ForceTable
from harness.recording.units import written
from harness.report.figures.before_after import AFTER, BEFORE
from harness.report.figures.canvas import INK, canvas
from harness.report.plots import Line, Plot, thinned

Array = NDArray[np.float64]

MOST_RUNS = 4  # recordings shown
MOST_NUMBERS = 150_000  # of all curves over time together: at four bytes each, a page stays below a megabyte
MOST_POINTS, FEWEST_POINTS = 3000, 300  # of a curve shown
FAR = 1.0  # times the measured extent beyond it, to which a model that runs away is drawn
BINS = 30
FEWEST_IN_BIN = 5


def shown(residuals: Sequence[Residuals]) -> tuple[list[Residuals], int]:
    """Curves of the recordings that are shown, what is held out first, and how many recordings are not."""
    names = list(dict.fromkeys((r.recording, r.held_out) for r in residuals))
    kept = sorted(names, key=lambda name: not name[1])[:MOST_RUNS]
    return [r for name in kept for r in residuals if (r.recording, r.held_out) == name], len(names) - len(kept)


def motion(residuals: Sequence[Residuals]) -> list[Plot]:
    """Measured signal, nominal and augmented model over time: a plot a channel and recording."""
    plots = []
    for r in residuals:
        pick = _pick(r, len(residuals))
        nominal, augmented = r.measured - r.nominal, r.measured - r.augmented
        low, high = float(np.nanmin(r.measured)), float(np.nanmax(r.measured))
        far = FAR * ((high - low) or r.noise)
        away = [
            v
            for v in (nominal, augmented)
            if np.nanmin(v, initial=low) < low - far or np.nanmax(v, initial=high) > high + far
        ]
        lines = [
            Line("nominal", nominal[pick], BEFORE, "dashed"),
            Line("augmented", augmented[pick], AFTER, width=2.6),
            Line("measured", r.measured[pick], "ink", width=1.0),
        ]
        plots.append(
            Plot(
                f"motion-{_key(r)}", _title(r), "time [s]", f"{r.channel.partition('.')[2]} [{written(r.unit)}]", r.time[pick],
                _known(lines), f"{r.channel} of {r.recording} over time: measured, nominal model, augmented model",
                limits=(low - far, high + far) if away else None, together=_key(r, channel=False),
            )
        )  # fmt: skip
    return plots


def residuals(rows: Sequence[Residuals]) -> list[Plot]:
    """What each model leaves of the signal over time, noise ±2σ shaded: a plot a channel and recording."""
    plots = []
    for r in rows:
        pick = _pick(r, len(rows))
        largest = float(np.nanmax(np.abs(r.nominal), initial=r.noise))
        lines = [
            Line("nominal", r.nominal[pick], BEFORE, width=1.0),
            Line("augmented", r.augmented[pick], AFTER, width=1.0),
        ]
        plots.append(
            Plot(
                f"residuals-{_key(r)}", _title(r), "time [s]", f"residual [{written(r.unit)}]", r.time[pick], _known(lines),
                f"{r.channel} of {r.recording}: measured less each model's prediction, over time; noise of two standard deviations "
                "either way shaded",
                band=2.0 * r.noise,
                # Both must be seen: linear within a few σ, logarithmic beyond.
                linear=5.0 * r.noise if largest > 30.0 * r.noise else 0.0,
                together=_key(r, channel=False),
            )
        )  # fmt: skip
    return plots


def spectra(rows: Sequence[Spectrum]) -> list[Plot]:
    """Density of the residual of each model over frequency, with the noise: a plot a channel."""
    return [
        Plot(
            f"spectrum-{s.channel}", f"{s.channel}: spectrum of the residual", "frequency [Hz]",
            f"density [({written(s.unit)})²/Hz]", s.frequency,
            [
                Line("nominal", s.nominal, BEFORE),
                Line("augmented", s.augmented, AFTER),
                Line("white noise of this size", np.full(len(s.frequency), s.noise), "faint", "dashed"),
            ],
            f"{s.channel}: spectrum of what each model leaves of the recording",
            log="xy",
        )
        for s in rows
    ]  # fmt: skip


def force_over(f: ForceMap, axis: str) -> Plot:
    """Missing force over "velocity" or "position": every sample, and mean and spread (one standard deviation) by bin."""
    x = f.velocity if axis == "velocity" else f.position
    centre, mean, deviation = binned(x, f.force)
    order = np.argsort(x, kind="stable")
    both = np.concatenate([x[order], centre])
    place = np.argsort(both, kind="stable")
    none, gap = np.full(len(centre), np.nan), np.full(len(x), np.nan)
    dots = np.concatenate([f.force[order], none])[place]
    line, low, high = (np.concatenate([gap, v])[place] for v in (mean, mean - deviation, mean + deviation))
    span = float(np.nanpercentile(np.abs(f.force), 98)) or 1.0
    unit = f"{f.units[0]}/s" if axis == "velocity" else f.units[0]
    return Plot(
        f"force-{axis}-{f.joint}", f"{f.joint}: missing force over {axis}", f"{axis} [{unit}]",
        f"missing force [{written(f.units[1])}]", both[place],
        [Line("samples", dots, "faint", "dots"), Line("mean and spread", line, BEFORE, width=2.2, ends=(low, high))],
        f"Generalized force that the nominal model lacks at {f.joint} over {axis}, with mean and standard deviation by bin",
        limits=(-1.6 * span, 1.6 * span), height=3.2,
    )  # fmt: skip


def binned(x: Array, y: Array, bins: int = BINS) -> tuple[Array, Array, Array]:
    """Mean of x, and mean and standard deviation of y, by bin, shapes (k,).

    Bins are equal over x, each widened to the right until it holds enough samples: a line over a stretch that nobody averaged
    would be no mean. What is left at the end goes to the last one.
    """
    good = np.isfinite(x) & np.isfinite(y)
    if np.count_nonzero(good) < FEWEST_IN_BIN:
        return np.empty(0), np.empty(0), np.empty(0)
    count, edges, _ = binned_statistic(x[good], y[good], "count", bins=bins)
    wide, held = [edges[0]], 0.0
    for end, more in zip(edges[1:], count, strict=True):
        held += more
        if held >= FEWEST_IN_BIN:
            wide.append(end)
            held = 0.0
    wide[-1] = edges[-1]
    centre = binned_statistic(x[good], x[good], "mean", bins=wide)[0]
    mean, deviation = (binned_statistic(x[good], y[good], what, bins=wide)[0] for what in ("mean", "std"))
    return centre, mean, deviation


def phase(f: ForceMap) -> str:
    """SVG: missing force as colour over position and velocity."""
    pick = slice(None, None, max(1, len(f.position) // 2000))
    span = float(np.nanpercentile(np.abs(f.force), 98)) or 1.0
    with canvas(f"phase-{f.joint}", 9.2, 3.9) as (made, axes):
        marks = axes[0, 0].scatter(
            f.position[pick], f.velocity[pick], c=f.force[pick], s=7, cmap="RdBu_r", vmin=-span, vmax=span, rasterized=True
        )  # fmt: skip
        _over_the_state(f, made, axes[0, 0], marks, "missing force")
    return str(made.svg)


def _over_the_state(f: ForceMap, made: Any, ax: Any, marks: Any, what: str) -> None:
    ax.set_xlabel(f"position [{f.units[0]}]")
    ax.set_ylabel(f"velocity [{f.units[0]}/s]")
    made.figure.colorbar(marks, ax=ax).set_label(f"{what} [{written(f.units[1])}]")


def unnamed(f: ForceMap, table: ForceTable) -> str:
    """SVG: the force that acts at a joint in the best predicting model as colour over its state, and where recordings passed."""
    k = table.joints.index(f.joint)
    axes_of = [table.first[k, d] + table.step[k, d] * np.arange(n) for d, n in enumerate(table.force.shape[1:])]
    span = float(np.max(np.abs(table.force[k]))) or 1.0
    pick = slice(None, None, max(1, len(f.position) // 4000))
    with canvas(f"unnamed-{f.joint}", 9.2, 3.9) as (made, axes):
        ax = axes[0, 0]
        marks = ax.pcolormesh(
            *axes_of, table.force[k].T, cmap="RdBu_r", vmin=-span, vmax=span, shading="gouraud", rasterized=True
        )
        ax.plot(f.position[pick], f.velocity[pick], ".", color=INK, ms=0.8, alpha=0.5, rasterized=True)
        _over_the_state(f, made, ax, marks, "force")
    return str(made.svg)


def energy(e: Energy) -> str:
    """SVG: loss per half-swing over amplitude, recorded and by each model."""
    with canvas(f"energy-{e.joint}", 9.2, 3.6) as (made, axes):
        ax = axes[0, 0]
        ax.plot(*e.nominal, "x", color=BEFORE, ms=5, label="nominal")
        ax.plot(*e.augmented, "+", color=AFTER, ms=7, label="augmented")
        ax.plot(*e.recorded, "o", color=INK, mfc="none", ms=5, label="recorded")
        ax.set_xlabel(f"amplitude [{written(e.unit)}]")
        ax.set_ylabel("energy lost [J]")
        made.figure.legend(*ax.get_legend_handles_labels(), loc="outside upper right", ncols=3, labelcolor=INK)
    return str(made.svg)


def forces(curves: Curves) -> list[Plot]:
    """Missing force of every joint over its velocity and over its position."""
    return [force_over(f, axis) for f in curves.forces for axis in ("velocity", "position")]


def _pick(r: Residuals, curves: int) -> NDArray[np.intp]:
    """Samples of a curve that is one of so many on the page; the same for all its plots, so that they can be read together."""
    count = int(np.clip(MOST_NUMBERS / (7 * max(curves, 1)), FEWEST_POINTS, MOST_POINTS))
    return thinned(count, r.measured, r.nominal, r.augmented)


def _known(lines: Sequence[Line]) -> list[Line]:
    """Without a line that has nothing to show: of a model that could not be run."""
    return [line for line in lines if np.isfinite(line.values).any()]


def _key(r: Residuals, *, channel: bool = True) -> str:
    return "-".join([r.recording, "held" if r.held_out else "training", *([r.channel] if channel else [])])


def _title(r: Residuals) -> str:
    return f"{r.channel}, {r.recording} ({'held out' if r.held_out else 'training'})"
