"""``denoc audit``: is a parameter table possible at all?"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import allow_option, console, output_options, say_notes, write_json

if TYPE_CHECKING:
    from harness.system.audit_findings import Correction

#: What is said at the end, and its colour, by the gravest finding.
VERDICTS = {
    "impossible": ("The table cannot be true as it stands.", "red"),
    "implausible": (
        "The table is hardly true as it stands: nothing in it is impossible, but look at what is said above.",
        "yellow",
    ),
    "note": ("The table is possible.", "green"),
}


@click.command()
@click.argument("system", metavar="SYSTEM")
@click.option(
    "--measured",
    multiple=True,
    metavar="LINK=HZ[,HZ…]",
    help="Bending frequencies of a link as mounted, lowest first; repeatable for several links.",
)
@allow_option
@output_options("Write audit.json there.")
def audit(
    system: str, measured: tuple[str, ...], allow: tuple[str, ...], out: Path | None, json_file: str | None
) -> int:
    """Hold a parameter table against physics and measurement.

    Mass against dimensions and density, frequency against stiffness and mass, materials, inertia, units. Where something
    cannot be, the corrections that would explain it are ranked.

    \b
    Example:
      denoc audit models/toml/flexible_pendulum_as_printed.toml --measured rod=37
    """
    from rich.text import Text

    from harness.json_text import json_text
    from harness.report.columns import figures, print_table
    from harness.system import load
    from harness.system.audit import audit as hold

    # A TOML is audited as its table stands, though it could not be loaded.
    read = None if Path(system).suffix.lower() == ".toml" else load(system, physical=False, allow=allow)
    found = hold(system if read is None else read, measured=_measured(measured))
    if read is not None:
        say_notes(read.notes)
    screen = console(json_file)
    colours = {"impossible": "bold red", "implausible": "yellow"}
    for finding in found.findings:
        line = Text(f"{finding.severity}: ", style=colours.get(finding.severity, "dim"))
        screen.print(line + Text(f"{finding.site}: {finding.what}", style="default"))
    if found.corrections:
        lines = []
        for c in found.corrections:
            changes = "; ".join(f"{x.quantity} {x.stated:g} → {x.corrected:g} ({x.slip})" for x in c.changes)
            told = Text(changes or "as it stands", style="" if c.agrees else "dim")
            heard = ", ".join(f"{f:.4g}" for f in c.frequencies)
            rank = f"{c.rank}=" if any(c in tie for tie in found.ties) else str(c.rank)
            lines.append((c.site, rank, told, f"{c.density:.0f}", c.material, heard, f"{100.0 * c.probability:.2g} %"))
        heads = (
            "link", figures("rank"), "correction", figures("density [kg/m³]"), "material", "frequencies [Hz]",
            figures("share of candidates"),
        )  # fmt: skip
        print_table(screen, heads, lines, title="What would explain it")
        for tie in found.ties:
            which = f"{tie[0].site}: the {len(tie)} corrections of rank {tie[0].rank} are one as good as the other"
            screen.print(Text(f"{which}; {_parted(tie)}."))
    text, colour = VERDICTS[found.worst]
    screen.print(Text(text, style=f"bold {colour}"))
    document = json_text(found.to_json())
    if out is not None:
        from harness.whole_files import write_folder

        write_folder(out, {"audit.json": document})
    write_json(document, json_file)
    return 0 if found.possible else 1


def _parted(tie: Sequence[Correction]) -> str:
    """What would tell corrections of equal rank apart."""
    count = len({f"{c.frequencies[0]:.3g}" for c in tie})
    if count == 1:
        return "they bend alike, so that only the part itself can tell them apart"
    lowest = ", ".join(sorted({f"{c.frequencies[0]:.4g}" for c in tie}, key=float))
    which = "would tell them apart" if count == len(tie) else "would tell most of them apart"
    return f"the measured frequency of its first bending {which} ({lowest} Hz): --measured {tie[0].site}=HZ"


def _measured(texts: tuple[str, ...]) -> dict[str, list[float]]:
    from harness.errors import InputError

    heard: dict[str, list[float]] = {}
    for text in texts:
        link, equals, values = text.partition("=")
        try:
            if not equals or link in heard:
                raise ValueError
            heard[link] = [float(value) for value in values.split(",")]
        except ValueError:
            raise InputError(
                f"--measured {text!r} is not of the form link=frequency", mend="--measured rod=37 or rod=37,105"
            ) from None
    return heard
