"""A decay as plain values, schema ``denoc.decay/1``."""

from __future__ import annotations

from typing import Any

import numpy as np

from harness.compare.decay.apart import Apart
from harness.compare.decay.bands import Band
from harness.compare.decay.estimate import Decay
from harness.compare.decay.oscillator import LAWS, TORQUE_UNITS, UNITS, Array

SCHEMA = "denoc.decay/1"


def document(found: Decay, *, source: str, channel: str, inertia: float | None = None) -> dict[str, Any]:
    """All estimates of one decay; inertia: of the joint [kg·m²], by which coefficients become torques, None leaves them over it."""
    factor = 1.0 if inertia is None else inertia
    units = UNITS if inertia is None else TORQUE_UNITS
    swings, read = found.swings, found.decrement
    linear = found.linear
    return {
        "schema": SCHEMA,
        "source": source,
        "channel": channel,
        "inertia": inertia,
        "restoring": "sine" if swings.sine else "linear",
        "half_swings": len(swings.amplitude),
        "from": float(found.time[0]),
        "to": float(swings.time[-1]),
        "rest": swings.rest,
        "frequency": {
            "small": found.likelihood.frequency,
            "first": float(swings.frequency[0]),
            "last": float(swings.frequency[-1]),
        },
        "amplitude": {"first": float(swings.amplitude[0]), "last": float(swings.amplitude[-1])},
        "decrement": {
            "ratio": read.ratio,
            "value": read.decrement,
            "std": read.std,
            "damping_ratio": read.damping_ratio,
            "viscous": {"value": read.viscous * factor, "std": read.viscous_std * factor, "unit": units["viscous"]},
            "printed": {"value": read.printed * factor, "unit": units["viscous"]},
        },
        "envelope": _laws(found.envelope.coefficients * factor, found.envelope.std * factor, units)
        | {"rms": found.envelope.rms},
        "likelihood": {
            "laws": list(found.likelihood.laws),
            **_laws(found.likelihood.coefficients * factor, found.likelihood.std * factor, units),
            "rms": found.likelihood.rms,
            "memory": found.likelihood.memory,
            "noise": swings.noise,
        },
        "linear": _laws(linear.coefficients * factor, linear.std * factor, units) | {"rms": linear.rms},
        "tried": [{"laws": list(one.laws), "bic": one.bic - found.tried[0].bic, "rms": one.rms} for one in found.tried],
        "departure": found.departure,
    }


def _laws(values: Array, std: Array, units: dict[str, str]) -> dict[str, Any]:
    return {
        law: {
            "value": float(value),
            "std": float(sigma),
            "ci95": [float(max(value - 1.96 * sigma, 0.0)), float(value + 1.96 * sigma)],
            "unit": units[law],
        }
        for law, value, sigma in zip(LAWS, values, std, strict=True)
    }


def bands_document(found: tuple[Band, ...]) -> list[dict[str, Any]]:
    """Bands of one signal as plain values."""
    return [
        {
            "band": band.name,
            "frequency": _interval(band.frequency, "Hz"),
            "line": band.line,
            "amplitude": _interval(band.amplitude, ""),
            "rate": _interval(band.rate, "1/s"),
            "damping_ratio": _interval(band.damping_ratio, "1"),
            "half_swings": len(band.turning[0]),
        }
        for band in found
    ]


def apart_document(found: Apart) -> dict[str, Any]:
    """Damping of joint and link, told apart, as plain values."""
    return {
        "link": found.link,
        "mode": found.mode,
        "frequency": {"value": found.frequency, "unit": "Hz"},
        "joint": _interval(found.joint, TORQUE_UNITS["viscous"]),
        "by_joint": _interval(found.by_joint, "1"),
        "modal": _interval(found.modal, "1"),
    }


def _interval(values: tuple[float, float, float], unit: str) -> dict[str, Any]:
    value, low, high = (float(np.float64(v)) for v in values)
    return {"value": value, "ci95": [low, high], "unit": unit}
