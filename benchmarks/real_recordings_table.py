"""The table of ``docs/real_recordings.md``, written anew from ``reference/real_recordings.json``.

``python benchmarks/real_recordings_table.py [--json FILE] [--page FILE]``: replaces what stands between the page's two marks.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parents[1]
BEGIN, END = "<!-- table -->", "<!-- end of table -->"


def pair(row: dict[str, Any], who: str) -> str:
    """Held-out error from the first sample / with the initial state fitted [rad]."""
    held = row.get(who, {}).get("heldout")
    return f"{held['first_sample']:.3g} / {held['state_fitted']:.3g}" if held else "–"


def claims(row: dict[str, Any]) -> str:
    """Verdict and findings with their intervals."""
    parts = []
    for finding in row["findings"]:
        numbers = []
        for name, p in finding["parameters"].items():
            low, high = p["ci95"]
            unit = "" if p["unit"] == "1" else f" {p['unit']}"
            numbers.append(f"{name.replace('_', ' ')} {p['value']:.3g} [{low:.3g}, {high:.3g}]{unit}")
        rivals = finding["indistinguishable_from"]
        text = f"`{finding['effect']}@{finding['site']}`: {', '.join(numbers)}"
        parts.append(text + (f" (or {', '.join(f'`{r}`' for r in rivals)})" if rivals else ""))
    return "; ".join([row["verdict"].replace("_", " "), *parts])


def left(row: dict[str, Any]) -> str:
    """What stays unexplained: the tests that count, and what is doubted."""
    rest = row["unexplained"]
    if not rest.get("significant"):
        return "nothing"
    words = [t["what"] for t in rest.get("tests", [])]
    doubted = rest.get("doubted", [])
    return ", ".join(dict.fromkeys(words)) + (f"; doubted: {', '.join(f'`{d}`' for d in doubted)}" if doubted else "")


def table(rows: list[dict[str, Any]]) -> str:
    """All rigs as Markdown."""
    lines = [
        "| rig | published | `mujoco.sysid` | denoc | noise | claimed | unexplained |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for row in rows:
        noise = ", ".join(f"{n['std']:.2g} {n['unit'].replace('*', '·')}" for n in row["noise"])
        published = pair(row, "published")
        if "authors_fit" in row:
            published += f", fitted by its authors {pair(row, 'authors_fit')}"
        lines.append(
            f"| {row['rig']} | {published} | {pair(row, 'mujoco_sysid')} | {pair(row, 'denoc')} | {noise} "
            f"| {claims(row)} | {left(row)} |"
        )
        for key, what in (
            ("levels", "level of friction by recording"),
            ("laws", "dry friction at both joints, zeros off"),
        ):
            if key in row:
                best = row[key][-1] if isinstance(row[key], list) else row[key]
                lines.append(f"| {row['rig']}, {what} | | | {pair({key: best}, key)} | | see below | |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", default=str(HERE / "reference" / "real_recordings.json"))
    parser.add_argument("--page", default=str(HERE / "docs" / "real_recordings.md"))
    arguments = parser.parse_args()
    rows = json.loads(Path(arguments.json).read_text(encoding="utf-8"))["rows"]
    page = Path(arguments.page)
    text = page.read_text(encoding="utf-8")
    if BEGIN not in text or END not in text:
        raise SystemExit(f"{page}: no {BEGIN} … {END} to write between")
    before, rest = text.split(BEGIN, 1)
    after = rest.split(END, 1)[1]
    page.write_text(f"{before}{BEGIN}\n{table(rows)}\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
