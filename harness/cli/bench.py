"""``denoc bench``: time and memory against the peers."""

from __future__ import annotations

from pathlib import Path

import click

from harness.cli.interrupt import Interrupted
from harness.cli.options import console, output_options, progress, write_json

UNFINISHED = "unfinished.jsonl"


@click.command()
@click.option(
    "--only", multiple=True, metavar="WHAT", help="Only this benchmark or row ('forward*': all that start so)."
)
@click.option("--quick", is_flag=True, help="Small mechanisms only, fewer rounds.")
@click.option("--list", "list_them", is_flag=True, help="List the benchmarks and their rows.")
@click.option(
    "--resume",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Go on with a run with --out DIR that was interrupted, with the same options on the same machine.",
)
@output_options("Write bench.json, bench.md and report.html with the scaling plots there.")
def bench(
    only: tuple[str, ...],
    quick: bool,
    list_them: bool,
    resume: Path | None,
    out: Path | None,
    json_file: str | None,
) -> int:
    """Measure time and memory against the peers, side by side in one run.

    Ratios are theirs over ours: above 1 the native code is faster.

    \b
    Examples:
      denoc bench
      denoc bench --only 'forward_dynamics*' --out bench
      denoc bench --resume bench
    """
    from harness.compare.bench import BENCHMARKS, Options, Row, document, machine, run, select
    from harness.errors import InputError
    from harness.journal import Journal
    from harness.report.bench import bench_files, print_bench
    from harness.report.json_text import json_text

    screen = console(json_file)
    if list_them:
        for name, benchmark in BENCHMARKS.items():
            screen.print(f"{name}: {benchmark.title} ({', '.join(benchmark.rows)})", markup=False)
        return 0
    total = sum(len(names) for names in select(only).values())
    rows: list[Row] = []
    if resume is not None:
        if out is not None and out != resume:
            raise InputError("--resume and --out name different folders", mend="give the one or the other")
        if not (resume / UNFINISHED).exists():
            raise InputError("holds no interrupted run", source=resume, mend="give the --out of one")
        out = resume
    journal = None
    if out is not None:
        if resume is None:
            (out / UNFINISHED).unlink(missing_ok=True)
        journal = Journal(out / UNFINISHED, {"only": list(only), "quick": quick, "machine": machine()})
    with progress("bench") as step:

        def tell(what: str) -> None:
            done = len({r.what for r in rows})
            step(done, max(total, done), what)

        try:
            for row in run(only, Options(quick=quick, rounds=7 if quick else 15, tell=tell), journal):
                rows.append(row)
                tell(row.what)
        except KeyboardInterrupt:
            if out is None:
                raise
            raise Interrupted(
                f"stopped; `denoc bench --resume {out}` with the same options goes on from here"
            ) from None
    answer = document(rows, machine())
    print_bench(answer, screen)
    if out is not None:
        from harness.report.files import write_folder

        for path in write_folder(out, bench_files(answer)):
            screen.print(f"wrote {path}", markup=False)
    if journal is not None:
        journal.remove()
    write_json(json_text(answer), json_file)
    return 0
