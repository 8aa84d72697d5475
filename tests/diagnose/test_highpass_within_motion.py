"""A sensor that forgets, on a chaotic chain: where the recording is cut its filter stands somewhere, and nothing says where."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from simulated_recordings import recording

import harness
from harness.compare.bench.peers import peer_model
from harness.effects import measurement

CUTOFF, NOISE, RATE, FINE, LENGTH = 0.1, 1e-3, 200, 2000, 10.0  # Hz, rad, Hz, Hz, s


def forgetting(signal: np.ndarray) -> np.ndarray:
    """A high-pass at ``FINE`` that was at rest at zero until its first sample, of straight lines between samples."""
    a = np.pi * CUTOFF / FINE
    settled, out = 0.0, [signal[0]]
    for before, now in pairwise(signal):
        settled = (settled * (1.0 - a) + a * (before + now)) / (1.0 + a)
        out.append(now - settled)
    return np.array(out)


def test_a_sensor_that_forgets_is_named_though_the_recording_is_cut() -> None:
    chain = harness.load("models/urdf/double_pendulum.urdf")
    mujoco = peer_model("mujoco", chain)
    rng = np.random.default_rng(29)
    fine = np.arange(0.0, LENGTH + 0.5 / FINE, 1.0 / FINE)
    runs = []
    # Released near the top: an error grows by far more than a hundred times within the recording.
    for k, start in enumerate(([2.9, 2.4], [-2.7, 2.3])):
        moved = mujoco.simulate(np.array(start), np.zeros(2), fine, step=1e-4).position
        read = np.stack([forgetting(moved[:, 0]), moved[:, 1]])[:, :: FINE // RATE]
        read += NOISE * rng.standard_normal(read.shape)
        columns = dict(zip(("shoulder.position", "elbow.position"), read, strict=True))
        runs.append(recording(f"run{k}", fine[:: FINE // RATE], columns))
    found = harness.diagnose(
        runs, chain,
        only=["sensor_highpass", "sensor_drift", "sensor_offset", "sensor_zero", "viscous_damping", "joint_stiffness"],
    ).to_json()  # fmt: skip
    assert found["verdict"] == "explained"
    (finding,) = found["findings"]
    assert (finding["effect"], finding["site"]) == ("sensor_highpass", "shoulder.position")
    low, high = finding["parameters"]["cutoff"]["ci95"]
    assert low <= CUTOFF <= high
    assert high - low < 0.01 * CUTOFF


@pytest.mark.parametrize(("start", "off"), [(0.0, 0.0), (0.0, 0.002), (2.0, 0.0)])
def test_what_a_highpass_remembers_is_small_only_where_the_recording_begins(start: float, off: float) -> None:
    time = start + np.arange(0.0, 2.0, 0.01)
    time[1::2] += off
    params = np.array([[CUTOFF, 0.0]])
    lag = 1.0 / (2.0 * np.pi * CUTOFF)
    course, size = measurement.highpass_memory(1.5 * np.cos(time[None] - start), time, params)
    assert np.allclose(course[0], -np.exp(-(time - start) / lag), rtol=0.0, atol=1e-15)
    # Intervals are 0.01 s ± off: in so much more or less time the low-pass takes up off/lag of the first value.
    assert size[0] == pytest.approx(1.5 if start else 1.5 * off / lag, rel=1e-3, abs=1e-12)
