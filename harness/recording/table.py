"""A file as named columns of numbers, whatever its format; the format is told by its first bytes."""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.system.description import Array

GZIP = b"\x1f\x8b"
PARQUET = b"PAR1"
HDF5 = b"\x89HDF\r\n\x1a\n"
MCAP = b"\x89MCAP0\r\n"
MATLAB = b"MATLAB 5.0 MAT-file"
MATLAB_73 = b"MATLAB 7.3 MAT-file"
OTHERS = {
    b"PK\x03\x04": "a zip archive or spreadsheet",
    b"\xd0\xcf\x11\xe0": "an old office document",
    b"%PDF": "a PDF",
    b"\x89PNG": "a picture",
    b"SQLite": "an SQLite database (a ROS 2 bag of the older kind)",
    b"#ROSBAG": "a ROS 1 bag",
    b"MDF ": "an MDF measurement file",
    b"\x93NUMPY": "a bare NumPy array",
    b"BZh": "a bzip2 archive",
    b"7z\xbc\xaf": "a 7-zip archive",
}
READABLE = "CSV, .csv.gz, Parquet, HDF5, MATLAB .mat or MCAP with JSON messages"


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of equal length by header, nan where a cell is empty.

    units: by header, where the format itself states them. lines: line of each row in a text file, else None.
    remarks: what reading had to do, one line each.
    """

    columns: Mapping[str, Array]
    units: Mapping[str, str] = field(default_factory=dict)
    lines: tuple[int, ...] | None = None
    remarks: tuple[str, ...] = ()

    @property
    def rows(self) -> int:
        return max((len(values) for values in self.columns.values()), default=0)


def read_table(path: Path) -> Table:
    """The columns of a recording file; its format is told by content, not by its ending.

    Raises InputError for a missing, empty or unreadable file and for a format that is not read.
    """
    if path.is_dir():
        raise InputError("is a directory", mend="name the recording file in it", source=path)
    try:
        with path.open("rb") as file:
            head = file.read(512)
    except FileNotFoundError:
        raise InputError("no such file", mend="check the path", source=path) from None
    except OSError as failure:
        raise InputError(f"cannot be read: {failure.strerror}", mend="check its rights", source=path) from None
    if not head:
        raise InputError("the file is empty", mend="record again or name another file", source=path)
    if head.startswith(GZIP):
        return _text(path, _unzip(path))
    if head.startswith(PARQUET):
        from harness.recording.read_parquet import read_parquet

        return read_parquet(path)
    if head.startswith(MCAP):
        from harness.recording.read_mcap import read_mcap

        return read_mcap(path)
    if head.startswith(MATLAB):
        from harness.recording.read_matlab import read_matlab

        return read_matlab(path)
    # MATLAB 7.3 is HDF5 behind 512 bytes of text.
    if head.startswith((HDF5, MATLAB_73)):
        from harness.recording.read_hdf5 import read_hdf5

        return read_hdf5(path)
    for magic, kind in OTHERS.items():
        if head.startswith(magic):
            raise InputError(f"is {kind}, not a recording", mend=f"export it as {READABLE}", source=path)
    return _text(path, path.read_bytes())


def _unzip(path: Path) -> bytes:
    try:
        with gzip.open(path, "rb") as file:
            return file.read()
    except (OSError, EOFError) as failure:
        raise InputError(f"damaged gzip file: {failure}", mend="copy or pack it again", source=path) from None


def _text(path: Path, content: bytes) -> Table:
    from harness.recording.read_csv import read_csv

    if not content.strip():
        raise InputError("the file is empty", mend="record again or name another file", source=path)
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        try:
            return read_csv(path, content.decode("utf-16"))
        except UnicodeDecodeError:
            pass
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Degree and micro signs of older instruments; anything that is not text shows in the control characters.
        text = content.decode("latin-1")
    sample = text[:4096]
    odd = sum(1 for letter in sample if (letter < " " and letter not in "\t\r\n") or letter == "\x7f")
    if odd > 0:
        raise InputError("is not text and no format that is known", mend=f"give {READABLE}", source=path)
    return read_csv(path, text)


def as_column(values: object) -> Array | None:
    """A vector of numbers as float64, shape (T,), or None if it is none; rows and columns of a matrix count as vectors."""
    array = np.asarray(values)
    if array.dtype.kind not in "biuf":
        return None
    if array.ndim == 2 and 1 in array.shape:
        array = array.reshape(-1)
    return array.astype(np.float64) if array.ndim == 1 else None
