"""Tables of ``docs/known_interventions.md`` and the README's sentence, written anew from ``reference/known_interventions.json``.

``python benchmarks/known_interventions_table.py [--json FILE] [--page FILE] [--readme FILE]``
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pages import put  # isort: skip

HERE = Path(__file__).resolve().parents[1]
BEGIN, END = "<!-- known interventions -->", "<!-- end of known interventions -->"


def share(told: Mapping[str, Any]) -> str:
    """A count with its Wilson interval."""
    if not told["of"]:
        return "none to judge"
    low, high = (100.0 * x for x in told["wilson95"])
    return f"{told['hits']} of {told['of']} ({low:.0f}–{high:.0f} %)"


def size(found: Mapping[str, Any]) -> str:
    """True and found size of a change."""
    low, high = found["ci95"] or (None, None)
    span = "no interval" if low is None or high is None else f"{low:.3g} … {high:.3g}"
    like = "" if found["like"] is None else f" (as a point {found['like']:.3g})"
    return f"{found['true']:.3g}{like} / {found['value']:.3g} ({span}) {found['unit']}"


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """All cases, as Markdown."""
    lines = [
        "| case | what was changed | named | size: true / found (95 %) | holds | claimed | verdict | plain fit, told what |",
        "| -- | -- | -- | -- | -- | -- | -- | -- |",
    ]
    for row in rows:
        sizes = "; ".join(map(size, row["sizes"])) or "–"
        holds = ", ".join("yes" if s["holds"] else "no" for s in row["sizes"]) or "–"
        told = ", ".join(f"`{t}`" for t in row["told"]) or "–"
        (true,) = row["expected"]["parameters"].values()
        point = "".join(f", as a point {x:.3g}" for x in row["expected"]["like"].values())
        fits = " or ".join(f"{x:.3g}" for x in row.get("plain_fit", ())) or "no size"
        verdict = row["verdict"].replace("_", " ")
        named = {"false": "no: something else", "silent": "no: nothing is claimed", "failed": "no: an error"}.get(
            row["named"], row["named"]
        )
        if row["named"] == "in class":
            named += f", by `{row['by']}`"
        if row["possible"]:
            named += f"; possible is `{row['possible']}`"
        truth = f"true {true:.3g}{point}"
        lines.append(
            f"| {row['case']} | {row['what']} | {named} | {sizes} | {holds} | {told} | {verdict} | {fits} ({truth}) |"
        )
    return "\n".join(lines)


def summary(document: Mapping[str, Any]) -> str:
    """The counts, as Markdown."""
    told = document["shares"]
    asked = (
        ("named, exactly or in a class told as one", "named"),
        ("of these exactly", "named_exactly"),
        ("interval of 95 % that holds what was weighed or measured, where named exactly", "interval_holds"),
        ("the same, the point mass that makes the same swing in place of the discs", "interval_holds_like"),
        ("not named, but told as possible, exactly or in a class told as one", "told_as_possible"),
        ("false headline: something else is claimed", "false_headline"),
        ("cannot tell: nothing is claimed", "cannot_tell"),
        ("failed: the diagnosis ended with an error", "failed"),
    )
    lines = ["| counted | of the cases |", "| -- | -- |", *(f"| {what} | {share(told[key])} |" for what, key in asked)]
    if document["not_run"]:
        lines += ["", f"Not run: {', '.join(document['not_run'])}."]
    return "\n".join(lines)


def sentence(document: Mapping[str, Any]) -> str:
    """What the README says."""
    told = document["shares"]
    holds = told["interval_holds"]
    named, low, high = told["named"], *(100.0 * x for x in told["named"]["wilson95"])
    return (
        f"On **real hardware with a known change** (a weight added or moved, a rod exchanged; {len(told['rigs'])} rigs, "
        f"answers sealed, those of fourteen cases seen in earlier runs, {document['time_limit_s']:.0f} s a case) "
        "the tool, given the model of the "
        f"other state, names the change in {named['hits']} of {named['of']} cases ({low:.0f}–{high:.0f} %), "
        f"{told['named_exactly']['hits']} of them exactly, and tells it as possible in {told['told_as_possible']['hits']} more; "
        f"{holds['hits']} of {holds['of']} intervals of 95 % hold its size; in {told['false_headline']['hits']} something else is "
        f"claimed, in {told['cannot_tell']['hits']} nothing, and {told['failed']['hits']} ended with an error. "
        "A plain fit that is told which number changed finds it "
        "([docs/known_interventions.md](docs/known_interventions.md))."
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, default=HERE / "reference" / "known_interventions.json")
    parser.add_argument("--page", type=Path, default=HERE / "docs" / "known_interventions.md")
    parser.add_argument("--readme", type=Path, default=HERE / "README.md")
    given = parser.parse_args()
    document = json.loads(given.json.read_text(encoding="utf-8"))
    put(given.page, BEGIN, END, f"{summary(document)}\n\n{table(document['rows'])}")
    put(given.readme, BEGIN, END, sentence(document))


if __name__ == "__main__":
    main()
