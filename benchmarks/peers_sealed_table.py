"""The table of peers on sealed cases in ``docs/peers.md``, written anew from the ``proof.json`` of ``denoc prove --peers``.

``python benchmarks/peers_sealed_table.py PROOF.json``: replaces what stands between the page's two marks; what the sample was,
and what it says, is for whoever drew it to write beside.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pages import put  # isort: skip

HERE = Path(__file__).resolve().parents[1]
BEGIN, END = "<!-- sealed table -->", "<!-- end of sealed table -->"
HEADS = (
    "", "asked", "named", "exactly", "among", "worth", "false beside it", "claims where nothing is missing",
    "intervals that hold the truth", "their width", "error held out over noise", "s",
)  # fmt: skip
CODE = ("mujoco.sysid", "pysindy")  # names of packages


def count(pair: list[int]) -> str:
    """A share as counts; a dash where there is nothing to count."""
    return f"{pair[0]} of {pair[1]}" if pair[1] else "–"


def number(value: float | None, scale: float = 1.0, unit: str = "") -> str:
    """Three digits; a dash where there is none."""
    return "–" if value is None else f"{scale * value:.3g}{unit}"


def row(peer: str, said: Mapping[str, Any]) -> str:
    """What one method said."""
    asked = f"{said['asked']}" + (f", {said['failed']} without an answer" if said["failed"] else "")
    cells = (
        f"`{peer}`" if peer in CODE else peer, asked, count(said["named_single"]), str(said["named_exactly"][0]),
        number(said["listed_single"]), number(said["worth_single"], 100.0, " %"), count(said["false_beside_single"]),
        count(said["clean_false"]), count(said["coverage95"]), number(said["interval_width"]),
        number(said["heldout_over_noise"]), number(said["seconds"]),
    )  # fmt: skip
    return f"| {' | '.join(cells)} |"


def table(peers: Mapping[str, Mapping[str, Any]]) -> str:
    """Every method that was asked, the diagnosis first."""
    heads = [f"| {' | '.join(HEADS)} |", f"| {' | '.join(['--'] * len(HEADS))} |"]
    return "\n".join([*heads, *(row(peer, said) for peer, said in peers.items())])


def main() -> None:
    """Write the table into the page."""
    if len(sys.argv) != 2:
        raise SystemExit("usage: python benchmarks/peers_sealed_table.py PROOF.json")
    peers = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")).get("peers")
    if not peers:
        raise SystemExit(f"{sys.argv[1]}: no peers were asked; let `denoc prove --resume DIR --peers` ask them")
    put(HERE / "docs" / "peers.md", BEGIN, END, table(peers))


if __name__ == "__main__":
    main()
