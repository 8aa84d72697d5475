"""The table of ``docs/real_recordings.md``, written anew from ``reference/real_recordings.json``.

``python benchmarks/real_recordings_table.py [--json FILE] [--page FILE]``: replaces what stands between the page's two marks.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from harness.diagnose.answer.explain import percent
from harness.recording.units import written

from pages import errors, put  # isort: skip

HERE = Path(__file__).resolve().parents[1]
AFTERNOON = HERE / "reference" / "afternoon.json"
BEGIN, END = "<!-- table -->", "<!-- end of table -->"


def numbers(finding: dict[str, Any]) -> str:
    """A finding's parameters with their intervals."""
    parts = []
    for name, p in finding["parameters"].items():
        unit = "" if p["unit"] == "1" else f" {written(p['unit'])}"
        span = f" ({p['ci95'][0]:.3g} … {p['ci95'][1]:.3g})" if p["ci95"][0] is not None else ""
        parts.append(f"{name.replace('_', ' ')} {p['value']:.3g}{span}{unit}")
    return ", ".join(parts)


def table(rows: list[dict[str, Any]], plain: dict[str, dict[str, Any]]) -> str:
    """Errors on data held out, all rigs, as Markdown. plain: lines of ``afternoon.py`` by rig."""
    lines = [
        "| rig | unit | published | a plain fit | what is claimed | what predicts best | share explained | seconds |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for row in rows:
        published = errors(row.get("published"))
        if "authors_fit" in row:
            published += f" (fitted by its authors {errors(row.get('authors_fit'))})"
        share = percent(row["explained_share"]) if row.get("explained_share") is not None else "–"
        afternoon = errors(plain.get(row["rig"]))
        seconds = "–" if row["diagnose_s"] is None else f"{row['diagnose_s']:.0f}"
        lines.append(
            f"| {row['rig']} | {'m' if row['rig'] == 'emps' else 'rad'} | {published} | {afternoon} "
            f"| {errors(row.get('denoc'))} | {errors(row.get('predictive'))} | {share} | {seconds} |"
        )
    return "\n".join(lines)


def section(row: dict[str, Any]) -> str:
    """What is said of one rig."""
    lines = [f"### {row['rig']}", "", f"`{row['command']}`", ""]
    if "explained_share" not in row:
        return "\n".join([*lines, "Not made again with this version; the errors in the table are of an earlier one."])
    lines += [row["summary"], ""]
    if "predictive" in row:
        what = ", ".join(f"`{name}`" for name in row["predictive"]["effects"])
        lines += [f"Predicts best, by cross-validation within the training recordings: {what}.", ""]
    if row["findings"]:
        lines += ["| grade | effect | numbers (95 %) | cannot be told from |", "| -- | -- | -- | -- |"]
        for finding in row["findings"]:
            rivals = ", ".join(f"`{r}`" for r in finding["indistinguishable_from"]) or "–"
            what = f"`{finding['effect']}@{finding['site']}`"
            lines.append(f"| {finding.get('grade', '–')} | {what} | {numbers(finding)} | {rivals} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", default=str(HERE / "reference" / "real_recordings.json"))
    parser.add_argument("--page", default=str(HERE / "docs" / "real_recordings.md"))
    arguments = parser.parse_args()
    rows = json.loads(Path(arguments.json).read_text(encoding="utf-8"))["rows"]
    afternoon = json.loads(AFTERNOON.read_text(encoding="utf-8"))["rows"]
    plain = {row["rig"]: row.get("chosen_laws", row["every_law"]) for row in afternoon}
    made = "\n\n".join([table(rows, plain), *map(section, rows)])
    put(Path(arguments.page), BEGIN, END, made)


if __name__ == "__main__":
    main()
