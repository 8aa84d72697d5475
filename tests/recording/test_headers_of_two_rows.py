"""Headers of two rows, marks that differ between header and samples, and clocks rounded to a second: read right, or told."""

import math

import numpy as np
import pytest

from harness.errors import InputError
from harness.recording import read_recording

ANGLE = [0.8 * math.cos(0.05 * k) for k in range(400)]  # rad, at 100 Hz


def read(tmp_path, head, row):
    (tmp_path / "run.csv").write_text(
        head + "\n" + "\n".join(row(0.01 * k, x) for k, x in enumerate(ANGLE)) + "\n", encoding="utf-8"
    )
    return read_recording(tmp_path / "run.csv")


@pytest.mark.parametrize(
    "head",
    [
        "time,pivot,pivot\n,position,velocity",
        "time,pivot,\n,position,velocity",
        "time,pivot,pivot\n,position,velocity\ns,rad,rad/s",
        "time [s],pivot,pivot\n,position [rad],velocity [rad/s]",
        "Run 5,,\ntime,pivot,\n,position,velocity",
    ],
)
def test_joints_may_stand_over_what_is_measured_of_them(tmp_path, head):
    recording = read(tmp_path, head, lambda t, x: f"{t:.2f},{x!r},{2.0 * x!r}")
    assert [channel.name for channel in recording.channels] == ["pivot.position", "pivot.velocity"]
    np.testing.assert_array_equal(recording.channels[0].values, ANGLE)
    np.testing.assert_allclose(recording.time, 0.01 * np.arange(400), atol=1e-12)


def test_an_index_without_a_name_below_a_title_is_none(tmp_path):
    recording = read(tmp_path, "Run 5,,\n,time,pivot.position", lambda t, x: f"{round(100 * t)},{t:.2f},{x!r}")
    assert [channel.name for channel in recording.channels] == ["pivot.position"]


def test_a_minus_of_typesetters_is_one(tmp_path):
    recording = read(tmp_path, "time,pivot.position", lambda t, x: f"{t:.2f},{x!r}".replace("-", "\N{MINUS SIGN}"))
    np.testing.assert_array_equal(recording.channels[0].values, ANGLE)


@pytest.mark.parametrize(
    ("head", "row", "said"),
    [
        (
            "time\tpivot.position",
            lambda t, x: f"{t:.2f},{x:.6f}",
            "has 2 cells, parted by commas, where the header has 1",
        ),
        (
            "time,pivot.position",
            lambda t, x: f"{t:.2f} s,{x:.6f} rad",
            "has 3 cells, parted by blanks, where the header has 1",
        ),
        (
            "time,pivot.position",
            lambda t, x: f"{t:.2f},{x:.6f}".replace(".", ","),
            "(commas part cells, and decimals too: write decimal points, or part cells by semicolons)",
        ),
    ],
)
def test_marks_of_header_and_samples_that_differ_are_told(tmp_path, head, row, said):
    with pytest.raises(InputError) as told:
        read(tmp_path, head, row)
    assert "run.csv:2: " in str(told.value) and said in str(told.value)


@pytest.mark.parametrize("begun", [0.0, 0.37, 0.93])
def test_a_clock_of_whole_seconds_gives_the_rate_wherever_it_was_begun(tmp_path, begun):
    # Four seconds at 100 Hz: a line through all stamps, its ends cut off within a second, would be up to 7 % off.
    recording = read(tmp_path, "time,pivot.position", lambda t, x: f"{math.floor(t + begun + 1e-9)},{x!r}")
    np.testing.assert_allclose(recording.time, 0.01 * np.arange(400), rtol=1e-9, atol=1e-9)


def test_a_clock_that_hardly_goes_on_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"column time: time goes on 2 times only, by 2 s, in 400 samples"):
        read(tmp_path, "time,pivot.position", lambda t, x: f"{2 * math.floor(t / 2 + 0.3)},{x!r}")
