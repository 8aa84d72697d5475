"""Two columns of one name, columns that are no numbers, and files that are no tables: told by name and in a line."""

from __future__ import annotations

import json

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import scipy.io

from harness.errors import InputError
from harness.recording import read_recording

TIME = np.arange(200) * 0.01
ANGLE = np.cos(3.0 * TIME)


def refusal(file, **options) -> str:
    with pytest.raises(InputError) as refused:
        read_recording(file, **options)
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_two_tables_of_an_hdf5_file_do_not_hide_one_another(tmp_path):
    with h5py.File(tmp_path / "runs.h5", "w") as file:
        for k in (1, 2):
            file[f"run{k}"] = np.rec.fromarrays([TIME, k * ANGLE], names=["time", "pivot.position"])
    assert "'time' is the name of two columns" in refusal(tmp_path / "runs.h5")


def test_of_two_columns_of_one_name_neither_is_taken(tmp_path):
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file["time"], file["pivot.position"], file["pivot/position"] = TIME, ANGLE, 2.0 * ANGLE
    assert "'pivot.position' is the name of two columns" in refusal(tmp_path / "run.h5")
    with h5py.File(tmp_path / "run.h5", "a") as file:
        file["pivot/velocity"] = ANGLE
    recording = read_recording(tmp_path / "run.h5")
    assert recording.channel_names == ("pivot.velocity",)
    assert any("two columns" in note.what and note.channel == "pivot.position" for note in recording.quality)


def test_two_signals_of_one_label_of_simulink(tmp_path):
    signals = [{"values": k * ANGLE, "label": "pivot.position", "dimensions": 1} for k in (1, 2)]
    signals.append({"values": ANGLE, "label": "pivot.velocity", "dimensions": 1})
    scipy.io.savemat(tmp_path / "run.mat", {"out": {"time": TIME, "signals": signals}})
    assert read_recording(tmp_path / "run.mat").channel_names == ("pivot.velocity",)


@pytest.mark.parametrize("order", ["<", ">"])
def test_matlab_before_version_5(tmp_path, order):
    """Written by hand after the description of the format: matrices of doubles in columns, of either order of bytes."""
    with (tmp_path / "run.mat").open("wb") as file:
        for name, values in (("time", TIME), ("theta", ANGLE)):
            kind = 1000 * (order == ">")
            file.write(np.array([kind, len(values), 1, 0, len(name) + 1], f"{order}i4").tobytes())
            file.write(name.encode() + b"\0" + values.astype(f"{order}f8").tobytes())
    recording = read_recording(tmp_path / "run.mat", mapping=["theta=pivot.position"])
    np.testing.assert_array_equal(recording.channels[0].values, ANGLE)


def test_a_column_that_is_no_number_is_named(tmp_path):
    texts = pa.array([f"{value:.6f}" for value in ANGLE])
    pq.write_table(pa.table({"time": TIME, "pivot.position": texts}), tmp_path / "run.parquet")
    assert "column 'pivot.position' holds string, not numbers" in refusal(tmp_path / "run.parquet")
    scipy.io.savemat(tmp_path / "run.mat", {"time": TIME, "theta": ANGLE + 1j})
    assert "column 'theta' is no vector" in refusal(tmp_path / "run.mat", mapping=["theta=pivot.position"])
    np.savez(tmp_path / "run.npz", **{"time": (TIME * 1e9).astype("datetime64[ns]"), "pivot.position": ANGLE})
    assert "column 'time' is no vector" in refusal(tmp_path / "run.npz")


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        (json.dumps({"time": [0.0, 0.1]}), "JSON"),
        (json.dumps([[0.0, 0.1]]), "JSON"),
        ('\n{"time": 0.0}\n{"time": 0.1}\n', "JSON"),
        ('<?xml version="1.0"?><robot/>', "XML or a web page"),
        ("<!DOCTYPE html><html></html>", "a web page"),
    ],
)
def test_what_is_no_table_is_called_by_its_name(tmp_path, text, kind):
    (tmp_path / "run.csv").write_text(text)
    assert f"{kind}, not a recording" in refusal(tmp_path / "run.csv")


def test_a_header_in_brackets_is_a_header(tmp_path):
    rows = "".join(f"{t},{a}\n" for t, a in zip(TIME, ANGLE, strict=True))
    (tmp_path / "run.csv").write_text("[clock],pivot.position\n" + rows)
    assert "there is no column 'time'" in refusal(tmp_path / "run.csv")
