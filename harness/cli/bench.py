"""``denoc bench``: time and memory against the peers."""

from __future__ import annotations

from pathlib import Path

import click

from harness.cli.options import console, output_options, progress, write_json
from harness.cli.resume import folder_of, journal_in, resumable


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
    from harness.json_text import json_text
    from harness.report.bench import bench_files, print_bench

    screen = console(json_file)
    if list_them:
        for name, benchmark in BENCHMARKS.items():
            screen.print(f"{name}: {benchmark.title} ({', '.join(benchmark.rows)})", markup=False)
        return 0
    total = sum(len(names) for names in select(only).values())
    rows: list[Row] = []
    out = folder_of(out, resume)
    journal = journal_in(out, {"only": list(only), "quick": quick, "machine": machine()}, anew=resume is None)
    with progress("bench") as step, resumable("bench", out):

        def tell(what: str) -> None:
            done = len({r.what for r in rows})
            step(done, max(total, done), what)

        for row in run(only, Options(quick=quick, rounds=7 if quick else 15, tell=tell), journal):
            rows.append(row)
            tell(row.what)
    answer = document(rows, machine())
    print_bench(answer, screen)
    if out is not None:
        from harness.whole_files import write_folder

        for path in write_folder(out, bench_files(answer)):
            screen.print(f"wrote {path}", markup=False)
    write_json(json_text(answer), json_file)
    if journal is not None:
        journal.remove()
    return 0
