"""A decay drawn: the recording and what is fitted to it, the amplitudes, the decrement against amplitude; and its bands."""

from __future__ import annotations

import numpy as np

from harness.compare.decay.bands import Band
from harness.compare.decay.estimate import Decay
from harness.compare.decay.oscillator import Array, amplitudes
from harness.report.figures.canvas import FAINT, INK, canvas
from harness.report.pictures import alone

BLUE, RED, GREEN = "#0a7bbd", "#d55e00", "#009e73"


def decay_picture(found: Decay, channel: str, unit: str) -> str:
    """SVG of one decay, on white."""
    swings, circular = found.swings, 2.0 * np.pi * found.swings.small
    with canvas("decay", 9.2, 8.2, rows=3, height_ratios=[3, 2, 2]) as (made, axes):
        top, middle, bottom = axes[:, 0]
        top.plot(found.time, found.signal, ".", color=FAINT, ms=1.5, label="recording", rasterized=True)
        best = found.likelihood
        top.plot(
            best.time,
            best.predicted,
            color=BLUE,
            lw=1.0,
            label=f"{' and '.join(best.laws) or 'no damping'}, every sample",
        )
        top.set_ylabel(f"{channel} [{unit}]")
        top.set_xlabel("time [s]")
        count = len(swings.amplitude)
        middle.plot(swings.time, swings.amplitude, "o", color=INK, mfc="none", ms=4, label="half-swings")
        middle.plot(
            swings.time, found.envelope.amplitude, color=BLUE, lw=1.2, label="dry + viscous + quadratic envelope"
        )
        linear = np.array([found.decrement.viscous, 0.0, 0.0])
        middle.plot(
            swings.time,
            amplitudes(float(swings.amplitude[0]), count, linear, circular, sine=swings.sine),
            color=RED,
            lw=1.2,
            ls="--",
            label="decrement's viscous damping",
        )
        middle.set_yscale("log")
        middle.set_ylabel(f"amplitude [{unit}]")
        middle.set_xlabel("time [s]")
        if found.departure is not None:
            middle.axvline(found.departure, color=FAINT, lw=1.2, ls=":")
            told = f"linear leaves at {found.departure:.3g} s"
            middle.annotate(told, (found.departure, 0.12), xycoords=("data", "axes fraction"),
                            xytext=(5, 0), textcoords="offset points", color=INK, va="top")  # fmt: skip
        amplitude, each = found.decrement.by_amplitude
        bottom.plot(amplitude, each, "o", color=INK, mfc="none", ms=4, label="each pair of swings")
        bottom.plot(
            *_curve(found, found.envelope.coefficients), color=BLUE, lw=1.2, label="dry + viscous + quadratic envelope"
        )
        bottom.axhline(found.decrement.decrement, color=RED, lw=1.2, ls="--", label="one decrement for all")
        # A pair of swings in the noise has a decrement of any size.
        bottom.set_ylim(0.0, 1.6 * float(np.quantile(each, 0.95)))
        bottom.set_xlabel(f"amplitude [{unit}]")
        bottom.set_ylabel("logarithmic decrement")
        for ax in (top, middle, bottom):
            ax.legend(loc="upper right" if ax is not bottom else "best", labelcolor=INK, fontsize=8.5)
    return alone(str(made.svg))


def _curve(found: Decay, coefficients: Array) -> tuple[Array, Array]:
    swings = found.swings
    circular = 2.0 * np.pi * swings.small
    grid = np.geomspace(float(swings.amplitude[-1]), float(swings.amplitude[0]), 60)
    three = np.array([amplitudes(float(a), 3, coefficients, circular, sine=swings.sine) for a in grid])
    good = three[:, 2] > 0.0
    return three[good, 1], np.log(three[good, 0] / three[good, 2])


def bands_picture(found: tuple[Band, ...], whole: tuple[Array, Array], label: str) -> str:
    """SVG: the signal, and each band with its amplitudes and fitted decay, on white; label: axis text with its unit."""
    with canvas("bands", 9.2, 7.2, rows=1 + len(found), sharex=True) as (made, axes):
        axes[0, 0].plot(*whole, color=INK, lw=0.7)
        axes[0, 0].set_ylabel(label)
        axes[0, 0].set_title("as recorded")
        for ax, band, colour in zip(axes[1:, 0], found, (BLUE, GREEN), strict=False):
            ax.plot(band.time, band.signal, color=colour, lw=0.7)
            t, a = band.turning
            ax.plot(t, a, "o", color=INK, mfc="none", ms=3)
            curve = band.amplitude[0] * np.exp(-band.rate[0] * (t - t[0]))
            ax.plot(t, curve, color=RED, lw=1.3)
            low, high = band.damping_ratio[1:]
            ax.set_title(
                f"{band.name}: {band.frequency[0]:.4g} Hz, amplitude {band.amplitude[0]:.3g}, "
                f"damping ratio {band.damping_ratio[0]:.3g} ({low:.3g} to {high:.3g})"
            )
            ax.set_ylabel(label)
        axes[-1, 0].set_xlabel("time [s]")
    return alone(str(made.svg))
