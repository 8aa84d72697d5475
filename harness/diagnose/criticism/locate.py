"""Where the nominal model leaves the recordings: channel, times, frequencies, region of the motion, and the misfit's shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.criticism.constants import LOCATED_BAND_SHARE, LOCATED_CHANCE, LOCATED_PIECES
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.outcome import Outcome

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Mismatch:
    """One place where the nominal model does not hold; fields as in the JSON of a diagnosis."""

    channel: str
    side: str
    site: str
    time: tuple[tuple[float, float], ...]
    frequency_hz: tuple[float, float]
    region: dict[str, tuple[float, float]]
    severity: float
    what: str


def raw_residuals(outcome: Outcome, fitted: Fit) -> list[tuple[Array, Array]]:
    """Per window of a fit: times of its samples in the recording [s], and measurement − prediction (C, T), nan where none."""
    out = []
    for window in fitted.windows:
        run = outcome.problem.runs[window.run]
        prediction = outcome.predictor.predict(
            fitted.hypothesis, fitted.x[None, :], [(0, window, fitted.states[window])]
        )[0]
        part = slice(window.first, window.last)
        out.append((run.time[part], run.values[:, part] - prediction))
    return out


def rmse(outcome: Outcome, fitted: Fit, channel: int) -> float:
    """Root mean square of a channel's residual over a fit's windows [channel unit]; nan where it has no sample there."""
    pooled = np.concatenate([r[channel] for _, r in raw_residuals(outcome, fitted)])
    read = pooled[np.isfinite(pooled)]
    return float(np.sqrt(np.mean(read**2))) if len(read) else np.nan


def locate(outcome: Outcome, side: str, site: str) -> tuple[Mismatch, ...]:
    """Significant mismatches of the nominal model, one a channel, worst first.

    side, site: what the diagnosis attributes them to.
    """
    found = []
    nominal = outcome.nominal
    pieces = raw_residuals(outcome, nominal)
    for c, channel in enumerate(outcome.problem.channels):
        noise = outcome.noise[c]
        white = []
        for window, r in zip(nominal.windows, nominal.linear.residuals, strict=True):
            white.append(r.reshape(len(outcome.problem.channels), window.size)[c])
        intervals: list[tuple[float, float]] = []
        for (time, _), w in zip(pieces, white, strict=True):
            intervals += _windows(time, w)
        if not intervals:
            continue
        residual = np.concatenate([r[c] for _, r in pieces])
        severity = float(np.sqrt(np.nanmean(residual**2)) / noise)
        run = outcome.problem.runs[nominal.windows[0].run]
        band = _band(pieces[0][1][c], run.interval, noise)
        found.append(
            Mismatch(
                channel.name, side, site, tuple(_joined(intervals)), band, _region(outcome, nominal, c, pieces), severity,
                _words(outcome, nominal, c, pieces),
            )
        )  # fmt: skip
    return tuple(sorted(found, key=lambda m: -m.severity))


def _windows(time: Array, white: Array) -> list[tuple[float, float]]:
    """Stretches of time where the whitened residual is more than noise."""
    out = []
    for index in np.array_split(np.arange(len(white)), LOCATED_PIECES):
        used = white[index][white[index] != 0.0]
        if len(used) >= 5 and chi2.sf(float(used @ used), len(used)) < LOCATED_CHANCE / LOCATED_PIECES:
            out.append((float(time[index[0]]), float(time[index[-1]])))
    return out


def _joined(intervals: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Intervals of all recordings on one time axis, neighbours joined."""
    joined: list[tuple[float, float]] = []
    for low, high in sorted(intervals):
        if joined and low <= joined[-1][1] + 0.15 * (high - low) + 1e-9:
            joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
        else:
            joined.append((low, high))
    return [(round(a, 4), round(b, 4)) for a, b in joined]


def _band(residual: Array, interval: float, noise: float) -> tuple[float, float]:
    """Frequencies [Hz] between which the misfit has nine tenths of its power."""
    x = np.nan_to_num(residual)
    taper = np.hanning(len(x) + 2)[1:-1]
    power = np.abs(np.fft.rfft(x * taper)) ** 2 / float(np.sum(taper**2))
    power = np.maximum(power - 2.0 * noise**2, 0.0)
    return band_of(np.asarray(np.fft.rfftfreq(len(x), interval), dtype=np.float64), power)


