"""What sensors and inputs do to a signal, each against its definition on a sine."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from harness.cases.case import NATIVE, Array, Bench, Case, Row, Series
from harness.cases.checks import Measured
from harness.cases.rotor import system
from harness.effects import measurement

AMPLITUDE, OMEGA, PHASE = 0.8, 7.0, 0.3  # rad, rad/s, rad
TIME = np.linspace(0.0, 6.0, 3001)


def _sine(time: Array) -> Array:
    return AMPLITUDE * np.sin(OMEGA * time + PHASE)


@dataclass(frozen=True)
class Model:
    """One function of ``harness.effects.measurement``, its parameters, and what it is to give.

    settled: [s] from which it is compared: filters begin with a guess that dies away.
    """

    name: str
    parameters: tuple[float, ...]
    truth: Callable[[Array], Array]
    source: str
    allowed: float = 1e-12
    settled: float = 0.0


def _filtered(cutoff: float, high: bool) -> Callable[[Array], Array]:
    ratio = OMEGA / (2.0 * np.pi * cutoff)
    response = (1j * ratio if high else 1.0) / (1.0 + 1j * ratio)
    return lambda t: AMPLITUDE * abs(response) * np.sin(OMEGA * t + PHASE + np.angle(response))


def _beyond(t: Array) -> Array:
    return np.sign(_sine(t)) * np.maximum(np.abs(_sine(t)) - 0.2, 0.0)


MODELS = (
    Model("offset", (0.1,), lambda t: _sine(t) + 0.1, "y + b"),
    Model("gain", (1.07,), lambda t: 1.07 * _sine(t), "g y"),
    Model("drift", (0.02,), lambda t: _sine(t) + 0.02 * t, "y + r t"),
    Model("nonlinearity", (0.1, -0.05), lambda t: _sine(t) + 0.1 * _sine(t) ** 2 - 0.05 * _sine(t) ** 3, "y + a y² + b y³"),
    Model(
        "periodic_error", (0.01, 12.0, 0.4), lambda t: _sine(t) + 0.01 * np.sin(12.0 * _sine(t) + 0.4), "y + a sin(p y + φ)"
    ),
    Model("hum", (0.03, 50.0, 0.0), lambda t: _sine(t) + 0.03 * np.sin(100.0 * np.pi * t), "y + a sin 2πf t"),
    Model("saturation", (0.5,), lambda t: np.clip(_sine(t), -0.5, 0.5), "within ± limit"),
    Model("quantisation", (0.01,), lambda t: np.round(_sine(t) / 0.01) * 0.01, "whole steps"),
    Model("deadzone", (0.2,), _beyond, "nothing within ± width"),
    Model("delay", (0.0137,), lambda t: _sine(t - 0.0137), "y(t − d)", 1e-8, 0.1),
    Model("held_delay", (0.0137,), lambda t: _sine(t - 0.0137), "y(t − d)", 1e-8, 0.1),
    Model("clock_skew", (1.003,), lambda t: _sine(t / 1.003), "y(t / s), a clock that runs s times too fast", 1e-8),
    Model("lowpass", (2.0,), _filtered(2.0, False), "1 / (1 + iω/ω_c)", 1e-6, 2.0),
    Model("highpass", (0.5, 1.0), _filtered(0.5, True), "(iω/ω_c) / (1 + iω/ω_c)", 1e-6, 5.0),
)  # fmt: skip


def models(bench: Bench) -> Iterable[Row | Series]:
    """Every model on two copies of the sine, the second looked at."""
    signal = np.stack([np.zeros_like(TIME), _sine(TIME)])
    for model in MODELS:
        function = getattr(measurement, model.name)
        found = function(signal, TIME, np.tile(model.parameters, (2, 1)))[1]
        # What would be read beyond the last sample is a guess.
        inside = (model.settled <= TIME) & (0.99 * TIME[-1] > TIME)
        apart = float(np.abs(found - model.truth(TIME))[inside].max()) / AMPLITUDE
        yield bench.row(
            f"sensor_{model.name}",
            (NATIVE, "analytic"),
            apart,
            model.allowed,
            why="cubics through samples 2 ms apart" if model.allowed > 1e-12 else "rounding",
            note="" if apart <= model.allowed else f"the measurement model {model.name.replace('_', ' ')}",
            about={"term": f"sensor_{model.name}"},
            source=model.source,
        )


CASE = Case(
    name="sensor_models",
    title="What sensors and inputs do to a signal",
    source="the definitions, on a sine",
    system=system,
    checks=(Measured("sensor_models", models),),
    group="lanes",
    engines=(NATIVE,),
)
