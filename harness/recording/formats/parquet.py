"""Parquet tables."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.errors import InputError, MissingPackageError
from harness.recording.formats.table import Table, left_out, take
from harness.recording.recording import QualityNote

try:
    import pyarrow as pa
    import pyarrow.compute as pc
    import pyarrow.parquet as pq
except ModuleNotFoundError:
    raise MissingPackageError("pyarrow", "parquet", what="a Parquet file") from None


def read_parquet(path: Path, file: Path) -> Table:
    """Numeric columns of a Parquet file, nulls as nan; time stamps in seconds. Other columns are left out, with a note.

    Raises InputError for a damaged file or one without rows.
    """
    try:
        table = pq.read_table(file)
    except (pa.ArrowException, OSError) as failure:
        raise InputError(f"damaged Parquet file: {failure}", mend="write it again", source=path) from None
    if table.num_rows == 0:
        raise InputError("has columns but no samples", mend="record again or name another file", source=path)
    columns: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    notes: list[QualityNote] = []
    origins: dict[str, float] = {}
    for field_, column in zip(table.schema, table.columns, strict=True):
        name, kind = field_.name, field_.type
        if pa.types.is_timestamp(kind) or pa.types.is_duration(kind):
            scale = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[kind.unit]
            ticks = pc.cast(column, pa.int64())
            # Counted from the first stamp, as nanoseconds since 1970 do not fit a double.
            first = next((value for value in ticks.to_pylist() if value is not None), 0)
            values = np.array([np.nan if v is None else (v - first) * scale for v in ticks.to_pylist()])
            take(columns, {name: values}, notes)
            units[name] = "s"
            origins[name] = first * scale
        elif pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_decimal(kind):
            numbers = pc.cast(column, pa.float64(), safe=False)
            take(columns, {name: np.asarray(numbers.to_numpy(zero_copy_only=False), dtype=np.float64)}, notes)
        else:
            notes.append(left_out(name, f"holds {kind}, not numbers"))
            continue
        stated = (field_.metadata or {}).get(b"unit") or (field_.metadata or {}).get(b"units")
        if stated:
            units[name] = stated.decode("utf-8", "replace")
    return Table(columns, units, origins=origins, notes=tuple(notes))
