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
    "told_in_vain": "within the catalogue, told as not explained",
    "at_floor": "explained and at the noise floor on held-out data",
    "side_right": "right side (dynamics, sensor, input)",
    "site_right": "right site",
    "false_anywhere": "cases with a false discovery",
    "failed": "cases that could not be diagnosed",
}

PEER_COLUMNS = (
    "named_single", "named_exactly", "listed_single", "worth_single", "false_beside_single", "clean_false", "coverage95",
    "interval_width", "heldout_over_noise", "seconds",
)  # fmt: skip
PEER_WORDS = (
    "named: single effects, by themselves or in a class that was told; exactly: by themselves; among: how many a finding is told "
    "among (mean); worth: named, each counted one over that number; false: something else beside them; clean: something where "
    "nothing is missing; inside: 95 % intervals that hold the truth; width: theirs over the truth (median); error: held out, over "
    "the noise (median), and seconds: as the method says"
)


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
    for sentence in sharpness_in_words(document):
        console.print(sentence)
    _print_peers(document.get("peers") or {}, console)
    console.print(f"seed {document['seed']}, {extent(document)}")


def sharpness_in_words(document: Mapping[str, Any]) -> list[str]:
    """How often intervals hold the truth and how wide they are, and what the findings are worth that name several effects."""
    told = []
    coverage, width, score = (document.get(key) for key in ("coverage95", "interval_width", "interval_score"))
    if coverage is not None:
        told.append(f"95 % intervals contain the truth in {100 * coverage:.0f} % of cases")
    if width is not None and score is not None:
        told.append(f"their median width is {width:.2g} of the truth; interval score {score:.2g}")
    size, worth = document.get("listed_single"), document.get("worth_single")
    if size is not None and worth is not None:
        told.append(
            f"findings are told among {size:.2g} effects on the mean; counted 1/N each, single effects named come to "
            f"{100 * worth:.0f} %"
        )
    return told


def extent(document: Mapping[str, Any]) -> str:
    """How many cases were scored, and of how many if the proof is not finished."""
    cases, sealed = document["cases"], document.get("sealed", document["cases"])
    return f"{cases} cases" if cases == sealed else f"{cases} of {sealed} cases so far"


def _print_peers(peers: Mapping[str, Any], console: Console) -> None:
    """What other methods say of clean cases and of those with one effect."""
    if not peers:
        return
    heads = ("named", "exactly", "among", "worth", "false", "clean", "inside", "width", "error", "s", "failed")
    lines = []
    for peer, said in peers.items():
        lines.append((peer, *(_cell(said, key) for key in PEER_COLUMNS), str(said["failed"])))
    print_table(console, ("peer", *map(figures, heads)), lines)
    console.print(PEER_WORDS)


def _cell(said: Mapping[str, Any], key: str) -> str:
    """A count of a count, or a number."""
    value = said.get(key)
    if isinstance(value, list):
        return f"{value[0]}/{value[1]}"
    return "" if value is None else f"{value:.3g}"
