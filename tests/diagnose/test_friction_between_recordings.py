"""Friction and efforts that every recording has a little more or less of, beside a force over the state that all of them share.

Recordings by SciPy's integration; levels as bearings that warm up have them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import ARM

import harness
from harness.recording import Channel, Recording
from harness.system.description import constant

LEVELS = (0.75, 1.3, 0.85, 1.1)
ABOUT, WEIGHT = 0.01 + 1e-3 + 0.55 * 0.14**2, 9.81 * 0.55 * 0.14


def swung(
    name: str, start: float, random: np.random.Generator, *,
    level: float = 1.0, torque: Callable[[Any], Any] = np.zeros_like, gain: float = 1.0, seconds: float = 2.5,
) -> Recording:  # fmt: skip
    """The arm let go at rest from an angle, with friction of a level, 0.03 N·m of a force over the state that no law has, and a
    torque of which it gets a share: read at 100 Hz with 0.2 mrad of noise."""

    def slope(t, y):
        rubbing = level * (0.02 * np.tanh(y[1] / 1e-3) + 0.05 * y[1])
        unknown = 0.03 * np.sin(3.0 * y[0] + 0.2 * y[1])
        return y[1], (gain * float(torque(t)) - WEIGHT * np.sin(y[0]) - rubbing + unknown) / ABOUT

    time = np.arange(0.0, seconds, 0.01)
    exact = solve_ivp(slope, (0.0, seconds), (start, 0.0), t_eval=time, method="LSODA", rtol=1e-8, atol=1e-10).y[0]
    read = constant(exact + 2e-4 * random.normal(size=len(time)))
    efforts = (Channel("servo.effort", "servo", "effort", "N·m", constant(torque(time))),)
    return Recording(
        name, name, constant(time), (Channel("servo.position", "servo", "position", "rad", read),),
        efforts if efforts[0].values.any() else (),
    )  # fmt: skip


def drops(levels: tuple[float, ...]) -> list[Recording]:
    """Drops from four heights with friction of these levels."""
    random = np.random.default_rng(3)
    heights = zip((-1.4, -0.6, -1.0, -1.2), levels, strict=True)
    return [swung(f"drop{k}", start, random, level=level) for k, (start, level) in enumerate(heights)]


@pytest.mark.parametrize("levels", [LEVELS, (1.0,) * 4])
def test_by_how_much_friction_differs_between_recordings_is_told(levels, tmp_path) -> None:
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    found = harness.diagnose(drops(levels), model, only=("viscous_damping", "coulomb_friction", "payload_mass"))
    (row,) = found.to_json()["discrepancy"]
    if np.std(levels) == 0.0:
        assert "between_recordings" not in row
        return
    # Dry friction differs by a quarter of 0.02 N·m, viscous friction by a quarter of 0.05 N·m·s/rad times 3 rad/s.
    assert 0.3 * 0.02 * np.std(levels) < row["between_recordings"] < 3.0 * 0.05 * 3.0 * np.std(levels)
    assert "Friction differs from recording to recording" in found.summary


GAINS = (1.0, 1.06, 0.95, 1.02)


def driven(gains: tuple[float, ...]) -> list[Recording]:
    """The same arm driven by four torques that a drive makes more or less of."""
    random, out = np.random.default_rng(4), []
    for k, gain in enumerate(gains):
        about, phases = random.uniform(0.3, 2.0, 4), random.uniform(0.0, 6.28, 4)

        def torque(t, about=about, phases=phases):
            waves = np.sin(2.0 * np.pi * about * np.asarray(t)[..., None] + phases)
            return 0.15 * np.minimum(np.asarray(t) / 0.3, 1.0) * waves.sum(axis=-1)

        out.append(swung(f"drive{k}", 0.0, random, torque=torque, gain=gain, seconds=4.0))
    return out


@pytest.mark.parametrize("gains", [GAINS, (1.0,) * 4])
def test_by_how_much_efforts_differ_between_recordings_is_told(gains, tmp_path) -> None:
    model = tmp_path / "arm.toml"
    model.write_text(ARM)
    found = harness.diagnose(driven(gains), model, only=("viscous_damping", "coulomb_friction", "payload_mass"))
    (row,) = found.to_json()["discrepancy"]
    if np.std(gains) == 0.0:
        assert "effort_gain_between_recordings" not in row
        return
    assert row["effort_gain_between_recordings"] == pytest.approx(np.std(gains), rel=0.7)
    assert "differs from recording to recording" in found.summary
    assert "between_recordings" not in row
