"""The table of peers on real rigs in ``docs/peers.md``, written anew from ``reference/peers_on_rigs.json``.

``python benchmarks/peers_on_rigs_table.py``: replaces what stands between the page's two marks. The diagnosis' own figures are
those of ``reference/real_recordings.json``.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pages import errors, put  # isort: skip

HERE = Path(__file__).resolve().parents[1]
BEGIN, END = "<!-- rigs table -->", "<!-- end of rigs table -->"
NAMES = {
    "published": "published", "practitioner": "practitioner", "mujoco.sysid": "`mujoco.sysid`",
    "BAM's ladder": "BAM's ladder", "FIGAROH": "FIGAROH", "pysindy": "`pysindy`",
}  # fmt: skip


def cell(entry: Mapping[str, Any] | None) -> str:
    """One peer on one rig."""
    if entry is None:
        return "not asked"
    if "ended_after_processor_s" in entry:
        return f"ended after {entry['ended_after_processor_s']:.0f} s"
    return "failed" if "error" in entry else errors(entry)


def table(peers: Mapping[str, Mapping[str, Any]], ours: Mapping[str, Mapping[str, Any]]) -> str:
    """Every rig that peers were asked about, and the diagnosis: what it claims, and what predicts best."""
    lines = [
        f"| rig | {' | '.join(NAMES.values())} | denoc, claimed | denoc, predicts best |",
        f"| {' | '.join(['--'] * (len(NAMES) + 3))} |",
    ]
    for rig in sorted(peers):
        row = ours.get(rig, {})
        cells = [cell(peers[rig].get(peer)) for peer in NAMES]
        lines.append(f"| {' | '.join([rig, *cells, errors(row.get('denoc')), errors(row.get('predictive'))])} |")
    return "\n".join(lines)


def main() -> None:
    """Write the table into the page."""
    peers = json.loads((HERE / "reference" / "peers_on_rigs.json").read_text(encoding="utf-8"))["rigs"]
    rows = json.loads((HERE / "reference" / "real_recordings.json").read_text(encoding="utf-8"))["rows"]
    put(HERE / "docs" / "peers.md", BEGIN, END, table(peers, {r["rig"]: r for r in rows}))


if __name__ == "__main__":
    main()
