"""``denoc gate``: the regression gate for CI."""

from __future__ import annotations

from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.options import allow_option, console, output_options, progress, say_notes, wide_options, write_json
from harness.cli.resume import folder_of, journal_in, resumable

if TYPE_CHECKING:
    from harness.cases.gate import Accepted
    from harness.cases.results import Results
    from harness.journal import Journal

SUITE_REFERENCE = "reference/accepted.json"


@click.command()
@click.argument("models", nargs=-1, metavar="[MODEL …]")
@click.option(
    "--reference",
    metavar="FILE",
    help=f"The accepted figures; {SUITE_REFERENCE} for the suite, to be named for models.",
)
@click.option(
    "--results", "results_file", metavar="FILE", help="Judge these saved results instead of running anything."
)
@click.option(
    "--engine",
    "engines",
    multiple=True,
    metavar="NAME",
    help="Only this engine beside the native one; rows of others are not held.",
)
@click.option("--accept", is_flag=True, help="Write the figures of this run as the accepted ones; needs --why.")
@click.option("--why", metavar="TEXT", help="The reason, kept in the file with date and versions.")
@click.option("--new", is_flag=True, help="With --accept: start a file that does not exist yet.")
@click.option(
    "--remove",
    multiple=True,
    metavar="CASE",
    help="With --accept: let go of accepted rows that this run lacks, by case, case/quantity or key ('robot*').",
)
@click.option(
    "--self-test",
    "self_test",
    type=click.Choice(["quick", "full"]),
    is_flag=False,
    flag_value="quick",
    help="Plant defects and see that each is caught and named: a few (default for the suite), or all.",
)
@click.option("--no-self-test", is_flag=True, help="Plant none.")
@click.option("--summary", metavar="FILE", help="Append what changed and why as Markdown (for $GITHUB_STEP_SUMMARY).")
@click.option("--sarif", metavar="FILE", help="Write what closes the gate as SARIF, with file and line of the model.")
@click.option("--annotate", is_flag=True, help="Print it as annotations of GitHub Actions too.")
@click.option(
    "--resume",
    metavar="DIR",
    type=click.Path(path_type=Path),
    help="Go on with a run with --out DIR that was interrupted, with the same options.",
)
@allow_option
@output_options("Write results.json, junit.xml and the other reports of the run there.")
@wide_options()
def gate(
    models: tuple[str, ...],
    reference: str | None,
    results_file: str | None,
    engines: tuple[str, ...],
    accept: bool,
    why: str | None,
    new: bool,
    remove: tuple[str, ...],
    self_test: str | None,
    no_self_test: bool,
    summary: str | None,
    sarif: str | None,
    annotate: bool,
    resume: Path | None,
    allow: tuple[str, ...],
    out: Path | None,
    json_file: str | None,
    workers: int | None,
    dask: str | None,
) -> int:
    """Hold the suite, or robots of your own, against the accepted figures.

    Fails if a figure leaves its line or grows by more than its share of what is allowed, if a row is new, missing or
    suddenly skipped, if the accepted figures were changed by hand, and if one of the defects planted in the native engine
    gets past unnoticed or unnamed. With MODEL: the engines must agree on it, and it must still be the robot that was
    accepted: masses, inertias, frames, joint laws, limits, frequencies, and its motion from recorded states.

    \b
    Examples:
      denoc gate
      denoc gate --accept --why "adaptive integrator of higher order: trajectories are closer"
      denoc gate robot.urdf --reference robot.accepted.json --accept --new --why "as delivered"
      denoc gate robot.urdf --reference robot.accepted.json --out results
      denoc gate --self-test full --out results
      denoc gate --self-test full --resume results
    """
    from harness.cases import gate as gates
    from harness.cases.run import engine_names
    from harness.cases.users import names_of
    from harness.engines import registry
    from harness.errors import InputError
    from harness.report import gate as said
    from harness.whole_files import write_whole

    if (why is not None or new or remove) and not accept:
        raise InputError("--why, --new and --remove go with --accept", mend="add --accept, or leave them out")
    if accept and not (why or "").strip():
        raise InputError("--accept needs a reason", mend='add --why "what changed and why the new figures are right"')
    if models and results_file is not None:
        raise InputError("--results and models do not go together", mend="the results say which models they are of")
    if models and reference is None:
        raise InputError("models need their own accepted figures", mend="add --reference robot.accepted.json")
    if self_test is not None and no_self_test:
        raise InputError("--self-test and --no-self-test do not go together", mend="leave one out")
    held = {model: sha256(Path(model).read_bytes()).hexdigest() for model in models if Path(model).is_file()}
    out = folder_of(out, resume)
    # What is read from a file, or accepted as it is, takes no time to speak of; all planted defects take hours.
    kept = out if (results_file is None and not accept) or self_test == "full" else None
    journal = journal_in(kept, {"models": held, "engines": list(engines)}, anew=resume is None)
    path = Path(reference or SUITE_REFERENCE)
    before = None
    if accept and new:
        if path.exists():
            raise InputError("exists already", source=path, mend="leave --new out to accept changes to it")
    else:
        before = gates.read_accepted(path)
    with resumable("gate", kept):
        results, robots = _results(models, results_file, engines, before, accept, workers, dask, journal, allow)
    if models:
        say_notes(results.told)
    trials = None
    if self_test is None and not models and not no_self_test:
        self_test = "quick"
    if self_test is not None:
        with progress("planted defects") as step, resumable("gate", kept):
            trials = gates.self_test(full=self_test == "full", workers=workers, progress=step, journal=journal)
    without = set(registry.names()) - set(engine_names(engines)) if engines else set()
    judgement = None if before is None else gates.judge(results, before, left_out=without)
    files = names_of([Path(model) for model in models])
    screen = console(json_file)
    if judgement is not None or trials is not None:
        # What a part of a run lacks stays as it was, and is told once it is accepted.
        shown = judgement
        if judgement is not None and accept:
            shown = replace(judgement, rows=tuple(row for row in judgement.rows if row.row is not None))
        said.print_judgement(shown, trials, screen, files)
    if out is not None:
        from harness.report.write import write_reports

        write_reports(results, out, judgement=judgement, trials=trials, models=files)
    write_json(said.as_dict(results, judgement, trials), json_file)
    if sarif is not None:
        write_whole(sarif, said.sarif(judgement, files))
    if annotate and judgement is not None:
        for line in said.github_annotations(judgement, files):
            click.echo(line)
    if summary is not None:
        said.append_summary(summary, said.markdown(results, judgement, trials, before, files))
    missed = trials is not None and not trials.ok
    change = None
    if accept and not missed:
        change = gates.accept(results, before, why or "", remove=remove, robots=robots)
        write_whole(path, change.accepted.to_json())
    if journal is not None:
        # Last: hours of planted defects are not lost to a disk that is full where one of these files goes.
        journal.remove()
    if missed:
        return 1
    if change is not None:
        said.print_change(change, path, screen)
        return 0
    return 0 if judgement is not None and judgement.ok else 1


