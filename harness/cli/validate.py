"""``denoc validate``: the main job."""

from __future__ import annotations

from pathlib import Path

import click

from harness.cli.options import allow_option, console, output_options, progress, say_notes, wide_options, write_json


@click.command()
@click.argument("models", nargs=-1, metavar="[MODEL …]")
@output_options("Write results.json, results.md, results.csv, junit.xml and report.html there.")
@click.option("--case", "cases", multiple=True, metavar="NAME", help="Only this case ('robot*': all that start so).")
@click.option("--engine", "engines", multiple=True, metavar="NAME", help="Only this engine beside the native one.")
@click.option("--all-robots", is_flag=True, help="Every URDF of the package example-robot-data instead of the suite.")
@click.option("--floating", is_flag=True, help="Let the root links of URDF models float on a free joint.")
@allow_option
@click.option("--allow-unphysical", is_flag=True, help="Compare models whose inertia no body can have all the same.")
@click.option(
    "--tolerance",
    type=click.FloatRange(min=0.0),
    metavar="X",
    help="Allowed between two descriptions of one mechanism, relative (angles: rad); default: 0.001.",
)
@click.option(
    "--separate", is_flag=True, help="The models are of different mechanisms: do not compare their descriptions."
)
@click.option(
    "--audit-import", is_flag=True, help="Tell which fields of MODEL each engine's reader passes over, and the cost."
)
@click.option("--rows", "every_row", is_flag=True, help="Print every row, not a line for each group and what failed.")
@click.option("--list", "list_cases", is_flag=True, help="List the cases of the suite and their sources.")
@wide_options()
def validate(
    models: tuple[str, ...],
    out: Path | None,
    json_file: str | None,
    cases: tuple[str, ...],
    engines: tuple[str, ...],
    all_robots: bool,
    floating: bool,
    allow_unphysical: bool,
    tolerance: float | None,
    separate: bool,
    allow: tuple[str, ...],
    audit_import: bool,
    every_row: bool,
    list_cases: bool,
    workers: int | None,
    dask: str | None,
) -> int:
    """Compare the native dynamics with the other engines.

    Without a MODEL: the built-in suite. With URDF, MJCF or TOML models: acceleration, inverse dynamics, mass matrix,
    bias, gravity and energy of each at random states; of flexible links the motion against finite elements, and what
    is left when they are held straight. A model's file is read once more by Pinocchio and MuJoCo themselves. Two models are
    also held against one another as descriptions of one mechanism: which body, joint and field differs, by how much, and
    what it costs in motion (of three and more, those that share names).

    \b
    Examples:
      denoc validate --out results
      denoc validate robot.urdf arm.xml rig.toml --json -
      denoc validate robot.urdf robot.xml --tolerance 0.01
      denoc validate quadruped.urdf --floating
      denoc validate robot.urdf --audit-import
      denoc validate --case 'rigid_*' --engine mujoco
    """
    if list_cases:
        return _list()
    from harness.cases.run import validate as run
    from harness.errors import InputError
    from harness.report.terminal import print_results

    if audit_import:
        if floating:
            raise InputError(
                "--audit-import is of joints of one degree of freedom, not of what floats", mend="leave out --floating"
            )
        return _audit_import(models, out, json_file, not allow_unphysical, allow)
    chosen: tuple[str, ...] | None = models or None
    refused: list[tuple[str, str]] = []
    if all_robots:
        if models:
            raise InputError("--all-robots and models do not go together", mend="give the one or the other")
        chosen, refused = _readable_robots(floating)
    if floating and chosen is None:
        raise InputError("--floating is about models of your own", mend="name a URDF, or give --all-robots")
    if chosen is None and not cases and dask is None:
        # The whole suite needs every kernel, and each of its processes would compile its own.
        from harness.denoc.compiling import ahead

        ahead.everything()
    from harness.compare.descriptions import TOLERANCE

    with progress("validate") as step:
        results = run(
            chosen,
            cases=cases or None,
            engines=engines or None,
            workers=workers,
            dask=dask,
            physical=not (allow_unphysical or all_robots),
            separate=separate or all_robots,
            tolerance=TOLERANCE if tolerance is None else tolerance,
            allow=allow,
            floating=floating,
            progress=step,
        )
    if chosen is not None:
        say_notes(results.told)
    if out is not None:
        from harness.report.write import write_reports

        write_reports(results, out)
    write_json(results.to_text(), json_file)
    screen = console(json_file)
    print_results(results, screen, every_row=every_row)
    for name, reason in refused:
        screen.print(f"refused: {name}: {reason}", markup=False)
    if all_robots:
        screen.print(f"{len(chosen or ())} robots compared, {len(refused)} refused.")
    if out is not None:
        screen.print(f"Written to {out}: open {out / 'report.html'} in a browser.", markup=False)
    elif not every_row:
        screen.print("Every row: --rows; with the reason for what is allowed, and pictures: --out DIR.", style="dim")
    return 0 if results.ok else 1


def _audit_import(
    models: tuple[str, ...], out: Path | None, json_file: str | None, physical: bool, allow: tuple[str, ...]
) -> int:
    from harness.cases.import_audit import audit_import
    from harness.errors import InputError
    from harness.report.import_audit import import_audit_json, print_import_audit
    from harness.whole_files import write_folder

    if not models:
        raise InputError("--audit-import needs a model", mend="denoc validate robot.urdf --audit-import")
    with progress("audit") as step:
        found = {}
        for count, model in enumerate(models, start=1):
            found[model] = audit_import(model, physical=physical, allow=allow)
            step(count, len(models), model)
    print_import_audit(found, console(json_file))
    text = import_audit_json(found)
    if out is not None:
        write_folder(out, {"import.json": text})
    write_json(text, json_file)
    return 0


def _list() -> int:
    from harness.cases.discover import built_in
    from harness.report.columns import print_table

    lines = [(case.name, case.group, case.title, case.source) for case in built_in().values()]
    print_table(console(), ("case", "group", "what", "truth"), lines)
    return 0


def _readable_robots(floating: bool) -> tuple[tuple[str, ...], list[tuple[str, str]]]:
    """Robots of the package that can be read, and one line for each that is refused."""
    from harness.cases.robots import files
    from harness.cases.users import read
    from harness.errors import InputError

    good, refused = [], []
    for name, path in files().items():
        try:
            read(path, physical=False, floating=floating)
            good.append(str(path))
        except InputError as error:
            refused.append((name, " ".join(filter(None, [error.what, f"({error.mend})" if error.mend else ""]))))
    return tuple(good), refused
