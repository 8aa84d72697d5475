"""A decay on the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.text import Text

from harness.diagnose.answer.significant_digits import best, digits, ends, estimate
from harness.recording.units import written
from harness.report.columns import Column, figures, print_table

LAWS = ("viscous", "dry", "quadratic")


def print_decay(document: Mapping[str, Any], console: Console) -> None:
    """Print a ``denoc.decay/1`` document."""
    frequency, amplitude = document["frequency"], document["amplitude"]
    console.print(
        Text(
            f"{document['channel']}: {document['half_swings']} half-swings from {document['from']:.4g} to {document['to']:.4g} s, "
            f"amplitude {amplitude['first']:.4g} to {amplitude['last']:.4g} about {document['rest']:.4g}; "
            f"{frequency['small']:.5g} Hz for vanishing swings, {frequency['first']:.4g} Hz at first; "
            f"restoring force by {'the sine of the angle' if document['restoring'] == 'sine' else 'the position'}."
        )
    )
    read, likeliest = document["decrement"], document["likelihood"]
    heads: tuple[Column | str, ...] = (
        "how",
        *(figures(f"{law} [{written(document['linear'][law]['unit'])}]") for law in LAWS),
        figures("left (rms)"),
    )
    rows = [
        ("ratio of amplitudes, as printed", digits(read["printed"]["value"], 3), "", "", ""),
        ("logarithmic decrement", _with(read["viscous"]), "", "", ""),
        (
            "envelope of the half-swings",
            *(_with(document["envelope"][law]) for law in LAWS),
            digits(document["envelope"]["rms"], 3),
        ),
        ("every sample, viscous alone", _with(document["linear"]["viscous"]), "", "", digits(document["linear"]["rms"], 3)),
        (
            "every sample, best laws",
            *(_with(likeliest[law]) if law in likeliest["laws"] else "–" for law in LAWS),
            digits(likeliest["rms"], 3),
        ),
    ]  # fmt: skip
    bold = [tuple(Text(cell, style="bold") for cell in rows[-1])]
    print_table(console, heads, [*rows[:-1], *bold])
    console.print(
        Text(
            f"Decrement {estimate(read['value'], read['std'], None)}, damping ratio {read['damping_ratio']:.4g}; "
            f"noise {likeliest['noise']:.3g}."
        )
    )
    rivals = list(document["tried"][1:3])
    told = "; ".join(f"{_laws(one['laws'])} {one['bic']:+.0f}" for one in rivals)
    console.print(Text(f"Damping is {_laws(likeliest['laws'])} (BIC of others: {told})."))
    if likeliest["rms"] > 1.2 * likeliest["noise"] or likeliest["memory"] > 0.3:
        console.print(
            Text(
                "What is left is more than white noise: another law may be at work; `denoc diagnose` with a model looks for it.",
                style="yellow",
            )
        )
    if document["departure"] is not None:
        console.print(
            Text(
                f"Viscous damping of the first four swings leaves the amplitudes by a tenth after {document['departure']:.3g} s."
            )
        )


def print_bands(rows: Sequence[Mapping[str, Any]], unit: str, console: Console) -> None:
    """Print the bands of a signal, each with frequency, amplitude and decay."""
    heads = (
        "band", "frequency [Hz]", f"amplitude [{written(unit)}]", "rate [1/s]", "damping ratio", "line [Hz]"
    )  # fmt: skip
    print_table(
        console,
        [heads[0], *map(figures, heads[1:])],
        [
            (
                row["band"],
                *(_interval(row[key]) for key in ("frequency", "amplitude", "rate", "damping_ratio")),
                "–" if row["line"] is None else digits(row["line"], 4),
            )
            for row in rows
        ],
    )


def print_apart(told: Mapping[str, Any], console: Console) -> None:
    """Print whose damping the vibration's is."""
    console.print(
        Text(
            f"Of the vibration's damping ratio the joint's {_interval(told['joint'])} {written(told['joint']['unit'])} makes "
            f"{_interval(told['by_joint'])}; the damping of {told['link']} itself, mode {told['mode']} at "
            f"{digits(told['frequency']['value'], 4)} Hz, is {_interval(told['modal'])}."
        )
    )


def _laws(laws: Sequence[str]) -> str:
    return " and ".join(laws) if laws else "nothing"


def _with(value: Mapping[str, Any]) -> str:
    if value["value"] < 1e-3 * value["std"] or value["std"] == 0.0:
        return "0"  # at its bound, where an uncertainty says nothing
    return estimate(value["value"], value["std"], value.get("ci95"))


def _interval(value: Mapping[str, Any]) -> str:
    return f"{best(value['value'], value['ci95'])} ({ends(value['ci95'])})"
