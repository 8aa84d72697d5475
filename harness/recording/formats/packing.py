"""How netCDF and HDF5 files store numbers in few bits: a scale, an offset, and a value that stands for none.

NetCDF Climate and Forecast conventions 1.11, sections 2.5.1 (missing data) and 8.1 (packed data). NetCDF User's Guide, attribute
conventions: ``_Unsigned``, for the classic format, which has signed integers alone.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from harness.recording.recording import QualityNote

ABSENT = ("_FillValue", "missing_value")
SINCE = re.compile(r"^(?P<unit>\w+)\s+since\s+.*$", re.IGNORECASE)


def unpacked(
    name: str, values: Any, attribute: Callable[[str], Any]
) -> tuple[np.ndarray | None, tuple[QualityNote, ...]]:
    """Values as they are meant, nan where there is none, and a note of what was done; None if they are no numbers."""
    stored = np.asarray(values)
    if stored.dtype.kind not in "biuf":
        return None, ()
    unsigned = stored.dtype.kind == "i" and _text(attribute("_Unsigned")).lower() == "true"
    if unsigned:
        stored = stored.view(stored.dtype.str.replace("i", "u"))
    marks = [_scalars(attribute(key)) for key in ABSENT]
    scale, offset = _scalars(attribute("scale_factor")), _scalars(attribute("add_offset"))
    missing = np.zeros(stored.shape, dtype=bool)
    for mark in marks:
        for value in mark:
            # Absent values are told in what is stored, before it is unpacked.
            missing |= stored == np.asarray(value).astype(stored.dtype)
    if not len(scale) and not len(offset) and not missing.any() and not unsigned:
        return stored, ()
    factor = float(scale[0]) if len(scale) else 1.0
    shift = float(offset[0]) if len(offset) else 0.0
    meant = np.where(missing, np.nan, stored.astype(np.float64) * factor + shift)
    notes = []
    if unsigned:
        notes.append(QualityNote("packed", name, "is stored unsigned", "read as such", int(stored.size)))
    if len(scale) or len(offset):
        notes.append(
            QualityNote("packed", name, f"is stored as (value − {shift:g}) / {factor:g}", "unpacked", int(stored.size))
        )
    if missing.any():
        notes.append(
            QualityNote(
                "fill_value", name, f"{int(missing.sum())} values stand for none", "left open", int(missing.sum())
            )
        )
    return meant, tuple(notes)


def unit_of(attribute: Callable[[str], Any]) -> str:
    """The unit that attributes tell, "" if none; of a time ``seconds since 1970-01-01`` the first word."""
    for key in ("unit", "units", "Unit", "Units"):
        stated = attribute(key)
        if stated is None:
            continue
        text = _text(stated)
        match = SINCE.match(text)
        return match["unit"] if match else text
    return ""


def _text(value: Any) -> str:
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.reshape(-1)[0]
    text = value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
    return text.strip()


def _scalars(value: Any) -> np.ndarray:
    if value is None:
        return np.empty(0)
    array = np.asarray(value).reshape(-1)
    return array if array.dtype.kind in "biuf" else np.empty(0)
