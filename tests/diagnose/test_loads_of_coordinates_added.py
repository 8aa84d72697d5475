"""Loads behind a gear under a model with effects that act through coordinates of their own, which no encoder reads.

Origin: of a point mass on a rigid rod, m l² θ̈ + m g l sin θ.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_second_encoders import GRAVITY, LENGTH, MASS, model

from harness.diagnose.transmission.transmission import instead_of_the_drives
from harness.diagnose.transmission.twist import behind_the_gears, twists
from harness.recording import Channel, Recording
from harness.system import Attachment, load
from harness.system.description import constant

SIZE, OMEGA, CUTOFF = 0.4, 2.0 * np.pi * 0.5, 6.0  # rad, rad/s, Hz
ADDED = {
    "base_compliance": ("base", {"stiffness": 4e4, "mass": 5.0, "damping": 10.0}),
    "link_flexibility": ("arm", {"frequency": 14.0, "damping_ratio": 0.01}),
    "joint_flexibility": ("shoulder", {"stiffness": 900.0, "damping": 0.5}),
    "backlash": ("shoulder", {"gap": 0.01}),
}


@pytest.mark.parametrize("name", ADDED)
def test_loads_are_those_of_links_that_follow_their_joints(tmp_path: Path, name: str) -> None:
    system = load(model(tmp_path))
    site, values = ADDED[name]
    whole = replace(system, attachments=(Attachment(name, site, values),))
    time = np.arange(0.0, 8.0, 0.004)
    q = SIZE * np.sin(OMEGA * time)
    channels = [
        Channel(f"shoulder.{what}", "shoulder", what, "rad", constant(q)) for what in ("position", "link_position")
    ]
    recording = Recording("run", "run", constant(time), (channels[0],), ())
    found = twists(system, recording, channels[1:], {}, {}, CUTOFF, behind_the_gears(whole))["shoulder"]
    angle = SIZE * np.sin(OMEGA * found.time)
    expected = -MASS * LENGTH**2 * OMEGA**2 * angle + MASS * GRAVITY * LENGTH * np.sin(angle)
    # A low-pass knows nothing of what comes before a recording begins.
    np.testing.assert_allclose(found.load, expected, atol=1e-2 * np.abs(expected).max())


def test_what_encoders_on_both_sides_tell_stands_in_the_model_once(tmp_path: Path) -> None:
    drive, both = (
        Attachment("joint_flexibility", "shoulder", {"stiffness": k, "damping": 0.0}) for k in (700.0, 900.0)
    )
    friction = Attachment("coulomb_friction", "shoulder", {"torque": 0.1})
    whole = instead_of_the_drives(replace(load(model(tmp_path)), attachments=(drive, friction)), [both])
    assert whole.attachments == (friction, both)
