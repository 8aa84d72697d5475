"""HDF5 files, among them MATLAB 7.3 and netCDF 4: vectors of one length are columns, groups stand before the dot of a name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from harness.errors import InputError
from harness.recording.formats.packing import unit_of, unpacked
from harness.recording.formats.table import Table, as_columns, equal_lengths, left_out, take
from harness.recording.recording import QualityNote


def read_hdf5(path: Path, file: Path) -> Table:
    """Numeric vectors of an HDF5 file; ``pivot/position`` is the column ``pivot.position``, attribute ``unit(s)`` its unit.

    A compound data set is a table of its own, a matrix one column for each of its shorter side. Attributes ``scale_factor``,
    ``add_offset``, ``_FillValue`` and ``missing_value`` mean what they mean in netCDF. Vectors of another length than that of
    ``time`` are left out, with a note. Raises InputError for a damaged file or one without vectors.
    """
    columns: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    notes: list[QualityNote] = []

    def visit(name: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset) or name.startswith("#refs#"):
            return
        label = name.replace("/", ".")
        if item.dtype.names:
            prefix = label.rsplit(".", 1)[0] + "." if "." in label else ""
            for member in item.dtype.names:
                take(columns, as_columns(prefix + member, item[member]), notes)
            return
        attribute: Callable[[str], Any] = item.attrs.get
        values, told = unpacked(label, item[()], attribute) if item.shape else (None, ())
        found = as_columns(label, values) if item.shape else {}
        if not found:
            notes.append(left_out(label, "is no vector of numbers"))
            return
        take(columns, found, notes)
        notes.extend(told)
        unit = unit_of(attribute)
        if unit:
            units.update(dict.fromkeys(found, unit))

    try:
        with h5py.File(file, "r") as content:
            content.visititems(visit)
    except (OSError, RuntimeError, ValueError) as failure:
        raise InputError(f"damaged HDF5 file: {failure}", mend="write it again", source=path) from None
    return equal_lengths(path, columns, units, notes)
