"""NumPy files: the arrays of an ``.npz``, the fields of a structured ``.npy``."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.recording.formats.table import Table, as_columns, equal_lengths, left_out, take
from harness.recording.recording import QualityNote


def read_numpy(path: Path, file: Path) -> Table:
    """Vectors by their names in the file; raises InputError for another archive, a bare array, objects and damage."""
    columns: dict[str, np.ndarray] = {}
    notes: list[QualityNote] = []
    try:
        if zipfile.is_zipfile(file):
            with zipfile.ZipFile(file) as archive:
                if not all(member.endswith(".npy") for member in archive.namelist()):
                    raise InputError(
                        "is a zip archive or spreadsheet, not a recording",
                        mend="unpack it, or save the sheet as CSV",
                        source=path,
                    )
        content = np.load(file, allow_pickle=False)
        members = {"": content} if isinstance(content, np.ndarray) else {name: content[name] for name in content.files}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as failure:
        if isinstance(failure, InputError):
            raise
        archive_or_not = "zip archive or NumPy file" if file.read_bytes()[:2] == b"PK" else "NumPy file"
        raise InputError(
            f"damaged {archive_or_not}: {failure}", mend="save it again, without objects", source=path
        ) from None
    for name, values in members.items():
        if values.dtype.names:
            for member in values.dtype.names:
                take(columns, as_columns(f"{name}.{member}" if name else member, values[member]), notes)
            continue
        found = as_columns(name, values) if name else {}
        if not found:
            notes.append(left_out(name, "is no vector of numbers" if name else "is an array without names of columns"))
        take(columns, found, notes)
    return equal_lengths(path, columns, {}, notes)