def band_of(frequency: Array, power: Array) -> tuple[float, float]:
    """Between which frequencies [Hz] nine tenths of a power lie, as they are told; all of them where there is none."""
    total = np.cumsum(power)
    low, high = 0, len(total) - 1
    if total[-1] > 0.0:
        share = 0.5 * (1.0 - LOCATED_BAND_SHARE)
        low, high = (int(np.searchsorted(total, part * total[-1])) for part in (share, 1.0 - share))
    return (round(float(frequency[low]), 4), round(float(frequency[min(high, len(frequency) - 1)]), 4))


def _motion(outcome: Outcome, channel: int) -> int | None:
    """The channel that measures the motion which a channel is looked at over, or None if none does."""
    site = outcome.problem.channels[channel].site
    names = outcome.problem.system.joint_names
    return outcome.problem.position_of(site if site in names else outcome.problem.system.carrier(site).name)


def _region(
    outcome: Outcome, fitted: Fit, channel: int, pieces: list[tuple[Array, Array]]
) -> dict[str, tuple[float, float]]:
    """Ranges of position and velocity that hold nine tenths of the squared misfit."""
    c = _motion(outcome, channel)
    if c is None:
        return {}
    positions, speeds, weights = [], [], []
    for window, (time, residual) in zip(fitted.windows, pieces, strict=True):
        run = outcome.problem.runs[window.run]
        q = run.values[c, window.first : window.last]
        smooth = np.convolve(np.nan_to_num(q), np.ones(5) / 5.0, mode="same")
        positions.append(q)
        speeds.append(np.gradient(smooth, time))
        weights.append(np.nan_to_num(residual[channel]) ** 2)
    q, v, w = (np.concatenate(x) for x in (positions, speeds, weights))
    good = np.isfinite(q) & np.isfinite(v)
    return {"position": _weighted(q[good], w[good]), "velocity": _weighted(v[good], w[good])}


def _weighted(values: Array, weights: Array) -> tuple[float, float]:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    if total[-1] <= 0.0:
        return (float(values.min()), float(values.max()))
    low, high = np.searchsorted(total, [0.05 * total[-1], 0.95 * total[-1]])
    return (round(float(values[order][low]), 5), round(float(values[order][min(high, len(values) - 1)]), 5))


def _words(outcome: Outcome, fitted: Fit, channel: int, pieces: list[tuple[Array, Array]]) -> str:
    """The misfit's shape in words: offset, amplitude, phase, each by its share of the squared misfit."""
    shares: dict[str, float] = {"offset": 0.0, "amplitude": 0.0, "phase": 0.0}
    total = 0.0
    early: list[float] = []
    late: list[float] = []
    for window, (time, residual) in zip(fitted.windows, pieces, strict=True):
        prediction = outcome.predictor.predict(
            fitted.hypothesis, fitted.x[None, :], [(0, window, fitted.states[window])]
        )[0][channel]
        r = np.nan_to_num(residual[channel])
        slope = np.gradient(prediction, time)
        for index in np.array_split(np.arange(len(r)), min(8, len(r))):
            part = r[index]
            total += float(part @ part)
            basis = {
                "offset": np.ones(len(index)),
                "amplitude": prediction[index] - prediction[index].mean(),
                "phase": slope[index] - slope[index].mean(),
            }
            for name, b in basis.items():
                size = float(b @ b)
                if size > 0.0:
                    shares[name] += float(b @ part) ** 2 / size
            amplitude = basis["amplitude"]
            if amplitude @ amplitude > 0.0:
                (early if index[0] < len(r) // 2 else late).append(float(amplitude @ part / (amplitude @ amplitude)))
    if total <= 0.0:
        return "no misfit"
    words = []
    for name, share in sorted(shares.items(), key=lambda item: -item[1]):
        if share < 0.2 * total:
            continue
        if name == "offset":
            words.append("the mean is shifted")
        elif name == "phase":
            words.append("the phase runs away")
        else:
            grows = np.mean(late) if late else 0.0
            words.append(
                "amplitude is lost faster than modelled"
                if grows < 0.0
                else "amplitude is lost more slowly than modelled"
            )
    return ", ".join(words) if words else "the misfit has no simple shape: neither offset nor amplitude nor phase"
