"""The table of peers on real rigs in ``docs/peers.md``, written anew from ``reference/peers_on_rigs.json``.

``python benchmarks/peers_on_rigs_table.py``: replaces what stands between the page's two marks. The diagnosis' own figures are
those of ``reference/real_recordings.json``.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parents[1]
BEGIN, END = "<!-- rigs table -->", "<!-- end of rigs table -->"
NAMES = {
    "published": "published", "practitioner": "practitioner", "mujoco.sysid": "`mujoco.sysid`",
    "BAM's ladder": "BAM's ladder", "FIGAROH": "FIGAROH",
}  # fmt: skip


def cell(entry: Mapping[str, Any] | None) -> str:
    """Held-out error from the first sample / with the initial state fitted; a dash where it was not asked, or not made for it."""
    held = (entry or {}).get("heldout")
    return f"{held['first_sample']:.3g} / {held['state_fitted']:.3g}" if held else "–"


def table(peers: Mapping[str, Mapping[str, Any]], ours: Mapping[str, Mapping[str, Any]]) -> str:
    """Every rig that peers were asked about, and the diagnosis: what it claims, and what predicts best."""
    lines = [
        f"| rig | {' | '.join(NAMES.values())} | denoc, claimed | denoc, predicts best |",
        f"| {' | '.join(['--'] * (len(NAMES) + 3))} |",
    ]
    for rig in sorted(peers):
        row = ours.get(rig, {})
        best = {"heldout": row.get("predictive", {}).get("heldout")}
        cells = [cell(peers[rig].get(peer)) for peer in NAMES]
        lines.append(f"| {' | '.join([rig, *cells, cell(row.get('denoc')), cell(best)])} |")
    return "\n".join(lines)


def main() -> None:
    """Write the table into the page."""
    peers = json.loads((HERE / "reference" / "peers_on_rigs.json").read_text(encoding="utf-8"))["rigs"]
    rows = json.loads((HERE / "reference" / "real_recordings.json").read_text(encoding="utf-8"))["rows"]
    page = HERE / "docs" / "peers.md"
    text = page.read_text(encoding="utf-8")
    head, rest = text.split(BEGIN, 1)
    _, tail = rest.split(END, 1)
    page.write_text(f"{head}{BEGIN}\n{table(peers, {r['rig']: r for r in rows})}\n{END}{tail}", encoding="utf-8")


if __name__ == "__main__":
    main()
