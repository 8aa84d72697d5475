"""The blind proof's figures on the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rich.console import Console

from harness.report.columns import figures, print_table

# Key in ``denoc.proof/1``, what it means.
SHARES = {
    "named_single": "single effects named (or a member of their class)",
    "named_single_exactly": "single effects named exactly",
    "named_pairs": "pairs named",
    "named_triples": "triples named",
    "clean_false": "false discoveries in clean recordings",
    "outside_told": "effects outside the catalogue told as not explained",
    "outside_apart_told": "the same, without those that act as what was told",
    "at_floor": "explained and at the noise floor on held-out data",
    "side_right": "right side (dynamics, sensor, input)",
    "site_right": "right site",
    "false_anywhere": "cases with a false discovery",
    "failed": "cases that could not be diagnosed",
}


def print_proof(document: Mapping[str, Any], console: Console) -> None:
    """Shares with Wilson intervals, coverage of the 95 % intervals, and what the peers say."""
    lines = []
    for key, words in SHARES.items():
        if key in document:
            hits, of = document[key]
            low, high = document.get("wilson95", {}).get(key, (float("nan"), float("nan")))
            share = f"{100 * hits / of:.0f} %" if of else "none tried"
            lines.append((words, f"{hits}/{of}", share, f"{100 * low:.0f}–{100 * high:.0f} %" if of else ""))
    print_table(console, ("", figures("of"), figures("share"), figures("95 % interval")), lines)
    coverage = document.get("coverage95")
    if coverage is not None:
        console.print(f"95 % intervals contain the truth in {100 * coverage:.0f} % of cases")
    _print_peers(document.get("peers") or {}, console)
    console.print(f"seed {document['seed']}, {extent(document)}")


def extent(document: Mapping[str, Any]) -> str:
    """How many cases were scored, and of how many if the proof is not finished."""
    cases, sealed = document["cases"], document.get("sealed", document["cases"])
    return f"{cases} cases" if cases == sealed else f"{cases} of {sealed} cases so far"


def _print_peers(peers: Mapping[str, Any], console: Console) -> None:
    """What other methods say of clean cases and of those with one effect."""
    if not peers:
        return
    heads = ("named", "false", "clean", "inside", "error", "s", "failed")
    lines = []
    for peer, said in peers.items():
        pairs = [
            f"{said[key][0]}/{said[key][1]}" if key in said else ""
            for key in ("named_single", "false_beside_single", "clean_false", "coverage95")
        ]
        numbers = ["" if said.get(key) is None else f"{said[key]:.3g}" for key in ("heldout_over_noise", "seconds")]
        lines.append((peer, *pairs, *numbers, str(said["failed"])))
    print_table(console, ("peer", *map(figures, heads)), lines)
    console.print(
        "named: single effects; false: something else beside them; clean: something where nothing is missing; inside: 95 % "
        "intervals that hold the truth; error: held out, over the noise (median)"
    )
