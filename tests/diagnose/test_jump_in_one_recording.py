"""An encoder that slips once in one of several recordings: noise estimated with the jump in it has the jump's colour.

Under that colour the jump was worth nothing, and what it left was told as a force that nobody has named.
"""

from __future__ import annotations

import numpy as np
from simulated_recordings import Rig, nominal, recording, swing

from harness import diagnose

NOISE, JUMP, WHEN = 3e-4, 0.012, 4.2  # rad, rad, s


def test_a_slip_in_one_recording_is_told_with_its_time() -> None:
    rng = np.random.default_rng(21)
    time = np.arange(0.0, 8.0, 0.01)
    runs = []
    for name, angle in (("a", 1.3), ("b", 0.9), ("c", 1.0)):
        seen = swing(Rig(com=0.249), angle, time) + JUMP * (time > WHEN) * (name == "b")
        runs.append(recording(name, time, {"pivot.position": seen + NOISE * rng.standard_normal(len(time))}))
    found = diagnose(runs, model=nominal())
    assert found.verdict == "unexplained"
    assert not found.findings
    # The first reading after the slip.
    assert "What is left shows as a jump of the reading (pivot.position, b at 4.21 s)." in found.summary
