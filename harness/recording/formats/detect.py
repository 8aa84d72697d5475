"""Which reader a file is for: told by its first bytes, not by its ending."""

from __future__ import annotations

import bz2
import errno
import gzip
import lzma
import re
import struct
import tempfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from harness.errors import InputError
from harness.recording.formats.apart import most_memory, read_apart
from harness.recording.formats.csv import read_text
from harness.recording.formats.table import Table

PACKED: dict[bytes, tuple[str, Callable[..., Any]]] = {
    b"\x1f\x8b": ("gzip file", gzip.open),
    b"BZh": ("archive", bz2.open),
    b"\xfd7zXZ\x00": ("archive", lzma.open),
}
MOST_LAYERS = 4  # an archive can be made that holds itself
# Readers bring heavy packages along, so each is loaded when a file asks for it. MATLAB 7.3 is HDF5 behind 512 bytes of text.
READERS = (
    (b"PAR1", "parquet", "read_parquet"),
    (b"\x89HDF\r\n\x1a\n", "hdf5", "read_hdf5"),
    (b"MATLAB 7.3 MAT-file", "hdf5", "read_hdf5"),
    (b"MATLAB 5.0 MAT-file", "matlab", "read_matlab"),
    (b"CDF\x01", "netcdf", "read_netcdf"),
    (b"CDF\x02", "netcdf", "read_netcdf"),
    (b"\x93NUMPY", "numpy_arrays", "read_numpy"),
    (b"PK\x03\x04", "numpy_arrays", "read_numpy"),
    (b"\x89MCAP0\r\n", "mcap", "read_mcap"),
    (b"SQLite format 3", "rosbag", "read_ros2_bag"),
    (b"#ROSBAG", "rosbag", "read_ros1_bag"),
)
OTHERS = {
    b"\xd0\xcf\x11\xe0": "an old office document",
    b"%PDF": "a PDF",
    b"\x89PNG": "a picture",
    b"MDF ": "an MDF measurement file",
    b"\x28\xb5\x2f\xfd": "packed by zstd",
    b"7z\xbc\xaf": "a 7-zip archive",
    b"TDSm": "a LabVIEW TDMS file",
}
HEAD_4 = 20  # bytes
READABLE = "CSV, Parquet, HDF5, netCDF, MATLAB .mat, NumPy .npz, MCAP or a ROS bag"


# Of JSON an object, or an array of something; a header may begin with a bracket as well.
MARKED_UP = {re.compile(rb"^\s*(\{|\[\s*[\[{\d\-\"])"): "JSON", re.compile(rb"^\s*<[?!a-zA-Z]"): "XML or a web page"}


def is_matlab_4(head: bytes) -> bool:
    """Whether a file begins as MATLAB's did up to version 4: five whole numbers, and the name of the first matrix.

    Source: MAT-File Format (The MathWorks), Level 4: type MOPT (machine, 0, precision, kind), rows, columns, whether it is complex,
    and the length of the name with its zero at the end.
    """
    if len(head) < HEAD_4:
        return False
    for order, machine in (("<", 0), (">", 1)):
        kind, rows, columns, complex_, length = struct.unpack(f"{order}5i", head[:HEAD_4])
        digits = [kind // 1000, kind // 100 % 10, kind // 10 % 10, kind % 10]
        fits = digits[:2] == [machine, 0] and digits[2] <= 5 and digits[3] <= 2 and complex_ in (0, 1)
        name = head[HEAD_4 : HEAD_4 + length]
        if (
            fits
            and rows >= 0
            and columns >= 0
            and 1 < length <= 64
            and name.rstrip(b"\0").decode("latin-1").isidentifier()
        ):
            return True
    return False


def read_table(path: Path) -> Table:
    """The columns of a recording file; its format is told by content, not by its ending. A ROS 2 bag may be its folder.

    Raises InputError for a missing, empty or unreadable file and for a format that is not read.
    """
    if path.is_dir():
        if (path / "metadata.yaml").is_file():
            return read_apart("rosbag", "read_ros2_folder", path, path)
        raise InputError("is a directory", mend="name the recording file in it", source=path)
    return _read_file(path, path)


def _read_file(path: Path, file: Path, layers: int = 0) -> Table:
    """path: as the user knows it. file: where its bytes are, unpacked. layers: how often it was unpacked."""
    try:
        with file.open("rb") as stream:
            head = stream.read(512)
    except FileNotFoundError:
        raise InputError("no such file", mend="check the path", source=path) from None
    except OSError as failure:
        raise InputError(f"cannot be read: {failure.strerror}", mend="check its rights", source=path) from None
    if not head:
        raise InputError("the file is empty", mend="record again or name another file", source=path)
    for magic, (kind, opened) in PACKED.items():
        if head.startswith(magic):
            return _unpacked(path, file, kind, opened, layers + 1)
    for magic, module, reader in READERS:
        if head.startswith(magic):
            return read_apart(module, reader, path, file)
    if is_matlab_4(head):
        return read_apart("matlab", "read_matlab", path, file)
    for pattern, kind in MARKED_UP.items():
        if pattern.match(head):
            raise InputError(f"is {kind}, not a recording", mend=f"export it as {READABLE}", source=path)
    for magic, kind in OTHERS.items():
        if head.startswith(magic):
            raise InputError(f"is {kind}, not a recording", mend=f"export it as {READABLE}", source=path)
    return read_text(path, file.read_bytes(), READABLE)


def _unpacked(path: Path, file: Path, kind: str, opened: Callable[..., Any], layers: int) -> Table:
    if layers > MOST_LAYERS:
        raise InputError(f"is packed more than {MOST_LAYERS} times over", mend="unpack it yourself", source=path)
    most = most_memory(file.stat().st_size)
    with tempfile.TemporaryDirectory() as folder:
        inner = Path(folder) / "unpacked"
        try:
            with opened(file) as packed, inner.open("wb") as plain:
                size = 0
                while part := packed.read(1 << 20):
                    size += len(part)
                    if size > most:
                        raise InputError(
                            f"unpacks to more than {most / 2**30:.3g} GiB",
                            mend="unpack it yourself if that is what it holds",
                            source=path,
                        )
                    plain.write(part)
        except OSError as failure:
            if failure.errno == errno.ENOSPC:
                raise InputError(
                    f"there is no room to unpack it in {folder}", mend="point TMPDIR to a larger disk", source=path
                ) from None
            raise _damaged(path, kind, failure) from None
        except (EOFError, ValueError, lzma.LZMAError, zlib.error) as failure:
            if isinstance(failure, InputError):
                raise
            raise _damaged(path, kind, failure) from None
        return _read_file(path, inner, layers)


def _damaged(path: Path, kind: str, failure: Exception) -> InputError:
    return InputError(f"damaged {kind}: {failure}", mend="copy or pack it again", source=path)
