"""Rows of several clocks that follow one another, as messages of several topics do, brought to the rows of what is measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from harness.recording.columns import Column
from harness.recording.formats import Table
from harness.recording.recording import GIVEN, QualityNote


def one_clock(table: Table, columns: Sequence[Column]) -> tuple[Table, list[QualityNote]]:
    """The rows in which a wanted column is measured, with efforts that come at other times held until they change.

    table: ``interleaved``. columns: those wanted, time among them. An effort of its own topic is a command, which acts from its
    message to the next; before its first it is taken as none.
    """
    measured = [c.header for c in columns if c.quantity not in ("time", *GIVEN)]
    efforts = [c for c in columns if c.quantity in GIVEN]
    if not measured:
        return table, []
    keep = np.any([np.isfinite(table.columns[header]) for header in measured], axis=0)
    notes: list[QualityNote] = []
    held = {}
    for effort in efforts:
        values = table.columns[effort.header]
        if np.isfinite(values[keep]).mean() > 0.5:
            continue  # it comes with the measurements
        last = np.maximum.accumulate(np.where(np.isfinite(values), np.arange(len(values)), -1))
        held[effort.header] = np.where(last >= 0, values[np.maximum(last, 0)], 0.0)
        early = int(np.count_nonzero((last < 0) & keep))
        before = f", none before its first, for {early} samples" if early else ""
        notes.append(
            QualityNote(
                "other_clock",
                effort.name,
                f"comes {int(np.isfinite(values).sum())} times, between the samples of what is measured",
                f"held from each to the next{before}",
                early,
            )
        )
    kept = {name: held.get(name, values)[keep] for name, values in table.columns.items()}
    return replace(table, columns=kept, interleaved=False), notes
