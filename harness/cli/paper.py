"""``denoc paper``: the paper's figures and the questions it leaves, computed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import console, output_options, progress, write_json
from harness.cli.resume import UNFINISHED, folder_of, journal_in, resumable

if TYPE_CHECKING:
    from harness.cases.paper.study import Study
    from harness.journal import Journal

DRAWN = ("damping", "departure", "readings")  # of a seed
LONG = ("damping", "links")


@click.command()
@click.argument("what", type=click.Choice(["figures", "equations", "readings", "departure", "damping", "links"]))
@click.option(
    "--quick", is_flag=True, help="Shorter motions, fewer angles, lengths, modes and elements (damping, links)."
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    metavar="N",
    help="Of what is concealed (readings, departure, damping); default: a fresh one, which is told.",
)
@click.option(
    "--draws", type=click.IntRange(min=1), metavar="N", help="Truths of each kind (departure, damping); default: 2."
)
@click.option(
    "--resume",
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Go on with an interrupted run (damping, links) with --out DIR, with the same options.",
)
@click.option("--so-far", is_flag=True, help="With --resume: only tell what the interrupted `damping` has answered.")
@click.option(
    "--workers", type=click.IntRange(min=1), metavar="N", help="Processes (damping, links); default: all cores."
)
@output_options("Write the tables (.md), pictures (.svg) and the document (.json) there.")
def paper(
    what: str,
    quick: bool,
    seed: int | None,
    draws: int | None,
    resume: Path | None,
    so_far: bool,
    workers: int | None,
    out: Path | None,
    json_file: str | None,
) -> int:
    """Compute what the paper shows, or leaves open.

    \b
    figures    figures 6(a), 6(b), 7(a), 7(b) as the paper's sensors would have
               shown them; its numbers beside ours
    equations  what equation (10) as printed leaves out, asked of a recording
               made by finite elements
    readings   four ways to read damping off a decay, on concealed truth: where
               they differ and by how much
    departure  when a linear model leaves recordings of five kinds of non-linear
               damping, by release
    damping    its open question: which non-linear damping is it, how many
               seconds and which release it takes to know
    links      arms of two and three links, rigid and flexible, native against
               finite elements

    \b
    Examples:
      denoc paper figures --out figures
      denoc paper damping --seed 7 --out damping --resume damping
    """
    import secrets

    from harness.errors import InputError
    from harness.json_text import json_text
    from harness.report.columns import print_table
    from harness.report.paper import document, drawn, markdown_table
    from harness.whole_files import write_folder

    if what not in DRAWN and (seed is not None or draws is not None):
        raise InputError(f"{what} conceals nothing", mend="leave out --seed and --draws")
    if resume is not None and what not in LONG:
        raise InputError(f"{what} is not interrupted for long", mend="leave out --resume")
    if so_far and (resume is None or what != "damping"):
        raise InputError("--so-far goes with `damping --resume DIR`", mend="name the folder of the interrupted run")
    screen = console(json_file)
    out = folder_of(out, resume)
    if what in DRAWN:
        seed = (_seed_in(resume) if resume is not None else secrets.randbelow(2**31)) if seed is None else seed
        screen.print(f"seed {seed}")
    journal = None
    if what in LONG:
        of = {"what": what, "quick": quick, **({"seed": seed, "draws": draws} if what in DRAWN else {})}
        journal = journal_in(out, of, anew=resume is None)
    with resumable(f"paper {what}", out if what in LONG else None):
        study = _study(what, seed or 0, draws, quick, so_far, workers, journal)
    for name, (heads, rows) in study.tables.items():
        print_table(screen, heads, rows, title=name.replace("_", " "))
    numbers = {**({} if seed is None else {"seed": seed}), **study.numbers}
    made = json_text(document(what, study, numbers, _command(what, quick, seed, draws, so_far)))
    if out is not None:
        files = {f"{name}.md": markdown_table(heads, rows) for name, (heads, rows) in study.tables.items()}
        for path in write_folder(out, {**files, **drawn(study.series), f"{what}.json": made}):
            screen.print(f"wrote {path}", markup=False)
    write_json(made, json_file)
    if journal is not None and not so_far:
        journal.remove()
    return 0


def _command(what: str, quick: bool, seed: int | None, draws: int | None, so_far: bool) -> str:
    """The line that gives the same numbers again, wherever and on however many processes."""
    words = ["denoc", "paper", what, *(["--quick"] if quick else [])]
    words += [] if seed is None else ["--seed", str(seed)]
    words += [] if draws is None else ["--draws", str(draws)]
    return " ".join([*words, *(["--so-far"] if so_far else [])])


def _seed_in(folder: Path) -> int | None:
    """The seed of the interrupted run in a folder."""
    import json

    try:
        with (folder / UNFINISHED).open(encoding="utf-8") as file:
            return int(json.loads(file.readline())["of"]["seed"])
    except (OSError, ValueError, KeyError, TypeError):
        return None  # the journal itself says what is wrong with it


def _study(
    what: str, seed: int, draws: int | None, quick: bool, so_far: bool, workers: int | None, journal: Journal | None
) -> Study:
    if what == "figures":
        from harness.cases.paper.figures import figures

        return figures()
    if what == "equations":
        from harness.cases.paper.equations import equations

        return equations()
    if what == "departure":
        from harness.proof.paper_damping import DRAWS, departures

        return departures(seed, draws=draws or DRAWS)
    with progress(what) as step:
        if what == "readings":
            from harness.cases.paper.readings import readings

            return readings(seed, workers=workers, progress=step)
        if what == "damping":
            from harness.proof.paper_damping import DRAWS, damping

            count = draws or DRAWS
            return damping(
                seed, draws=count, quick=quick, so_far=so_far, workers=workers, progress=step, journal=journal
            )
        from harness.cases.paper.links import links

        return links(quick=quick, workers=workers, progress=step, journal=journal)
