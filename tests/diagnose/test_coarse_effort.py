"""Efforts recorded at few samples a period act as the smooth signal that they were taken from."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from simulated_recordings import Rig, nominal, recording

from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.candidates import candidates
from harness.diagnose.problem.drive import Drive
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import pose
from harness.diagnose.problem.windows import Window

FREQUENCY, TORQUE = 3.0, 0.2  # Hz, N·m


@pytest.mark.parametrize("jitter", [0.0, 0.4])
@pytest.mark.parametrize("rate", [50.0, 60.0, 100.0])
def test_effort_between_coarse_samples(rate: float, jitter: float) -> None:
    # SciPy integrates under the sine itself. Straight lines through its samples would lose (ω h)²/12 of it: 1.2 % at 50 Hz. What
    # they lose is put back, up to about (ω h)⁴/90. Samples that lie anywhere between a simulation's steps lose as much again.
    rig = Rig()
    omega = 2.0 * np.pi * FREQUENCY
    time = np.arange(0.0, 4.0, 1.0 / rate)
    time[1:-1] += jitter / rate * np.random.default_rng(6).uniform(-1.0, 1.0, len(time) - 2)

    def rate_of(t: float, y: np.ndarray) -> list[float]:
        return [y[1], (TORQUE * np.sin(omega * t) - rig.moment * np.sin(y[0])) / rig.about_joint]

    true = solve_ivp(rate_of, (0.0, time[-1]), [0.1, 0.0], method="DOP853", rtol=1e-11, atol=1e-12, t_eval=time).y[0]
    free = solve_ivp(
        lambda t, y: [y[1], -rig.moment * np.sin(y[0]) / rig.about_joint], (0.0, time[-1]), [0.1, 0.0],
        method="DOP853", rtol=1e-11, atol=1e-12, t_eval=time,
    ).y[0]  # fmt: skip
    system = nominal()
    columns = {"pivot.position": true, "pivot.effort": TORQUE * np.sin(omega * time)}
    predictor = Predictor(pose(system, [recording(f"run{k}", time, columns) for k in range(2)]))
    x = np.zeros(predictor.size(Hypothesis()))
    (predicted,) = predictor.predict(Hypothesis(), x[None], [(0, Window(0, 0, len(time)), np.array([0.1, 0.0]))])
    # Of uneven samples the widest pairs count.
    share = (omega * np.diff(time).max()) ** 4 / 90.0
    caused = np.abs(true - free).max()
    assert np.abs(predicted[0] - true).max() < 3.0 * (share + 1e-5) * caused


def test_a_gap_is_bridged_by_a_straight_line() -> None:
    """Slopes of two noisy samples would swing a curve far out over a hundred intervals without samples."""
    rng = np.random.default_rng(2)
    time = np.concatenate([np.arange(0.0, 1.0, 0.002), np.arange(1.5, 2.5, 0.002)])
    effort = 0.5 * time + 0.01 * rng.standard_normal(len(time))
    columns = {"pivot.position": 0.1 * np.cos(time), "pivot.effort": effort}
    run = pose(nominal(), [recording(f"run{k}", time, columns) for k in range(2)]).runs[0]
    assert run.effort is not None
    inside = np.arange(1.02, 1.48, 0.002)
    acting = Drive(run, run.effort.T, held=False).at(inside, 0)
    assert np.abs(acting - 0.5 * inside).max() < 0.04  # four standard deviations of the noise at its ends


@pytest.mark.parametrize(("jitter", "points"), [(0.0, 40_000), (0.4, 40_000), (0.0, 1000)])
def test_a_dead_zone_opens_between_samples(jitter: float, points: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """SciPy integrates under the sine as a dead zone leaves it, whose corners lie anywhere between the samples."""
    monkeypatch.setattr("harness.diagnose.problem.drive.MOST_EFFORT_POINTS", points)
    rig, omega, width, rate = Rig(), 2.0 * np.pi * FREQUENCY, 0.4 * TORQUE, 60.0
    time = np.arange(0.0, 4.0, 1.0 / rate)
    time[1:-1] += jitter / rate * np.random.default_rng(6).uniform(-1.0, 1.0, len(time) - 2)

    def slope(t: float, y: np.ndarray, zone: float) -> list[float]:
        effort = TORQUE * np.sin(omega * t)
        acting = effort - np.clip(effort, -zone, zone)
        return [y[1], (acting - rig.moment * np.sin(y[0])) / rig.about_joint]

    true, whole = (
        solve_ivp(
            slope, (0.0, time[-1]), [0.1, 0.0], args=(zone,), method="DOP853", rtol=1e-9, atol=1e-11, t_eval=time,
            max_step=0.002,
        ).y[0]
        for zone in (width, 0.0)
    )  # fmt: skip
    columns = {"pivot.position": true, "pivot.effort": TORQUE * np.sin(omega * time)}
    system, runs = nominal(), [recording(f"run{k}", time, columns) for k in range(2)]
    predictor = Predictor(pose(system, runs))
    (member,) = candidates(system, runs, only=["actuator_deadzone"])
    x = np.concatenate([np.zeros(len(predictor.nominal)), to_internal(member, np.array([width]))])
    window = Window(0, 0, len(time))
    (predicted,) = predictor.predict(Hypothesis((member,)), x[None], [(0, window, np.array([0.1, 0.0]))])
    # Corners that are joined by straight lines between samples would cost (ω h)²/16 of what the zone does: 6e-3.
    assert np.abs(predicted[0] - true).max() < 1.5e-3 * np.abs(true - whole).max()
