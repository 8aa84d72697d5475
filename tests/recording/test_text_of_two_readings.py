"""Texts that can be read in two ways are refused, by the cell that shows it; what shows which way is meant is read."""

from __future__ import annotations

import gzip
import lzma

import numpy as np
import pytest

from harness.errors import InputError
from harness.recording import read_recording

TIME = np.arange(200) * 0.01
ANGLE = 2.5 * np.cos(3.0 * TIME)


def rows(*columns, mark="\t"):
    return "".join(mark.join(cells) + "\n" for cells in zip(*columns, strict=True))


def of(values, form):
    return [format(value, form) for value in values]


def comma(texts):
    return [text.replace(".", ",") for text in texts]


SECONDS, RADIANS = of(TIME, ".3f"), of(ANGLE, ".6f")
REFUSED = {
    # 2,500 and 868 of one column: 2500 mrad, and not 2.5.
    "thousands beside whole numbers": (
        "time\tpivot.position [mrad]\n" + rows(SECONDS, of(1e3 * ANGLE, ",.0f")),
        "'2,500' has a comma where others are whole numbers below a thousand",
    ),
    "thousands throughout, decimal points elsewhere": (
        "time [ms]\tpivot.position\n" + rows(of(1e3 * TIME + 2000.0, ",.0f"), RADIANS),
        "'2,000' has a comma where '2.500000' has a point",
    ),
    "thousands and decimals of one number": (
        "time [ms];pivot.position\n" + rows(of(1e3 * TIME + 2000.0, ",.1f"), RADIANS, mark=";"),
        "'2,000.0' is not a number (write numbers with a decimal point, and with no mark between thousands)",
    ),
    "points between thousands, decimal commas elsewhere": (
        "time [ms];pivot.position\n"
        + rows([t.replace(",", ".") for t in of(1e3 * TIME + 2000.0, ",.0f")], comma(RADIANS), mark=";"),
        "'2,500000' has a comma where '2.000' has a point",
    ),
    "quoted thousands": (
        "time,pivot.position [mrad]\n" + rows(SECONDS, [f'"{x}"' for x in of(1e3 * ANGLE, ",.0f")], mark=","),
        "'2,500' is not a number (write numbers with a decimal point",
    ),
    # The second and third column would be time and position if the first were names of rows.
    "a column without a name at the end": (
        "pivot.position,time\n" + rows(RADIANS, SECONDS, of(2.0 * TIME, ".3f"), mark=","),
        "has 3 cells where the header has 2",
    ),
    "minutes or hours": (
        "time,pivot.position\n" + rows([f"{k // 60:02d}:{k % 60:02d}" for k in range(200)], RADIANS, mark=","),
        "'00:00' may be hours and minutes, or minutes and seconds (write hh:mm:ss, or seconds)",
    ),
}  # fmt: skip
READ = {
    "decimal commas": "time;pivot.position\n" + rows(comma(SECONDS), comma(RADIANS), mark=";"),
    "decimal commas of three digits": "time;pivot.position\n" + rows(comma(SECONDS), comma(of(ANGLE, ".3f")), mark=";"),
    "decimal commas without zeros at the end": "time;pivot.position\n"
    + rows(comma(of(TIME, "g")), comma(of(ANGLE, "g")), mark=";"),
    "points in a column of text": "time;pivot.position;version\n" + rows(comma(SECONDS), comma(RADIANS), ["1.2.3"] * 200, mark=";"),
    "points in stamps": "stamp;time;pivot.position\n"
    + rows([f"12:00:{t:06.3f}" for t in TIME], comma(SECONDS), comma(RADIANS), mark=";"),
    "names of rows": '"time" "pivot.position"\n' + rows([f'"{3 * k + 1}"' for k in range(200)], SECONDS, RADIANS, mark=" "),
    "words as names of rows": '"time" "pivot.position"\n' + rows([f'"r{k}"' for k in range(200)], SECONDS, RADIANS, mark=" "),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_two_readings_are_refused_in_a_line(tmp_path, name):
    text, words = REFUSED[name]
    file = tmp_path / "run.csv"
    file.write_text(text)
    with pytest.raises(InputError) as refusal:
        read_recording(file)
    assert words in str(refusal.value)
    assert refusal.value.line == 2


@pytest.mark.parametrize("name", READ)
def test_one_reading_is_read(tmp_path, name):
    file = tmp_path / "run.csv"
    file.write_text(READ[name])
    recording = read_recording(file)
    assert np.allclose(recording.time, TIME, atol=1e-9)
    assert np.allclose(recording.channels[0].values, ANGLE, rtol=1e-4, atol=6e-4)


@pytest.mark.parametrize(("ending", "pack"), [("", bytes), (".gz", gzip.compress), (".xz", lzma.compress)])
@pytest.mark.parametrize("beside", ["run.csv.toml", "run.toml", "columns.toml"])
def test_a_packed_file_has_the_columns_of_the_file_beside_it_too(tmp_path, ending, pack, beside):
    text = "time,pivot.position\n" + rows(SECONDS, of(np.degrees(ANGLE), ".8f"), mark=",")
    (tmp_path / f"run.csv{ending}").write_bytes(pack(text.encode()))
    (tmp_path / beside).write_text('[columns]\n"pivot.position" = "pivot.position [deg]"\n')
    recording = read_recording(tmp_path / f"run.csv{ending}")
    assert np.allclose(recording.channels[0].values, ANGLE, atol=1e-8)
    assert recording.name == "run"
