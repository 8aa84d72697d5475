"""A run as a recording file, and as a picture."""

from __future__ import annotations

import gzip
import io
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import InputError, MissingPackageError
from harness.whole_files import staged, write_whole

Columns = Mapping[str, Any]
# Of joints that turn and of those that slide.
JOINT_UNITS = {
    "position": ("rad", "m"),
    "link_position": ("rad", "m"),
    "velocity": ("rad/s", "m/s"),
    "effort": ("N·m", "N"),
}
ENDINGS = (".csv", ".csv.gz", ".parquet")


def csv_text(columns: Columns) -> str:
    """Header and samples, every digit kept."""
    table = np.column_stack(list(columns.values()))
    # Time is a multiple of the sample spacing: its digits beyond the tenth are rounding.
    lines = [",".join([f"{row[0]:.10g}", *(repr(float(value)) for value in row[1:])]) for row in table]
    return "\n".join([",".join(columns), *lines]) + "\n"


def write_recording(columns: Columns, path: str | Path) -> Path:
    """Write a recording; the ending chooses the format. Raises InputError for an unknown ending."""
    path = Path(path)
    name = path.name.lower()
    if name.endswith(".csv"):
        return write_whole(path, csv_text(columns))
    if name.endswith(".csv.gz"):
        data = io.BytesIO()
        # No time stamp inside: equal runs make equal files.
        with gzip.GzipFile(fileobj=data, mode="wb", mtime=0) as archive:
            archive.write(csv_text(columns).encode())
        return write_whole(path, data.getvalue())
    if name.endswith(".parquet"):
        try:
            import pyarrow
            import pyarrow.parquet
        except ModuleNotFoundError:
            raise MissingPackageError("pyarrow", "parquet", what="a Parquet file", source=path) from None
        with staged(path) as temporary:
            pyarrow.parquet.write_table(pyarrow.table(dict(columns)), temporary)
        return path
    raise InputError(f"unknown ending {path.suffix!r}", source=path, mend="use " + ", ".join(ENDINGS))


def write_plot(columns: Columns, path: str | Path, title: str, *, sliding: Collection[str] = ()) -> Path:
    """A picture of every column over time, one panel a quantity; PNG, SVG or PDF by the ending.

    sliding: joints whose positions are in metres and efforts in newtons.
    """
    path = Path(path)
    if path.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise InputError(f"unknown ending {path.suffix!r}", source=path, mend="use .png, .svg or .pdf")
    from matplotlib.figure import Figure

    labels = {
        "tip_deflection": "tip deflection [m]",
        "root_strain": "root strain [1]",
        "tip_acceleration": "tip acceleration [m/s²]",
    }
    drawn = {name: _drawn(name) for name in columns if name != "time"}
    kinds = list(dict.fromkeys(kind for _, kind in drawn.values()))
    figure = Figure(figsize=(9.0, 1.2 + 2.2 * len(kinds)), layout="constrained")
    axes = figure.subplots(len(kinds), 1, sharex=True, squeeze=False)[:, 0]
    for ax, kind in zip(axes, kinds, strict=True):
        for name, (label, of) in drawn.items():
            if of == kind:
                ax.plot(columns["time"], columns[name], lw=1.2, label=label)
        joints = [label for label, of in drawn.values() if of == kind]
        ax.set_ylabel(_joint_label(kind, joints, sliding) if kind in JOINT_UNITS else labels.get(kind, kind))
        ax.grid(alpha=0.3)
        if len(columns) <= 25:
            ax.legend(fontsize=8, loc="upper right")
    axes[-1].set_xlabel("time [s]")
    figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold")
    with staged(path) as temporary:
        figure.savefig(temporary, dpi=130, format=path.suffix[1:].lower())
    return path


def _drawn(name: str) -> tuple[str, str]:
    """Label of a column and the panel it is drawn in: ``root.position.qw`` is ``root.qw`` in that of the root's position."""
    site, _, component = name.rpartition(".")
    joint, _, quantity = site.rpartition(".")
    if quantity in JOINT_UNITS and component not in JOINT_UNITS:
        return f"{joint}.{component}", f"{quantity} of {joint} [SI]"
    return site, component


def _joint_label(kind: str, joints: Sequence[str], sliding: Collection[str]) -> str:
    """``position [rad]``, or both units where joints of both kinds are drawn together."""
    kinds = sorted({joint in sliding for joint in joints})
    return f"{kind} [{' or '.join(JOINT_UNITS[kind][slides] for slides in kinds)}]"
