"""A decay on the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from harness.recording.units import written

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
    table = Table(box=None, header_style="bold", pad_edge=False)
    for head in ("how", *(f"{law} [{written(document['linear'][law]['unit'])}]" for law in LAWS), "left (rms)"):
        table.add_column(Text(head), overflow="fold", justify="left" if head == "how" else "right")
    read = document["decrement"]
    table.add_row("ratio of amplitudes, as printed", _number(read["printed"]["value"]), "", "", "")
    table.add_row("logarithmic decrement", _with(read["viscous"]), "", "", "")
    table.add_row(
        "envelope of the half-swings",
        *(_with(document["envelope"][law]) for law in LAWS),
        _number(document["envelope"]["rms"]),
    )
    table.add_row(
        "every sample, viscous alone", _with(document["linear"]["viscous"]), "", "", _number(document["linear"]["rms"])
    )
    best = document["likelihood"]
    table.add_row(
        "every sample, best laws",
        *(_with(best[law]) if law in best["laws"] else "–" for law in LAWS),
        _number(best["rms"]),
        style="bold",
    )
    console.print(table)
    console.print(
        Text(
            f"Decrement {read['value']:.4g} ± {read['std']:.2g}, damping ratio {read['damping_ratio']:.4g}; "
            f"noise {best['noise']:.3g}."
        )
    )
    rivals = list(document["tried"][1:3])
    told = "; ".join(f"{_laws(one['laws'])} {one['bic']:+.0f}" for one in rivals)
    console.print(Text(f"Damping is {_laws(best['laws'])} (BIC of others: {told})."))
    if best["rms"] > 1.2 * best["noise"] or best["memory"] > 0.3:
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
    table = Table(box=None, header_style="bold", pad_edge=False)
    for head in ("band", "frequency [Hz]", f"amplitude [{written(unit)}]", "rate [1/s]", "damping ratio", "line [Hz]"):
        table.add_column(Text(head), overflow="fold", justify="left" if head == "band" else "right")
    for row in rows:
        table.add_row(
            row["band"],
            *(_interval(row[key]) for key in ("frequency", "amplitude", "rate", "damping_ratio")),
            "–" if row["line"] is None else f"{row['line']:.4g}",
        )
    console.print(table)


def _laws(laws: Sequence[str]) -> str:
    return " and ".join(laws) if laws else "nothing"


def _number(value: float) -> str:
    return f"{value:.3g}"


def _with(value: Mapping[str, Any]) -> str:
    if value["value"] < 1e-3 * value["std"] or value["std"] == 0.0:
        return "0"  # at its bound, where an uncertainty says nothing
    return f"{value['value']:.4g} ± {value['std']:.1g}"


def _interval(value: Mapping[str, Any]) -> str:
    low, high = value["ci95"]
    return f"{value['value']:.4g} ({low:.4g} to {high:.4g})"
