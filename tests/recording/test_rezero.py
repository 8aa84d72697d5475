"""An angle whose zero is set anew while the joint rests, and what looks like it but is motion."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.recording import read_recording
from harness.recording.rezero import undo_rezeroing

RATE = 200.0
STEP = 2.0 * np.pi / 8192.0


def decay_and_drive() -> tuple[np.ndarray, np.ndarray]:
    """A swing that has died out by 6 s, rests, and is driven from 8 s on; an angle in encoder counts."""
    time = np.arange(0.0, 12.0, 1.0 / RATE)
    swing = np.where(time < 6.0, (1.0 - time / 6.0) * np.cos(6.0 * time), 0.0)
    driven = np.where(time > 8.0, 0.3 * (1.0 - np.cos(4.0 * (time - 8.0))), 0.0)
    return time, np.round((swing + driven) / STEP) * STEP


def test_zero_set_anew_at_rest_is_undone() -> None:
    time, angle = decay_and_drive()
    recorded = angle + np.where(time > 7.0, 24.0 * STEP, 0.0)
    mended, notes = undo_rezeroing("hip.position", "rad", time, recorded, STEP)
    np.testing.assert_allclose(mended, angle, atol=1e-12)
    assert [n.kind for n in notes] == ["rezeroed"]
    assert notes[0].size == pytest.approx(24.0 * STEP)
    assert notes[0].where[0][0] == pytest.approx(7.0, abs=0.01)


def test_motion_is_left_alone() -> None:
    time, angle = decay_and_drive()
    assert undo_rezeroing("hip.position", "rad", time, angle, STEP)[1] == ()
    noisy = angle + 1e-3 * np.random.default_rng(3).standard_normal(len(angle))
    assert undo_rezeroing("hip.position", "rad", time, noisy, 0.0)[1] == ()
    # A jump in the middle of a swing may be a knock.
    struck = angle + np.where(time > 1.0, 24.0 * STEP, 0.0)
    assert undo_rezeroing("hip.position", "rad", time, struck, STEP)[1] == ()


def test_stick_and_slip_is_no_change_of_zero() -> None:
    time = np.arange(0.0, 20.0, 1.0 / RATE)
    stairs = np.floor(time / 0.5) * 10.0 * STEP
    assert undo_rezeroing("hip.position", "rad", time, stairs, STEP)[1] == ()


def test_files_are_read_so(tmp_path: Path) -> None:
    time, angle = decay_and_drive()
    recorded = np.rad2deg(angle + np.where(time > 7.0, 24.0 * STEP, 0.0))
    path = tmp_path / "joined.csv"
    np.savetxt(
        path,
        np.stack([time, recorded], axis=1),
        delimiter=",",
        header="time,hip.position [deg]",
        comments="",
        fmt="%.7f",
    )
    found = read_recording(path)
    assert "rezeroed" in [n.kind for n in found.quality]
    np.testing.assert_allclose(found.channel("hip.position").values, angle, atol=1e-6)
