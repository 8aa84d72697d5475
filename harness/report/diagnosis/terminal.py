"""A diagnosis on the terminal: a few sentences, what was found, before and after."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.text import Text

from harness.diagnose.answer.diagnosis import numbers_of, one_by_one, rivals_of
from harness.diagnose.answer.findings import none_of_stated
from harness.diagnose.answer.significant_digits import estimate, resolved, rounded
from harness.plain_numbers import points
from harness.recording.units import written
from harness.report.columns import Column, figures, print_table
from harness.report.diagnosis.held_out_errors import channels_of, headings, held_out
from harness.report.diagnosis.sections.disagreement import heads_of, interval
from harness.report.diagnosis.sets_in_words import first_not_likeliest, sets_in_words

COLOURS = {"consistent": "bold green", "explained": "bold green", "partly_explained": "bold yellow"}

Shown = tuple[tuple[Column | str, ...], list[tuple[str, ...]]]

MOST_FOUND = 8  # remarks on recordings shown on the terminal
MOST_CHANNELS = 3  # whose errors are; all are in the report
MOST_NUMBERS_APART = 2  # of recordings that disagree


def print_diagnosis(document: Mapping[str, Any], console: Console) -> None:
    """Print a ``denoc.diagnosis/1`` document."""
    verdict = document["verdict"]
    console.print(Text(verdict.replace("_", " "), style=COLOURS.get(verdict, "bold red")))
    console.print(Text(document["summary"]))
    if document.get("quality"):
        _show(console, *_quality(document["quality"]))
    if document["findings"]:
        _show(console, *_findings(document["findings"]))
    if document["fit"]:
        _show(console, *_fit(document["fit"]))
    if document.get("disagreement"):
        _show(console, *_disagreement(document["disagreement"]))
    if document.get("levels"):
        _show(console, *_levels(document["levels"]))
        console.print(Text(document["levels"]["how"]))
    ranking = document.get("ranking") or []
    if len(ranking) > 1:
        _show(console, *_ranking(ranking[:6]))
        note = first_not_likeliest(ranking[:6])
        if note:
            console.print(Text(note))
    if document.get("replay"):
        _show(console, *_replay(document["replay"]))
    following = document.get("next_experiment") or {}
    if following.get("what"):
        console.print()
        separates = ", ".join(following.get("separates", ()))
        console.print(Text(f"Next experiment: {following['what']}" + (f" (parts {separates})" if separates else "")))


def _show(console: Console, heads: tuple[Column | str, ...], lines: list[tuple[str, ...]]) -> None:
    console.print()
    print_table(console, heads, lines)


def _findings(findings: list[Mapping[str, Any]]) -> Shown:
    heads = ("effect", "at", "grade", "parameters", figures("ΔBIC"), "cannot be told from")
    lines: list[tuple[str, ...]] = []
    for finding in one_by_one(findings):
        parameters = "; ".join(_number(finding, name) for name in numbers_of(finding))
        others = ", ".join(rivals_of(finding))
        bic = finding.get("evidence", {}).get("delta_bic")
        weight = "" if bic is None else points(bic)
        lines.append((finding["effect"], finding["site"], finding.get("grade") or "", parameters, weight, others))
    return heads, lines


def _number(finding: Mapping[str, Any], name: str) -> str:
    """A parameter with its number, or with that alone where it says that nothing is left of what the model states."""
    value = numbers_of(finding)[name]
    unit, rest = written(value["unit"]), none_of_stated(finding, name)
    if rest:
        return f"{name} = {resolved(value['value'], None)} {unit}: {rest}"
    return f"{name} = {estimate(value['value'], value.get('std'), value.get('ci95'), unit)}"


def _fit(fit: list[Mapping[str, Any]]) -> Shown:
    # What an encoder behind a gear reads is explained beside the motion: the model that predicts best says nothing of it.
    models = ["nominal", "augmented", *(["predictive"] if any("predictive" in channel for channel in fit) else [])]
    errors = [figures(head) for model in models for head in (f"{model}: training", "held out")]
    heads: tuple[Column | str, ...] = ("channel", "unit", *errors, figures("noise floor"))
    lines = [
        (
            channel["channel"],
            written(channel["unit"]),
            *(
                rounded(channel.get(model, {}).get(error))
                for model in models
                for error in ("train_rmse", "heldout_rmse")
            ),
            rounded(channel["noise_floor"]),
        )
        for channel in fit
    ]
    return heads, lines


def _disagreement(apart: Mapping[str, Any]) -> Shown:
    """What each recording says by itself: what differs, and else the first numbers, as far as a line has room."""
    shown = heads_of(apart)[:MOST_NUMBERS_APART]
    heads: tuple[Column | str, ...] = (
        "recording",
        figures("left by itself [noise]"),
        *(figures(head) for _, head, _ in shown),
    )
    lines = [
        (row["recording"], rounded(row["times_noise"]), *(interval(row["parameters"][key]) for key, _, _ in shown))
        for row in apart["recordings"]
    ]
    return heads, lines


def _levels(levels: Mapping[str, Any]) -> Shown:
    heads = (
        "recording",
        figures(f"level of {levels.get('kind', 'dry friction')}"),
        figures("std"),
        figures("error, one level for all"),
        figures("error, one level each"),
    )
    lines = [
        (
            row["recording"] + (" (held out)" if row["held_out"] else ""),
            *(rounded(row[key]) for key in ("factor", "std", "shared_rmse", "levelled_rmse")),
        )
        for row in levels["recordings"]
    ]
    return heads, lines


def _ranking(ranking: list[Mapping[str, Any]]) -> Shown:
    channels = channels_of(ranking)[:MOST_CHANNELS]
    columns: tuple[Column | str, ...] = (
        "hypothesis",
        figures("ΔBIC"),
        *map(figures, headings(channels, "held out")),
        "why it lost",
    )
    lines: list[tuple[str, ...]] = []
    least = min((row["bic"] for row in ranking if row.get("bic") is not None), default=0.0)
    for row, said in zip(ranking, sets_in_words(ranking), strict=True):
        bic = row.get("bic")
        lines.append(
            (
                said,
                "–" if bic is None else points(bic - least),
                *(rounded(error) for error in held_out(row, channels)),
                row.get("lost") or "",
            )
        )
    return columns, lines


def _quality(quality: list[Mapping[str, Any]]) -> Shown:
    heads = ("recording", "column", "what was found", "what was done")
    lines: list[tuple[str, ...]] = [
        (row["recording"], row.get("channel") or "", row["what"], row.get("done") or "") for row in quality[:MOST_FOUND]
    ]
    if len(quality) > MOST_FOUND:
        lines.append(("…", "", f"{len(quality) - MOST_FOUND} more in the report", ""))
    return heads, lines


def _replay(replay: list[Mapping[str, Any]]) -> Shown:
    heads = ("augmented model in", "differs most in", figures("RMS difference"), figures("noise"), "")
    lines: list[tuple[str, ...]] = [
        (row["engine"], row["channel"] or "–", rounded(row["difference"]), rounded(row["noise"]), row["note"])
        for row in replay
    ]
    return heads, lines
