"""HDF5 files, among them MATLAB 7.3: vectors of one length are columns, groups are the part of a name before the dot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from harness.errors import InputError
from harness.recording.table import Table, as_column


def read_hdf5(path: Path) -> Table:
    """Numeric vectors of an HDF5 file; ``pivot/position`` is the column ``pivot.position``, attribute ``unit(s)`` its unit.

    A compound data set is a table of its own. Vectors of another length than that of ``time`` are left out, with a remark.
    Raises InputError for a damaged file or one without vectors.
    """
    columns: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    remarks: list[str] = []

    def visit(name: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset) or name.startswith("#refs#"):
            return
        label = name.replace("/", ".")
        if item.dtype.names:
            prefix = label.rsplit(".", 1)[0] + "." if "." in label else ""
            for member in item.dtype.names:
                values = as_column(item[member])
                if values is not None:
                    columns[prefix + member] = values
            return
        values = as_column(item[()]) if item.shape else None
        if values is None:
            remarks.append(f"data set {name!r} is no vector of numbers and was left out")
            return
        columns[label] = values
        for key in ("unit", "units", "Unit", "Units"):
            stated = item.attrs.get(key)
            if stated is not None:
                units[label] = stated.decode() if isinstance(stated, bytes) else str(stated)

    try:
        with h5py.File(path, "r") as file:
            file.visititems(visit)
    except (OSError, RuntimeError, ValueError) as failure:
        raise InputError(f"damaged HDF5 file: {failure}", mend="write it again", source=path) from None
    return equal_lengths(path, columns, units, remarks)


def equal_lengths(path: Path, columns: dict[str, np.ndarray], units: dict[str, str], remarks: list[str]) -> Table:
    """The columns that are as long as time; a common group above all of them is taken off the names."""
    if not columns:
        raise InputError("holds no vector of numbers", mend="store each column as one", source=path)
    columns, units = _without_common_group(columns, units)
    lengths = [len(values) for name, values in columns.items() if name == "time" or name.startswith("time ")]
    length = lengths[0] if lengths else max(set(map(len, columns.values())), key=[*map(len, columns.values())].count)
    kept = {name: values for name, values in columns.items() if len(values) == length}
    remarks += [
        f"{name!r} has {len(values)} values beside {length} samples and was left out"
        for name, values in columns.items()
        if len(values) != length
    ]
    if length == 0:
        raise InputError("has columns but no samples", mend="record again or name another file", source=path)
    return Table(kept, {name: unit for name, unit in units.items() if name in kept}, remarks=tuple(remarks))


def _without_common_group(
    columns: dict[str, np.ndarray], units: dict[str, str]
) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    if "time" in columns:
        return columns, units
    homes = [name[: -len("time")] for name in columns if name.endswith(".time")]
    if len(homes) != 1:
        return columns, units
    home = homes[0]
    inside = {name[len(home) :]: values for name, values in columns.items() if name.startswith(home)}
    return inside, {name[len(home) :]: unit for name, unit in units.items() if name.startswith(home)}
