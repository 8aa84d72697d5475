"""Recordings of two different rods in one call: each agrees with few laws by itself, and they do not with one another.

Truth: a pendulum's equation (``simulated_recordings``).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from simulated_recordings import COM, INERTIA, MASS, Rig, nominal, releases

from harness.diagnose.diagnose import diagnose
from harness.recording import Recording

ONLY = ("viscous_damping", "com_offset", "sensor_delay")
ANGLES = (1.0, 0.8, 0.9, 0.7)
LONGER = 1.1


def recorded(rigs: tuple[Rig, ...]) -> list[Recording]:
    """One release of each rig."""
    return [
        replace(releases(rig, (angle,), 1e-3, seed=seed, duration=4.0)[0], name=f"run{seed}")
        for seed, (rig, angle) in enumerate(zip(rigs, ANGLES, strict=True), 1)
    ]


def test_recordings_of_two_rods_are_told_apart() -> None:
    one = Rig(viscous=0.002)
    other = Rig(viscous=0.002, mass=LONGER * MASS, com=LONGER * COM, inertia=LONGER**3 * INERTIA)
    found = diagnose(recorded((one, other, one, other)), nominal(), only=ONLY)
    assert found.verdict in ("unexplained", "partly_explained")
    told = found.to_json()["disagreement"]
    assert told["times_noise_together"] > 10.0 and all(row["times_noise"] < 1.2 for row in told["recordings"])
    values = [
        [next(v["value"] for key, v in row["parameters"].items() if key == told["differing"][0])]
        for row in told["recordings"]
    ]
    a, b, c, d = np.ravel(values)
    # The two of one rod agree to a tenth of what they differ from the other two by.
    assert max(abs(a - c), abs(b - d)) < 0.1 * abs(a - b)
    assert "disagree with one another" in found.summary and "run4" in found.summary


def test_recordings_of_one_rod_with_a_force_that_nobody_has_named_agree() -> None:
    # A well near 0.35 rad, as of a magnet, is common to all.
    magnet = Rig(viscous=0.002, torque=lambda t, q, v: -4.0 * (q - 0.35) * np.exp(-0.5 * ((q - 0.35) / 0.07) ** 2))
    found = diagnose(recorded((magnet,) * 4), nominal(), only=ONLY)
    assert found.verdict != "explained" and "disagreement" not in found.to_json()


def test_recordings_that_are_explained_agree() -> None:
    found = diagnose(recorded((Rig(viscous=0.005),) * 4), nominal(), only=ONLY)
    assert found.verdict == "explained" and found.disagreement is None
