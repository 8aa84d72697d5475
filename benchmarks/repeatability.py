"""Error bars that repeat: what one half of a rig's recordings says of every number that is found, against the other half.

``python benchmarks/repeatability.py [RIG …] [--recordings DIR] [--json FILE]``
``python benchmarks/repeatability.py --page FILE --json FILE`` writes the table of the docs from what is kept.

Every rig with two recordings or more is diagnosed whole. What is claimed there is then asked of each half alone (every second
recording), with nothing in the catalogue but what was found, possible effects among it. Two estimates repeat if they differ by
no more than 1.96 of their joint standard deviation, as 95 % of right ones do. Recordings are found as by ``real_recordings.py``.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import harness
from harness.proof.score import Share
from harness.recording.units import written

from pages import put  # isort: skip
from real_recordings import SPLITS, folder_of_recordings  # isort: skip

JOINT = 1.96
LEAST = 2  # recordings
BEGIN, END = "<!-- repeatability -->", "<!-- end of repeatability -->"


def claimed(found: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """The findings of a document that are told in its summary."""
    return [f for f in found["findings"] if f.get("grade") != "possible"]


def of_half(
    files: Sequence[Path], model: Path, effects: Sequence[str], fit_effort: bool
) -> dict[str, Mapping[str, Any]]:
    """Parameters that a half gives, by ``effect@site.parameter``."""
    document = harness.diagnose(
        [str(f) for f in files], model=str(model), only=list(effects), fit_effort=fit_effort
    ).to_json()
    return {
        f"{f['effect']}@{f['site']}.{name}": value
        for f in document["findings"]
        for name, value in f["parameters"].items()
    }


def apart(one: Mapping[str, Any], other: Mapping[str, Any]) -> float | None:
    """How many joint standard deviations two estimates differ by; None where one has none."""
    if not one["std"] or not other["std"]:
        return None
    return float(abs(one["value"] - other["value"]) / np.hypot(one["std"], other["std"]))


def examine(folder: Path) -> list[dict[str, Any]]:
    """Rows of one rig, one a number."""
    files, model = sorted(folder.glob("*.csv*")), folder / "model.urdf"
    fit_effort = folder.name in SPLITS and SPLITS[folder.name].fit_effort
    started = time.perf_counter()
    whole = harness.diagnose([str(f) for f in files], model=str(model), fit_effort=fit_effort).to_json()
    if not claimed(whole):
        return []
    effects = list(dict.fromkeys(f["effect"] for f in whole["findings"]))
    halves = [of_half(files[k::2], model, effects, fit_effort) for k in range(2)]
    rows = []
    for finding in claimed(whole):
        for name, value in finding["parameters"].items():
            key = f"{finding['effect']}@{finding['site']}.{name}"
            one, other = both = [half.get(key) for half in halves]
            distance = apart(one, other) if one is not None and other is not None else None
            rows.append({
                "rig": folder.name, "number": key, "unit": value["unit"], "whole": value["value"], "ci95": value["ci95"],
                "halves": [None if b is None else {"value": b["value"], "std": b["std"]} for b in both],
                "apart": distance, "repeats": None if distance is None else distance <= JOINT,
                "seconds": time.perf_counter() - started,
            })  # fmt: skip
    return rows


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Counts and all numbers, as Markdown."""
    told = [row["repeats"] for row in rows if row["repeats"] is not None]
    low, high = (100.0 * x for x in Share(sum(told), len(told)).interval)
    lines = [
        f"**{sum(told)} of {len(told)} numbers do** ({low:.0f} to {high:.0f} % by Wilson's interval), where 19 of 20 should.",
        "",
        "| rig | number | whole | halves | joint deviations apart |",
        "| -- | -- | -- | -- | -- |",
    ]
    for row in rows:
        halves = ", ".join("not found" if h is None else _estimate(h) for h in row["halves"])
        low, high = row["ci95"]
        unit = written(row["unit"])
        apart = "–" if row["apart"] is None else f"{row['apart']:.2f}"
        lines.append(
            f"| {row['rig']} | `{row['number']}` [{unit}] | {row['whole']:.3g} ({low:.3g} … {high:.3g}) | {halves} | {apart} |"
        )
    return "\n".join(lines)


def _estimate(half: Mapping[str, Any]) -> str:
    return f"{half['value']:.3g}" + ("" if half["std"] is None else f" ± {half['std']:.2g}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rigs", nargs="*")
    parser.add_argument("--recordings")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    if given.page is not None:
        put(given.page, BEGIN, END, table(json.loads(given.json.read_text(encoding="utf-8"))["rows"]))
        return
    folder = folder_of_recordings(given.recordings)
    if folder is None:
        parser.error("no folder of recordings: give --recordings DIR")
    names = given.rigs or sorted(p.name for p in folder.iterdir() if (p / "model.urdf").is_file())
    rows: list[dict[str, Any]] = []
    for name in names:
        if len(list((folder / name).glob("*.csv*"))) < LEAST:
            continue
        for row in examine(folder / name):
            rows.append(row)
            text = "no two estimates" if row["apart"] is None else f"{row['apart']:.2f} joint deviations apart"
            print(f"{row['rig']:24} {row['number']:48} {row['whole']:.4g} {row['unit']:16} {text}", flush=True)
    told = [row["repeats"] for row in rows if row["repeats"] is not None]
    print(f"{sum(told)} of {len(told)} numbers repeat from half to half")
    if given.json is not None:
        document = {"schema": "denoc.repeatability/1", "version": harness.__version__, "rows": rows}
        given.json.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