def _results(
    models: tuple[str, ...],
    results_file: str | None,
    engines: tuple[str, ...],
    before: Accepted | None,
    accept: bool,
    workers: int | None,
    dask: str | None,
    journal: Journal | None,
    allow: tuple[str, ...],
) -> tuple[Results, dict[str, Any]]:
    """The run to be judged, and what is to be recorded of models if it is accepted."""
    from harness.cases.gate import robot
    from harness.cases.results import read_results
    from harness.cases.run import validate
    from harness.cases.users import names_of
    from harness.errors import InputError

    if results_file is not None:
        results = read_results(results_file)
        if accept and any(robot.RECORDED in row.engines for row in results.rows):
            raise InputError(
                "these results hold models against what was recorded of them",
                source=results_file,
                mend="accept with the models themselves: denoc gate MODEL … --accept",
            )
        return results, {}
    if not models and dask is None:
        from harness.denoc.compiling import ahead

        ahead.everything()
    with progress("gate") as step:
        results = validate(
            models or None,
            engines=engines or None,
            workers=workers,
            dask=dask,
            # Each is held against what was recorded of it; robots guarded together need not be one robot described twice.
            separate=True,
            allow=allow,
            progress=step,
            journal=journal,
        )
    if not models:
        return results, {}
    recorded: dict[str, Any] = {}
    rows = list(results.rows)
    for name, path in names_of([Path(model) for model in models]).items():
        folders = [Path(folder).resolve() for folder in allow]
        now = robot.record(path, allow=folders)
        held = now if accept or before is None else before.robots.get(name)
        if held is not None:
            rows += robot.compare(name, path, held, now, engines, allow=folders)
        recorded[name] = now
    return replace(results, rows=tuple(rows)), recorded
