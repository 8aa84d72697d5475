"""Degrees for radians, milliseconds for seconds, angles counted from upright: told or taken off, and never fitted to."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulated_recordings import Rig, double_pendulum, nominal, recording, swing

from harness import diagnose
from harness.diagnose.conditioning.conventions import conventional
from harness.errors import InputError
from harness.recording import Recording

RIG = Rig(viscous=0.004, dry=0.01)


def swings(rig: Rig = RIG, noise: float = 1e-3, *, rate: float = 100.0) -> list[Recording]:
    rng = np.random.default_rng(5)
    time = np.arange(0.0, 8.0, 1.0 / rate)
    return [
        recording(f"run{k}", time, {"pivot.position": swing(rig, a, time) + noise * rng.standard_normal(len(time))})
        for k, a in enumerate((1.3, -0.7))
    ]


def shifted(run: Recording, joint: str, by: float) -> Recording:
    channels = (replace(c, values=c.values + by) if c.site == joint else c for c in run.channels)
    return replace(run, channels=tuple(channels))


@pytest.mark.parametrize("rig", [RIG, Rig(viscous=0.05), Rig(drag=0.02), Rig(mass=0.4, inertia=0.02)])
def test_recordings_as_they_should_be_are_left_alone(rig: Rig) -> None:
    for noise in (1e-4, 2e-2):
        runs = swings(rig, noise)
        assert conventional(nominal(), runs) == runs
    # An offset that is no convention is a question for the fit.
    off = [shifted(run, "pivot", 0.3) for run in swings(rig)]
    assert conventional(nominal(), off) == off


@pytest.mark.parametrize(
    ("turns", "words"), [(0.25, "a quarter turn"), (0.5, "half a turn"), (-0.25, "quarter turn back")]
)
def test_another_zero_is_taken_off_and_a_note_tells(turns: float, words: str) -> None:
    zero = 2.0 * np.pi * turns
    counted = conventional(nominal(), [shifted(run, "pivot", zero) for run in swings()])
    for run, before in zip(counted, swings(), strict=True):
        assert run.channels[0].values == pytest.approx(before.channels[0].values, abs=1e-12)
        note = run.quality[-1]
        assert note.kind == "other_zero" and words in note.what
        assert note.size == pytest.approx(zero)


def test_the_joint_that_is_counted_otherwise_is_named() -> None:
    system, runs = double_pendulum(0.004, 1e-3, 3)
    counted = conventional(system, [shifted(run, "elbow", np.pi) for run in runs])
    assert [note.channel for note in counted[0].quality] == ["elbow.position"]


def test_an_angle_from_upright_is_diagnosed_as_if_it_hung() -> None:
    found = diagnose([shifted(run, "pivot", np.pi) for run in swings()], model=nominal())
    assert found.verdict == "explained"
    assert {f["effect"] for f in found.findings} == {"viscous_damping", "coulomb_friction"}


@pytest.mark.parametrize(
    ("rate", "angle", "time", "column", "unit"),
    [
        (400.0, 180.0 / np.pi, 1.0, "pivot.position", "[deg]"),
        (
            100.0,
            180.0 / np.pi,
            1.0,
            "pivot.position",
            "[deg]",
        ),  # the reader itself stumbles over jumps of more than half a turn
        (100.0, 1.0, 1e3, "time", "[ms]"),
        (400.0, 180.0 / np.pi, 1e3, "time", "[ms]"),
        (100.0, 1.0, 1e9, "time", "[ns]"),
    ],
)
def test_units_that_the_header_does_not_say_are_refused(
    tmp_path: Path, rate: float, angle: float, time: float, column: str, unit: str
) -> None:
    for run in swings(rate=rate):
        table = np.column_stack([time * run.time, angle * run.channels[0].values])
        np.savetxt(tmp_path / f"{run.name}.csv", table, delimiter=",", header="time,pivot.position", comments="")
    with pytest.raises(InputError) as refusal:
        diagnose([tmp_path / "run0.csv", tmp_path / "run1.csv"], model=nominal())
    assert refusal.value.column == column
    assert unit in refusal.value.mend
    assert str(refusal.value.source).endswith("run0.csv")
