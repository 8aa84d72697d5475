"""MATLAB files up to version 7; version 7.3 is HDF5."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatlabOpaque, MatReadError

from harness.errors import InputError
from harness.recording.formats.table import Table, as_columns, equal_lengths, left_out, take
from harness.recording.recording import QualityNote

OBJECTS = "is an object (timeseries, table, Dataset), which only MATLAB reads: save x.Time and x.Data as vectors"


def read_matlab(path: Path, file: Path) -> Table:
    """Vectors of a ``.mat`` file; fields of structures are joined by dots, so ``pivot.position`` is a field of ``pivot``.

    Matrices give one column for each of their shorter side, so do Simulink's structures with time, whose signals are named by
    their labels. Raises InputError for a damaged file or one without vectors.
    """
    try:
        content = loadmat(file, simplify_cells=True)
    except (MatReadError, OSError, ValueError, TypeError, NotImplementedError, EOFError) as failure:
        raise InputError(f"damaged MATLAB file: {failure}", mend="save it again", source=path) from None
    columns: dict[str, np.ndarray] = {}
    notes: list[QualityNote] = []

    def walk(name: str, value: Any) -> None:
        if isinstance(value, dict):
            if "values" in value and isinstance(value.get("label"), str) and value["label"].strip():
                # A signal of Simulink's structure with time.
                label = f"{name.rpartition('.')[0]}.{value['label'].strip()}".lstrip(".")
                take(columns, as_columns(label, value["values"]), notes)
                return
            for key, inner in value.items():
                walk(f"{name}.{key}" if name else key, inner)
            return
        if isinstance(value, list | np.ndarray) and any(isinstance(item, dict) for item in value):
            for k, item in enumerate(value):
                walk(f"{name}[{k}]", item)
            return
        found = as_columns(name, value)
        if not found:
            opaque = isinstance(value, MatlabOpaque) or getattr(value, "dtype", np.dtype(float)).names is not None
            notes.append(left_out(name, OBJECTS if opaque else "is no vector of numbers"))
        take(columns, found, notes)

    for key, value in content.items():
        if not key.startswith("__"):
            walk(key, value)
        elif key.startswith("__function"):
            notes.append(left_out("", OBJECTS))
    return equal_lengths(path, columns, {}, notes)
