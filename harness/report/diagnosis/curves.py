"""Pictures of a diagnosis drawn from its curves: residuals over time and phase plane, energy by half-swing, spectra."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.diagnose.answer.curves import Curves, Energy, ForceMap, Residuals, Spectrum
from harness.report.diagnosis.figures import AFTER, BEFORE
from harness.report.figures.canvas import FAINT, INK, canvas

MOST_RUNS = 4  # recordings shown
POINTS = 1500  # of a curve shown; a page stays small


def pictures(curves: Curves) -> list[tuple[str, str]]:
    """Caption and SVG of every picture the curves allow."""
    out = []
    for channel in dict.fromkeys(r.channel for r in curves.residuals):
        mine = [r for r in curves.residuals if r.channel == channel]
        shown = [*mine[: MOST_RUNS - 1], *[r for r in mine[MOST_RUNS - 1 :] if r.held_out][:1]]
        out.append((f"{channel}: what each model leaves of the recording, noise ±2σ shaded", residuals(shown)))
    out += [
        (f"{f.joint}: generalized force that the nominal model lacks, over the phase plane", phase(f))
        for f in curves.forces
    ]
    out += [(f"{e.joint}: energy lost per half-swing against amplitude", energy(e)) for e in curves.energy]
    if curves.spectra:
        out.append(("Spectrum of the residual, training", spectra(curves.spectra)))
    return out


def _thin(x: Any) -> slice:
    return slice(None, None, max(1, len(x) // POINTS))


def residuals(runs: list[Residuals]) -> str:
    """SVG: measured signal and residuals of both models, a row a recording."""
    with canvas(f"residuals-{runs[0].channel}", 9.2, 2.1 * len(runs) + 0.5, len(runs), 1) as (made, axes):
        for row, r in enumerate(runs):
            ax = axes[row, 0]
            pick = _thin(r.time)
            ax.axhspan(-2 * r.noise, 2 * r.noise, color=FAINT, alpha=0.18, lw=0)
            ax.plot(r.time[pick], r.nominal[pick], color=BEFORE, lw=1.0, label="nominal")
            ax.plot(r.time[pick], r.augmented[pick], color=AFTER, lw=1.0, label="augmented")
            largest = float(np.nanmax(np.abs(r.nominal))) if np.isfinite(r.nominal).any() else r.noise
            if largest > 30 * r.noise:
                # Both must be seen: linear within a few σ, logarithmic beyond.
                ax.set_yscale("symlog", linthresh=5 * r.noise)
                # Decades within the linear part would stand on one another.
                decades = np.arange(np.ceil(np.log10(5 * r.noise)), np.log10(largest) + 0.5)
                shown = 10.0 ** decades[:: max(1, len(decades) // 2)]
                ax.set_yticks([*-shown[::-1], 0.0, *shown])
            ax.set_title(f"{r.recording}{' (held out)' if r.held_out else ''}")
            ax.set_ylabel(f"residual [{r.unit}]")
        axes[-1, 0].set_xlabel("time [s]")
        made.figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=2, labelcolor=INK)
    return str(made.svg)


def phase(f: ForceMap) -> str:
    """SVG: residual force as colour over position and velocity, and against velocity."""
    pick = _thin(f.position)
    q, v, force = f.position[pick], f.velocity[pick], f.force[pick]
    span = float(np.nanpercentile(np.abs(force), 98)) or 1.0
    unit, missing = f.units[0], f"missing force [{f.units[1].replace('*', '·')}]"
    with canvas(f"phase-{f.joint}", 9.2, 3.9, 1, 2) as (made, axes):
        marks = axes[0, 0].scatter(q, v, c=force, s=5, cmap="RdBu_r", vmin=-span, vmax=span, rasterized=True)
        axes[0, 0].set_xlabel(f"position [{unit}]")
        axes[0, 0].set_ylabel(f"velocity [{unit}/s]")
        bar = made.figure.colorbar(marks, ax=axes[0, 0])
        bar.set_label(missing)
        axes[0, 1].plot(v, force, ".", ms=2.5, color=BEFORE, alpha=0.5, rasterized=True)
        axes[0, 1].set_ylim(-1.6 * span, 1.6 * span)
        axes[0, 1].set_xlabel(f"velocity [{unit}/s]")
        axes[0, 1].set_ylabel(missing)
        for ax in axes[0]:
            # Side by side there is room for no more, when a small range needs labels of many digits.
            ax.locator_params(axis="x", nbins=5)
    return str(made.svg)


def energy(e: Energy) -> str:
    """SVG: loss per half-swing over amplitude, recorded and by each model."""
    with canvas(f"energy-{e.joint}", 9.2, 3.6) as (made, axes):
        ax = axes[0, 0]
        ax.plot(*e.nominal, "x", color=BEFORE, ms=5, label="nominal")
        ax.plot(*e.augmented, "+", color=AFTER, ms=7, label="augmented")
        ax.plot(*e.recorded, "o", color=INK, mfc="none", ms=5, label="recorded")
        ax.set_xlabel(f"amplitude [{e.unit}]")
        ax.set_ylabel("energy lost [J]")
        made.figure.legend(*ax.get_legend_handles_labels(), loc="outside upper right", ncols=3, labelcolor=INK)
    return str(made.svg)


def spectra(rows: tuple[Spectrum, ...]) -> str:
    """SVG: density of the residual of each model over frequency, a row a channel, with the noise."""
    with canvas("spectra-residual", 9.2, 2.4 * len(rows) + 0.5, len(rows), 1) as (made, axes):
        for row, s in enumerate(rows):
            ax = axes[row, 0]
            ax.loglog(s.frequency, s.nominal, color=BEFORE, lw=1.2, label="nominal")
            ax.loglog(s.frequency, s.augmented, color=AFTER, lw=1.2, label="augmented")
            ax.axhline(s.noise, color=FAINT, lw=1.2, ls=":", label="white noise of this size")
            ax.set_title(s.channel)
            ax.set_ylabel(f"density [({s.unit})²/Hz]")
        axes[-1, 0].set_xlabel("frequency [Hz]")
        made.figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper right", ncols=3, labelcolor=INK)
    return str(made.svg)
