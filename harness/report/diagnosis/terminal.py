"""A diagnosis on the terminal: a few sentences, what was found, before and after."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from harness.diagnose.answer.diagnosis import numbers_of, one_by_one, rivals_of
from harness.diagnose.answer.significant_digits import resolved, spread

COLOURS = {"consistent": "bold green", "explained": "bold green", "partly_explained": "bold yellow"}

MOST_FOUND = 8  # remarks on recordings shown on the terminal


def print_diagnosis(document: Mapping[str, Any], console: Console) -> None:
    """Print a ``denoc.diagnosis/1`` document."""
    verdict = document["verdict"]
    console.print(Text(verdict.replace("_", " "), style=COLOURS.get(verdict, "bold red")))
    console.print(Text(document["summary"]))
    if document.get("quality"):
        console.print(_quality(document["quality"]))
    if document["findings"]:
        console.print(_findings(document["findings"]))
    if document["fit"]:
        console.print(_fit(document["fit"]))
    if document.get("levels"):
        console.print(_levels(document["levels"]))
        console.print(Text(document["levels"]["how"]))
    ranking = document.get("ranking") or []
    if len(ranking) > 1:
        console.print(_ranking(ranking[:6]))
    if document.get("replay"):
        console.print(_replay(document["replay"]))
    following = document.get("next_experiment") or {}
    if following.get("what"):
        separates = ", ".join(following.get("separates", ()))
        console.print(Text(f"Next experiment: {following['what']}" + (f" (parts {separates})" if separates else "")))


def _findings(findings: list[Mapping[str, Any]]) -> Table:
    table = _table("effect", "at", "parameters", "ΔBIC", "cannot be told from")
    for finding in one_by_one(findings):
        parameters = "; ".join(
            f"{name} = {resolved(value['value'], value.get('std'))}"
            + spread(value["value"], value.get("std"), value.get("ci95"))
            + ("" if value["unit"] == "1" else f" {value['unit']}")
            for name, value in numbers_of(finding).items()
        )
        others = ", ".join(rivals_of(finding))
        bic = finding.get("evidence", {}).get("delta_bic")
        table.add_row(finding["effect"], finding["site"], parameters, "" if bic is None else f"{bic:.0f}", others)
    return table


def _fit(fit: list[Mapping[str, Any]]) -> Table:
    table = _table("channel", "unit", "nominal: training", "held out", "augmented: training", "held out", "noise floor")
    for channel in fit:
        table.add_row(
            channel["channel"],
            channel["unit"],
            *(
                _figure(channel[model][error])
                for model in ("nominal", "augmented")
                for error in ("train_rmse", "heldout_rmse")
            ),
            _figure(channel["noise_floor"]),
        )
    return table


def _levels(levels: Mapping[str, Any]) -> Table:
    table = _table("recording", "level of dry friction", "std", "error, one level for all", "error, one level each")
    for row in levels["recordings"]:
        table.add_row(
            row["recording"] + (" (held out)" if row["held_out"] else ""),
            *(_figure(row[key]) for key in ("factor", "std", "shared_rmse", "levelled_rmse")),
        )
    return table


def _ranking(ranking: list[Mapping[str, Any]]) -> Table:
    table = _table("hypothesis", "ΔBIC", "held out", "why it lost")
    least = min((row["bic"] for row in ranking if row.get("bic") is not None), default=0.0)
    for row in ranking:
        bic = row.get("bic")
        table.add_row(
            " + ".join(row["effects"]) or "nothing",
            "–" if bic is None else f"{bic - least:.0f}",
            _figure(row.get("heldout_rmse")),
            row.get("lost") or "",
        )
    return table


def _quality(quality: list[Mapping[str, Any]]) -> Table:
    table = _table("recording", "column", "what was found", "what was done")
    for row in quality[:MOST_FOUND]:
        table.add_row(row["recording"], row.get("channel") or "", row["what"], row.get("done") or "")
    if len(quality) > MOST_FOUND:
        table.add_row("…", "", f"{len(quality) - MOST_FOUND} more in the report", "")
    return table


def _replay(replay: list[Mapping[str, Any]]) -> Table:
    table = _table("augmented model in", "differs most in", "RMS difference", "noise", "")
    for row in replay:
        table.add_row(
            row["engine"], row["channel"] or "–", _figure(row["difference"]), _figure(row["noise"]), row["note"]
        )
    return table


def _table(*heads: str) -> Table:
    table = Table(box=None, header_style="bold", pad_edge=False)
    for head in heads:
        table.add_column(head, overflow="fold")
    return table


def _figure(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}"
