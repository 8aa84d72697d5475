"""MATLAB files up to version 7; version 7.3 is HDF5."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatReadError

from harness.errors import InputError
from harness.recording.read_hdf5 import equal_lengths
from harness.recording.table import Table, as_column


def read_matlab(path: Path) -> Table:
    """Vectors of a ``.mat`` file; fields of structures are joined by dots, so ``pivot.position`` is a field of ``pivot``.

    Raises InputError for a damaged file or one without vectors.
    """
    try:
        content = loadmat(path, simplify_cells=True)
    except (MatReadError, OSError, ValueError, TypeError, NotImplementedError, EOFError) as failure:
        raise InputError(f"damaged MATLAB file: {failure}", mend="save it again", source=path) from None
    columns: dict[str, np.ndarray] = {}
    remarks: list[str] = []

    def walk(name: str, value: Any) -> None:
        if isinstance(value, dict):
            for key, inner in value.items():
                walk(f"{name}.{key}" if name else key, inner)
            return
        vector = as_column(value)
        if vector is None:
            remarks.append(f"variable {name!r} is no vector of numbers and was left out")
        else:
            columns[name] = vector

    for key, value in content.items():
        if not key.startswith("__"):
            walk(key, value)
    return equal_lengths(path, columns, {}, remarks)
