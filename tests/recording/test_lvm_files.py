"""LabVIEW measurement files, written by hand after National Instruments' specification of the format."""

import math

import numpy as np
import pytest

from harness.errors import InputError
from harness.recording import read_recording

DEGREES = [40.0 * math.cos(0.05 * k) for k in range(200)]


def lvm(rows, *, sep="\t", columns="One", more=(), names=("X_Value", "theta", "Comment"), decimal="."):
    """A file of one segment; rows: cells as text."""
    word = {"\t": "Tab", ",": "Comma"}[sep]
    head = [
        ["LabVIEW Measurement"],
        ["Writer_Version", "2"],
        ["Separator", word],
        ["Decimal_Separator", decimal],
        ["X_Columns", columns],
        ["Date", "2024/05/01"],
        ["***End_of_Header***"],
        [],
        ["Channels", "1"],
        ["Samples", str(len(rows))],
        ["Time", "12:00:00.25"],
        ["Y_Unit_Label", "Degrees"],
        ["X_Dimension", "Time"],
        *more,
        ["***End_of_Header***"],
        list(names),
        *rows,
    ]
    return "\n".join(sep.join(cells) for cells in head) + "\n"


def read(tmp_path, text):
    (tmp_path / "run.lvm").write_text(text)
    return read_recording(tmp_path / "run.lvm", mapping="theta=pivot.position")


@pytest.mark.parametrize(
    "text",
    [
        lvm([[f"{0.01 * k:.6f}", f"{x:.9f}"] for k, x in enumerate(DEGREES)]),
        lvm([[f"{0.01 * k:.6f}", f"{x:.9f}", ""] for k, x in enumerate(DEGREES)], sep=","),
        lvm(
            [[f"{0.01 * k:.6f}".replace(".", ","), f"{x:.9f}".replace(".", ",")] for k, x in enumerate(DEGREES)],
            decimal=",",
        ),
        lvm([["", f"{x:.9f}"] for x in DEGREES], columns="No", more=[["X0", "0.5"], ["Delta_X", "0.01"]]),
    ],
    ids=["tabs", "commas", "decimal commas", "no column of time"],
)
def test_samples_are_read_with_their_time_and_unit(tmp_path, text):
    recording = read(tmp_path, text)
    np.testing.assert_allclose(recording.time, 0.01 * np.arange(200), atol=1e-12)
    np.testing.assert_allclose(recording.channels[0].values, np.radians(DEGREES), atol=1e-10)


def test_the_time_goes_by_its_own_name_too(tmp_path):
    (tmp_path / "run.lvm").write_text(lvm([[f"{k}", f"{x:.9f}"] for k, x in enumerate(DEGREES)]))
    recording = read_recording(tmp_path / "run.lvm", mapping=["X_Value=time[ms]", "theta=pivot.position"])
    np.testing.assert_allclose(recording.time, 0.001 * np.arange(200), atol=1e-12)


def test_segments_follow_one_another(tmp_path):
    rows = [[f"{0.01 * k:.6f}", f"{x:.9f}"] for k, x in enumerate(DEGREES)]
    second = lvm(rows[100:]).split("***End_of_Header***\n", 1)[1]
    recording = read(tmp_path, lvm(rows[:100]) + "\n" + second)
    assert recording.samples == 200
    assert any(note.kind == "segments" for note in recording.quality)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("LabVIEW Measurement\nSeparator\tTab\n", "has no line '***End_of_Header***'"),
        (lvm([]), "has a header but no samples"),
        (
            lvm([["", "1.0"]] * 30, columns="No"),
            "run.lvm:9: damaged LabVIEW measurement file: begins a segment without X0",
        ),
        (lvm([["0", "1"], ["1"], *[["2", "3"]] * 30]), "run.lvm:17: has 1 cells where the header has 2"),
        (lvm([["0", "one"]] * 30), "run.lvm:16, column theta: 'one' is not a number"),
        (lvm([["1", "2"]] * 30).replace("X_Dimension\tTime", "X_Dimension\tFrequency"), "there is no column 'time'"),
        (
            lvm([["1", "2", "3", "4"]] * 30, columns="Multi", names=("X_Value", "theta", "X_Value", "b")),
            "every channel has a time of its own",
        ),
        (lvm([[f"{k}", f"{k % 7}"] for k in [*range(30), *range(30)]]), "run.lvm:46, column"),
    ],
)
def test_what_cannot_be_read_is_told_with_its_line(tmp_path, text, said):
    with pytest.raises(InputError) as told:
        read(tmp_path, text)
    assert said in str(told.value)
