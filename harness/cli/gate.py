"""``denoc gate``: the regression gate for CI."""

from __future__ import annotations

from pathlib import Path

import click

from harness.cli.options import console, output_options, progress, wide_options, write_json


@click.command()
@click.option(
    "--reference",
    default="reference/accepted.json",
    show_default=True,
    metavar="FILE",
    help="The accepted figures.",
)
@click.option(
    "--results", "results_file", metavar="FILE", help="Judge these saved results instead of running the suite."
)
@click.option("--accept", is_flag=True, help="Write the figures of this run as the accepted ones; needs --why.")
@click.option("--why", metavar="TEXT", help="The reason, kept in the file with date and versions.")
@click.option("--new", is_flag=True, help="With --accept: start a file that does not exist yet.")
@click.option("--self-test/--no-self-test", default=True, help="Plant defects and see that each is caught and named.")
@output_options("Write results.json and the other reports of the run there.")
@wide_options
def gate(
    reference: str,
    results_file: str | None,
    accept: bool,
    why: str | None,
    new: bool,
    self_test: bool,
    out: Path | None,
    json_file: str | None,
    workers: int | None,
    dask: str | None,
) -> int:
    """Hold the suite against the accepted figures.

    Fails if a figure leaves its line or grows by more than its share of what is allowed, if a row is new, missing or
    suddenly skipped, and if one of the defects planted in the native engine gets past unnoticed or unnamed.

    \b
    Examples:
      denoc gate
      denoc gate --accept --why "adaptive integrator of higher order: trajectories are closer"
    """
    from harness.cases.gate import accepted as figures
    from harness.cases.gate import judge, read_accepted
    from harness.cases.results import read_results
    from harness.cases.run import validate
    from harness.errors import InputError
    from harness.report.files import write_whole
    from harness.report.gate import as_dict, print_judgement

    path = Path(reference)
    if (why is not None or new) and not accept:
        raise InputError("--why and --new go with --accept", mend="add --accept, or leave them out")
    if accept and not (why or "").strip():
        raise InputError("--accept needs a reason", mend='add --why "what changed and why the new figures are right"')
    before = None
    if accept and new:
        if path.exists():
            raise InputError("exists already", source=path, mend="leave --new out to accept changes to it")
    else:
        before = read_accepted(path)
    if results_file is not None:
        results = read_results(results_file)
    else:
        if dask is None:
            from harness.denoc.compiling import ahead

            ahead.everything()
        with progress("gate") as step:
            results = validate(workers=workers, dask=dask, progress=step)
    trials = None
    if self_test:
        from harness.cases.gate import self_test as plant

        trials = plant()
    judgement = None if before is None else judge(results, before)
    screen = console(json_file)
    if judgement is not None or trials is not None:
        print_judgement(judgement, trials, screen)
    if out is not None:
        from harness.report.write import write_reports

        write_reports(results, out)
    write_json(as_dict(results, judgement, trials), json_file)
    if trials is not None and not trials.ok:
        return 1
    if accept:
        text = figures.accept(results, before, why or "").to_json()
        write_whole(path, text)
        screen.print(f"Accepted {len(results.rows)} rows into {path}.", markup=False)
        return 0
    return 0 if judgement is not None and judgement.ok else 1
