"""netCDF classic files (version 3); version 4 is HDF5."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.io import netcdf_file

from harness.errors import InputError
from harness.recording.formats.packing import unit_of, unpacked
from harness.recording.formats.table import Table, as_columns, equal_lengths, left_out, take
from harness.recording.recording import QualityNote


def read_netcdf(path: Path, file: Path) -> Table:
    """Numeric vectors of a netCDF file, unpacked, with their units; raises InputError for a damaged file."""
    columns: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    notes: list[QualityNote] = []
    try:
        with netcdf_file(file, "r", mmap=False) as content:
            for name, variable in content.variables.items():
                stated = dict(variable._attributes)
                values, told = unpacked(name, np.array(variable.data), stated.get)
                found = as_columns(name, values) if variable.shape else {}
                if not found:
                    notes.append(left_out(name, "is no vector of numbers"))
                    continue
                take(columns, {key: value.astype(np.float64) for key, value in found.items()}, notes)
                notes.extend(told)
                unit = unit_of(stated.get)
                if unit:
                    units.update(dict.fromkeys(found, unit))
    except (OSError, ValueError, TypeError, IndexError, EOFError) as failure:
        raise InputError(f"damaged netCDF file: {failure}", mend="write it again", source=path) from None
    return equal_lengths(path, columns, units, notes)
