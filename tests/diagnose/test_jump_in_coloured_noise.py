"""An encoder that skips once in every recording, under noise that remembers.

Coloured noise makes of a lasting jump a single sharp sample, which lies between the places of any grid: the skip was told as a
drift of the sensor, the residual as noise.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter
from simulated_recordings import Rig, nominal, recording, swing

from harness import diagnose

STD, COLOUR, STEP = 5e-4, 0.5, 1e-3  # rad: noise, AR(1) coefficient of a sample, quantisation
JUMP, WHEN = 6e-3, 5.37  # rad, s


def test_a_skip_is_no_drift() -> None:
    rng = np.random.default_rng(3)
    time = np.arange(0.0, 10.5, 0.01)
    runs = []
    for k, angle in enumerate((1.1, -0.8)):
        white = STD * rng.standard_normal(len(time) + 100)
        noise = lfilter([np.sqrt(1.0 - COLOUR**2)], [1.0, -COLOUR], white)[100:]
        seen = swing(Rig(), angle, time) + JUMP * (time >= WHEN) + noise
        runs.append(recording(f"run{k}", time, {"pivot.position": np.round(seen / STEP) * STEP}))
    found = diagnose(runs, model=nominal())
    assert found.verdict == "unexplained"
    assert not found.findings
    assert "a jump of the reading" in found.summary
