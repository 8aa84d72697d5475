"""Options and output that the verbs have in common."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from rich.console import Console


UNLIMITED = 100_000  # columns

F = TypeVar("F", bound=Callable[..., Any])


def output_options(out_help: str) -> Callable[[F], F]:
    """``--out DIR`` and ``--json FILE``."""

    def decorate(function: F) -> F:
        function = click.option(
            "--json",
            "json_file",
            metavar="FILE",
            help="Write the answer for programs to FILE; '-' is standard output, and nothing else is printed there.",
        )(function)
        return click.option("--out", metavar="DIR", type=click.Path(path_type=Path), help=out_help)(function)

    return decorate


def allow_option(function: F) -> F:
    """``--allow-path``, for models that name files elsewhere."""
    return click.option(
        "--allow-path",
        "allow",
        multiple=True,
        metavar="DIR",
        help="A folder beside the model's own that its includes and meshes may lie in; repeatable.",
    )(function)


def wide_options(beside: str = "") -> Callable[[F], F]:
    """``--workers`` and ``--dask``, for work that goes through the parallel map; beside: the option that they need."""
    condition = f" (with {beside})" if beside else ""

    def decorate(function: F) -> F:
        function = click.option(
            "--dask",
            metavar="ADDRESS",
            help=f"Run on an existing Dask cluster, for example tcp://head:8786{condition}.",
        )(function)
        return click.option(
            "--workers",
            metavar="N",
            type=click.IntRange(min=1),
            help=f"Processes on this machine; default: all cores{condition}.",
        )(function)

    return decorate


def console(json_file: str | None = None) -> Console:
    """Where a person reads: standard output, or standard error if standard output carries JSON."""
    from rich.console import Console

    stream = sys.stderr if json_file == "-" else sys.stdout
    # Piped output is for grep: as wide as its lines are, without colours.
    return Console(file=stream, width=None if stream.isatty() else UNLIMITED, soft_wrap=False, highlight=False)


def say_notes(notes: Iterable[str]) -> None:
    """What was left out of a model or a recording, or had to be interpreted, on standard error, one line each."""
    for note in notes:
        click.echo("denoc: note: " + " ".join(note.split()), err=True)


def write_json(text: str, json_file: str | None) -> None:
    """Write a document where ``--json`` asks for it."""
    if json_file is None:
        return
    if not text.endswith("\n"):
        text += "\n"
    if json_file == "-":
        click.echo(text, nl=False)
        return
    from harness.whole_files import write_whole

    write_whole(json_file, text)


@contextmanager
def progress(title: str) -> Iterator[Callable[[int, int, str], None]]:
    """A progress bar on a terminal, nothing when piped; call it with (done, total, what)."""
    if not sys.stderr.isatty():
        yield lambda done, total, what: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    with Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("[dim]{task.fields[what]}"),
        console=Console(stderr=True),
        transient=True,
    ) as bar:
        task = bar.add_task(title, total=None, what="starting")

        def step(done: int, total: int, what: str) -> None:
            bar.update(task, completed=done, total=total, what=what)

        yield step
